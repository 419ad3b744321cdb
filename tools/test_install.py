"""Install the package in each way that a user can, in empty environments, and use what was installed.

    python3 tools/test_install.py [pip] [ros] [colcon]

pip: without ROS, on each Python from 3.10 to 3.13 that is found; ros: with ROS from PyPI; colcon: built and tested with
colcon from PyPI. Each starts from a fresh virtual environment, an empty home folder and none of the caller's ROS
variables; what pip downloads is kept for all of them.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).resolve().parents[1]
NAME = "impact_predictor"
VERSIONS = ("3.10", "3.11", "3.12", "3.13")
FEWEST_TESTS = 300
"""Fewer executed by colcon mean that it did not find them: it then executes none and exits with 0."""
PLATE = ("solve", "plate", "--length=1", "--height=0.4", "--mass=10", "--friction=0.2", "--omega=-1", "--json")
BAGS = (
    ("examples/cube_tosses", "config/cube_tosses.yaml"),
    ("examples/hyq/hyq.bag", "config/walker_hyq.yaml"),
)
"""Recorded bags, each with its scene."""

QUICK = BAGS[1]
"""The one that takes seconds even without compiled code."""

COMPILED = "3.11", "3.13"
"""The Pythons on which an install compiles; on the others, and where there is ROS, the files run as Python."""

TESTED = "fast,plot,page,calibrate,test"
"""The extras that the tests use."""

COLCON = "setuptools<80", "colcon-common-extensions"
PATIENCE = 1800.0
"""Seconds for one command: colcon runs thousands of tests beside another install, on a machine that may be busy."""
NOT_SOURCE = {".git", ".venv", ".venv-messages", ".hypothesis", "build", "dist", "install", "log", "out"}
CALLERS = ("AMENT_", "CMAKE_PREFIX_PATH", "COLCON_", "LD_LIBRARY_PATH", "PYTHON", "ROS_", "VIRTUAL_ENV", "_ROS_WHEELS_")
WAIT_FOR_NODE = f"""
import sys, time, rclpy
rclpy.init()
probe, end = rclpy.create_node("probe"), time.monotonic() + 30
while "{NAME}" not in probe.get_node_names():
    if time.monotonic() > end:
        sys.exit("the node {NAME} did not appear")
    time.sleep(0.1)
"""


predictions: dict[str, list[str]] = {}
"""The checksums of what each Python predicted for the bags, by the path of the Python."""

ros_domains = itertools.count(1 + os.getpid() % 80)
"""One for each install: two run at a time, and their nodes have one name."""


class InstallError(Exception):
    """An install, or the use of what was installed, went wrong; the message says which command and how."""


class Environment:
    """A fresh virtual environment with a home folder of its own."""

    def __init__(self, base: Path, python: str) -> None:
        self.prefix = base / "venv"
        self.work = base / "home"
        self.work.mkdir(parents=True)
        cache = os.environ.get("PIP_CACHE_DIR") or str(Path("~/.cache/pip").expanduser())
        self.variables = {name: value for name, value in os.environ.items() if not name.startswith(CALLERS)}
        self.variables |= {
            "HOME": str(self.work),
            "IMPACT_PREDICTOR_PLAIN": "1",
            "PATH": f"{self.prefix}/bin:{os.environ['PATH']}",
            "PIP_CACHE_DIR": cache,
            "PIP_DISABLE_PIP_VERSION_CHECK": "1",
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_DOMAIN_ID": str(next(ros_domains)),
        }
        self.run(python, "-m", "venv", str(self.prefix))

    def run(self, *command: str, cwd: Path | None = None, status: int | None = 0) -> subprocess.CompletedProcess[str]:
        """Run a command in the home folder, for at most so long; `status` None stands for any but 0."""
        done = subprocess.run(
            command,
            cwd=cwd or self.work,
            env=self.variables,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        if done.returncode != status and (status is not None or done.returncode == 0):
            output = "\n".join((done.stdout + done.stderr).splitlines()[-40:])
            raise InstallError(f"{' '.join(command)} ended with status {done.returncode}:\n{output}")
        return done

    def pip(self, *arguments: str) -> None:
        self.run(f"{self.prefix}/bin/python", "-m", "pip", *arguments, "--quiet")


def copy_source(target: Path) -> Path:
    """What a clone has, so that no build leaves a trace in the checkout or in the next install."""

    def ignore(folder: str, names: list[str]) -> set[str]:
        made = {name for name in names if name == "__pycache__" or name.endswith((".egg-info", "_cache", ".so"))}
        return made | NOT_SOURCE if Path(folder) == ROOT else made

    return Path(shutil.copytree(ROOT, target, ignore=ignore))


def find_python(version: str) -> str | None:
    """A Python of that version which can make virtual environments: on PATH, or of pyenv."""
    pyenv = Path(os.environ.get("PYENV_ROOT") or "~/.pyenv").expanduser()
    candidates = [
        sys.executable,
        f"python{version}",
        *map(str, sorted(pyenv.glob(f"versions/{version}.*[0-9]/bin/python"))),
    ]
    check = f"import ensurepip, sys, venv; sys.exit('%d.%d' % sys.version_info[:2] != '{version}')"
    for candidate in candidates:
        try:
            found = subprocess.run([candidate, "-c", check], capture_output=True, check=False)
        except OSError:
            continue
        if found.returncode == 0:
            return candidate
    return None


def check_share(prefix: Path) -> None:
    """Every file of config, examples and launch, and the marker of the ament index, were installed."""
    expected = [Path("package.xml")]
    for folder in ("config", "examples", "launch"):
        expected += [path.relative_to(ROOT) for path in (ROOT / folder).rglob("*") if path.is_file()]
    places = [prefix / "share" / NAME / path for path in expected if "__pycache__" not in path.parts]
    places.append(prefix / "share/ament_index/resource_index/packages" / NAME)
    missing = [str(place) for place in places if not place.is_file()]
    if missing:
        raise InstallError(f"not installed: {', '.join(missing)}")


def check_offline(environment: Environment) -> None:
    """The library and the offline commands, on what was installed and from a folder that is not the checkout's."""
    prefix, share = environment.prefix, environment.prefix / "share" / NAME
    check_share(prefix)
    place = environment.run(f"{prefix}/bin/python", "-c", f"import {NAME}; print({NAME}.__file__)").stdout
    if not Path(place).is_relative_to(prefix):
        raise InstallError(f"import {NAME} took {place.strip()}, not what was installed")
    command = f"{prefix}/bin/impact-predictor"
    environment.run(command, "--help")
    environment.run(f"{prefix}/bin/python", "-m", NAME, "--help")
    json.loads(environment.run(command, *PLATE).stdout)
    bag, scene = (str(share / path) for path in QUICK)
    replayed = json.loads(environment.run(command, "replay", bag, "--params", scene, "--json").stdout)
    if not replayed["touchdowns"]:
        raise InstallError(f"replay found no touchdown in {bag}")
    tables = environment.run(command, "replay", bag, "--params", scene).stdout
    if "touchdowns" not in tables:
        raise InstallError(f"replay printed no table:\n{tables}")


def check_form(environment: Environment, is_compiled: bool) -> None:
    """The predictor runs compiled, or as Python, as the install was to make it."""
    scene = str(environment.prefix / "share" / NAME / QUICK[1])
    told = environment.run(f"{environment.prefix}/bin/impact-predictor", "explain", scene, "--json").stdout
    if (json.loads(told)["runs"] == "compiled") != is_compiled:
        raise InstallError(
            f"the predictor should {'' if is_compiled else 'not '}run compiled, but runs {json.loads(told)['runs']}"
        )


def check_extras(environment: Environment) -> None:
    """Without the extras each command that needs one says so, in one line."""
    share = environment.prefix / "share" / NAME
    replay = ("replay", str(share / "examples/cube_tosses"), "--params", str(share / "config/cube_tosses.yaml"))
    for extra, *command in (
        ("plot", "simulate", "rod", "--plot", "rod.png"),
        ("page", *replay, "--report", "page.html"),
        ("fleet", *replay, "--table", "table.parquet"),
        ("calibrate", "calibrate", *replay[1:]),
        ("page", "report", "-o", "accuracy"),
    ):
        said = environment.run(f"{environment.prefix}/bin/impact-predictor", *command, status=None).stderr
        if said.count("\n") != 1 or f"impact_predictor[{extra}]" not in said:
            raise InstallError(f"{' '.join(command)} should name the extra {extra} in one line, but said:\n{said}")


def predictions_of(environment: Environment) -> list[str]:
    """The checksums of the predictions for the recorded bags: the same on every Python with the same bag libraries."""
    share = environment.prefix / "share" / NAME
    sums = []
    for bag, scene in BAGS:
        output = environment.work / "predictions.mcap"
        command = (
            f"{environment.prefix}/bin/impact-predictor",
            "replay",
            str(share / bag),
            "--params",
            str(share / scene),
        )
        environment.run(*command, "-o", str(output))
        sums.append(hashlib.sha256(output.read_bytes()).hexdigest())
    return sums


def check_node_missing(environment: Environment) -> None:
    """Without ROS the node says so, in one line."""
    said = environment.run(f"{environment.prefix}/bin/predictor", status=None)
    lines = (said.stdout + said.stderr).splitlines()
    if len(lines) != 1 or "ROS" not in lines[0]:
        raise InstallError(f"predictor without ROS should say in one line that ROS is missing, but said:\n{lines}")


def check_node(environment: Environment, share: Path, *command: str) -> None:
    """The node appears in the ROS graph, and ends at Ctrl-C without a traceback."""
    scene = str(share / "config/cube_tosses.yaml")
    node = subprocess.Popen(
        [*command, "--ros-args", "--params-file", scene],
        cwd=environment.work,
        env=environment.variables,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        environment.run(f"{environment.prefix}/bin/python", "-c", WAIT_FOR_NODE)
    finally:
        node.send_signal(signal.SIGINT)
        try:
            output = node.communicate(timeout=20)[0]
        except subprocess.TimeoutExpired:
            node.kill()
            output = f"{node.communicate()[0]}\nTraceback: killed, 20 s after SIGINT"
    if "Traceback" in output:
        raise InstallError(f"{' '.join(command)}:\n{output}")


def install_without_ros(base: Path, python: str) -> str:
    environment = Environment(base, python)
    source = copy_source(base / "source")
    version = environment.run(
        f"{environment.prefix}/bin/python", "-c", "import sys; print('%d.%d' % sys.version_info[:2])"
    )
    is_compiled = version.stdout.strip() in COMPILED and shutil.which("cc") is not None
    environment.variables["IMPACT_PREDICTOR_PLAIN"] = str(int(not is_compiled))
    environment.pip("install", str(source), "--constraint", str(source / "constraints/bags.txt"))
    check_offline(environment)
    check_form(environment, is_compiled)
    check_extras(environment)
    check_node_missing(environment)
    predictions[python] = predictions_of(environment)
    form = "compiled" if is_compiled else "as Python"
    return f"{form}: library, solve, replay with its tables; extras and ROS are named where they are missing"


def install_with_ros(base: Path, python: str) -> str:
    environment = Environment(base, python)
    source = copy_source(base / "source")
    environment.pip("install", f"{source}[ros]", "--constraint", str(source / "constraints/jazzy.txt"))
    environment.variables["AMENT_PREFIX_PATH"] = str(environment.prefix)
    check_offline(environment)
    check_node(environment, environment.prefix / "share" / NAME, f"{environment.prefix}/bin/predictor")
    return "library, solve, replay; the node runs"


def count_tests(report: Path) -> tuple[int, int]:
    """How many tests of a JUnit file were executed, and how many of them failed; colcon without pytest writes none."""
    if not report.is_file():
        return 0, 0
    suites = [suite.attrib for suite in ElementTree.parse(report).iter("testsuite")]
    executed = sum(int(suite["tests"]) - int(suite["skipped"]) for suite in suites)
    return executed, sum(int(suite["failures"]) + int(suite["errors"]) for suite in suites)


def install_with_colcon(base: Path, python: str) -> str:
    environment = Environment(base, python)
    workspace = base / "workspace"
    source = copy_source(base / "source")
    # What the package needs, without the package: colcon is to build that.
    constraints = str(source / "constraints/jazzy.txt")
    environment.pip(
        "install", *COLCON, f"{source}[ros,fast,plot,page,calibrate,report,test]", "--constraint", constraints
    )
    environment.pip("uninstall", "--yes", NAME)
    copy_source(workspace / "src" / NAME)
    environment.variables["AMENT_PREFIX_PATH"] = str(environment.prefix)
    environment.run("colcon", "build", cwd=workspace)
    environment.run("colcon", "test", "--pytest-args", "-m", "not slow", "-n", "2", cwd=workspace)
    environment.run("colcon", "test-result", "--all", "--verbose", cwd=workspace)
    executed, failed = count_tests(workspace / "build" / NAME / "pytest.xml")
    if failed or executed < FEWEST_TESTS:
        raise InstallError(f"colcon executed {executed} tests (at least {FEWEST_TESTS} expected), {failed} failed")
    installed = workspace / "install" / NAME
    check_share(installed)
    programs = f"{installed}/lib/{NAME}"  # where `ros2 run` looks
    sourced = f'source "{workspace}/install/setup.bash" && exec "$@"'
    for command in ("--help",), PLATE:
        environment.run("bash", "-c", sourced, "bash", f"{programs}/impact-predictor", *command)
    check_node(environment, installed / "share" / NAME, "bash", "-c", sourced, "bash", f"{programs}/predictor")
    for folder in ("build", "install"):
        shutil.rmtree(workspace / folder)
    environment.run("colcon", "build", "--symlink-install", cwd=workspace)
    check_share(installed)
    environment.run("bash", "-c", sourced, "bash", f"{programs}/impact-predictor", "--help")
    return f"{executed} tests executed, 0 failed; both programs run from lib/{NAME}"


def planned(ways: list[str]) -> Iterator[tuple[str, str | None, Callable[[Path, str], str]]]:
    """Name, Python (None where it is missing) and function of each install, the longest first."""
    if "colcon" in ways:
        yield "colcon build, colcon test", sys.executable, install_with_colcon
    if "ros" in ways:
        yield "pip install '.[ros]'", sys.executable, install_with_ros
    if "pip" in ways:
        for version in VERSIONS:
            yield f"pip install . on Python {version}, without ROS", find_python(version), install_without_ros


def attempt(name: str, python: str | None, install: Callable[[Path, str], str]) -> str:
    """Carry out one install in a folder of its own; returns the line that says what became of it."""
    if python is None:
        return f"SKIP {name}: no such Python found"
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="impact-predictor-") as base:
        try:
            outcome = f"PASS {name}: {install(Path(base), python)}"
        except InstallError as error:
            outcome = f"FAIL {name}: {error}"
        except Exception as error:
            outcome = f"FAIL {name}: {error!r}"
    return f"{outcome} ({time.monotonic() - start:.0f} s)"


def main() -> int:
    ways = sys.argv[1:] or ["pip", "ros", "colcon"]
    if unknown := set(ways) - {"pip", "ros", "colcon"}:
        print(
            f"test_install: no install is called {', '.join(unknown)}; there are pip, ros and colcon", file=sys.stderr
        )
        return 2
    failed = False
    with ThreadPoolExecutor(max_workers=2) as pool:
        for done in as_completed([pool.submit(attempt, *plan) for plan in planned(ways)]):
            print(done.result(), flush=True)
            failed |= done.result().startswith("FAIL")
    if "pip" in ways:
        said = same_predictions()
        print(said, flush=True)
        failed |= said.startswith("FAIL")
    return int(failed)


def same_predictions() -> str:
    """Whether all Pythons predicted the same, to the last bit, in a line."""
    name = f"the same predictions on {len(predictions)} Pythons"
    if len(predictions) < 2:
        return f"SKIP {name}: it takes two to compare"
    differing = [
        bag for (bag, _), sums in zip(BAGS, zip(*predictions.values(), strict=True), strict=True) if len(set(sums)) > 1
    ]
    return f"FAIL {name}: those of {', '.join(differing)} differ" if differing else f"PASS {name}"


if __name__ == "__main__":
    sys.exit(main())
