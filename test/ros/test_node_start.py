"""How the node starts, refuses to start, and ends."""

import importlib.util
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from subprocess import PIPE

import pytest

from impact_predictor.ros.node import USAGE, main
from impact_predictor.ros.processes import Child, ros_environment

needs_ros = pytest.mark.skipif(
    importlib.util.find_spec("rclpy") is None,
    reason="the node needs ROS 2: source it, or install the extra `ros`",
)
NODE = [sys.executable, "-m", "impact_predictor.ros.node"]
CONFIG = Path(__file__).parents[2] / "config"
SCENE = CONFIG / "cube_tosses.yaml"
DRUM = CONFIG / "deck_drum.yaml"
WITHOUT_NUMBA = Path(__file__).with_name("without_numba")
PATIENCE = 60.0


@needs_ros
@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="reads /proc to know when the program has begun")
@pytest.mark.parametrize(
    ("number", "executor", "scene", "path"),
    [
        (signal.SIGINT, "single", "cube_tosses", WITHOUT_NUMBA),
        (signal.SIGTERM, "events", "cube_tosses", None),
        (signal.SIGINT, "events", "deck_crate", WITHOUT_NUMBA),
    ],
)
def test_a_signal_ends_the_node_with_status_0_whenever_it_comes_and_leaves_nothing_behind(
    number, executor, scene, path, monkeypatch
):
    if path:
        monkeypatch.setenv("PYTHONPATH", str(path), prepend=os.pathsep)
    # Alone, so that what it shares with the processes of its ROS domain ends with it.
    alone = ros_environment()
    for moment in (0.0, 0.1, 0.3, 1.2):
        arguments = ("--ros-args", "--params-file", CONFIG / f"{scene}.yaml", "-p", f"executor:={executor}")
        node = subprocess.Popen([*NODE, *arguments], stdout=PIPE, stderr=PIPE, text=True, env=alone)
        shared = send(node, number, moment)
        said, complaint = node.communicate(timeout=PATIENCE)
        lines = [line for line in complaint.splitlines() if "[INFO]" not in line]
        assert (node.returncode, said, lines) == (0, "", [])
        assert not [name for name in shared if Path(name).exists()]


@needs_ros
@pytest.mark.slow
def test_a_signal_ends_the_node_while_numba_compiles_for_it(tmp_path):
    pytest.importorskip("numba")
    environment = {**ros_environment(), "NUMBA_CACHE_DIR": str(tmp_path)}
    with subprocess.Popen(
        [*NODE, "--ros-args", "--params-file", SCENE], stdout=PIPE, stderr=PIPE, text=True, env=environment
    ) as node:
        said = node.stderr.readline()
        assert "numba compiles the impact laws" in said
        node.send_signal(signal.SIGINT)
        assert (node.wait(PATIENCE), node.stderr.read()) == (0, "")
    assert not list(tmp_path.rglob("*.nbc"))


def send(node, number, moment):
    """Send a signal some time after the program has begun, before its first line a signal is for the interpreter; the
    files in which it shared memory until then.
    """
    patience = time.monotonic() + PATIENCE
    while not blocks(node.pid, number):
        assert time.monotonic() < patience
        time.sleep(0.005)
    time.sleep(moment)
    shared = set(re.findall(r"/dev/shm/fastrtps_[0-9a-f]{16}\S*", Path(f"/proc/{node.pid}/maps").read_text()))
    node.send_signal(number)
    return shared


def blocks(process, number):
    """Whether a process takes a signal in its own time."""
    status = Path(f"/proc/{process}/status").read_text()
    (mask,) = [line.split()[1] for line in status.splitlines() if line.startswith("SigBlk:")]
    return bool(int(mask, 16) >> (number - 1) & 1)


def run_node(*arguments, code=None):
    program = [sys.executable, "-c", code] if code else NODE
    return subprocess.run([*program, *arguments], capture_output=True, text=True, timeout=PATIENCE)


def sentence_in(complaint):
    """What the node says itself; rcl may log on its own before that."""
    (sentence,) = [line for line in complaint.splitlines() if line.startswith("impact_predictor: ")]
    assert "Traceback" not in complaint
    return sentence


@needs_ros
@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "no parameter of the scene was given to /impact_predictor: give --params-file"),
        (("--params-file", SCENE, "-p", "body.mas:=1.0"), "no parameter body.mas, did you mean body.mass"),
        (("--params-file", SCENE, "-p", "body.mass:=0.0"), "body.mass is 0.0, but"),
        (("--params-file", SCENE, "-p", "body.mass:=1"), "write 1.0 for 1"),
        (("--params-file", SCENE, "-p", "contact.friction:=.nan"), "contact.friction is nan, but"),
        # A value of a type that rcl keeps beside the one of the file.
        (("--params-file", SCENE, "-p", "contact.friction:=0,9"), "contact.friction is '0,9', but it must be a finite"),
        (("--params-file", SCENE, "--param", "contact.friction:=[0.9]"), "contact.friction is [0.9], but"),
        (("-p", "contact.friction:=0.9", "-p", "contact.friction:=high"), "contact.friction is 'high', but"),
        (("--params-file", SCENE, "-p", "body.contact_points:=[]"), "leave it out"),
        (("--params-file", SCENE, "-p", "executor:=fast"), "'single' or 'events'"),
        (("--params-file", SCENE, "-p", "qos_overrides./odom.subscription.reliability:=maybe"), "maybe"),
        (("--params-file", SCENE, "-p", "qos_overrides./odom.subscription.depth:=many"), "whole number of messages"),
        (("--params-file", "nowhere.yaml"), "nowhere.yaml"),
        (("--params-file", __file__), "test_node_start.py"),
    ],
)
def test_a_bad_parameter_is_one_sentence_and_a_status_that_is_not_0(arguments, said, capfd):
    assert main(["predictor", "--ros-args", *map(str, arguments)]) == 1
    assert said in sentence_in(capfd.readouterr().err)


@needs_ros
@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "friction"),
    [
        (("--params-file", "scene.yaml"), 0.3),
        (("--params-file", "scene.yaml", "-p", "contact.friction:=0.9"), 0.9),
        (("-p", "contact.friction:=0.9", "--params-file", "scene.yaml"), 0.3),
        (("-p", "contact.friction:=high", "--params-file", "scene.yaml"), 0.3),
        (("--params-file", "scene.yaml", "-p", "contact.friction:=0.8", "--param", "contact.friction:=0.9"), 0.9),
        (("--params-file", "scene.yaml", "-p", "foot_watch:contact.friction:=0.9"), 0.3),
    ],
)
def test_of_all_that_gives_a_parameter_the_last_counts_even_beside_a_section_for_this_node(
    arguments, friction, tmp_path, monkeypatch
):
    import rclpy

    from impact_predictor.ros.predictor_node import PredictorNode

    monkeypatch.chdir(tmp_path)
    of_this_node = "/impact_predictor:\n  ros__parameters:\n    contact.friction: 0.3\n"
    Path("scene.yaml").write_text(f"{DRUM.read_text()}\n{of_this_node}")
    words = ["predictor", "--ros-args", *arguments]
    rclpy.init(args=words)
    try:
        node = PredictorNode(args=words)
        assert node.get_parameter("contact.friction").value == friction
        node.destroy_node()
    finally:
        rclpy.shutdown()


@needs_ros
@pytest.mark.slow
def test_a_file_for_another_node_is_named_with_the_node_that_it_leaves_out(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE.read_text().replace("/**:", "/robot/foot_watch:"))
    finished = run_node("--ros-args", "--params-file", str(scene), "-r", "__ns:=/robot")
    assert finished.returncode == 1
    said = sentence_in(finished.stderr)
    assert "no parameter of the scene was given to /robot/impact_predictor" in said
    assert f"{scene}: it has parameters for /robot/foot_watch, but none for /robot/impact_predictor" in said


@needs_ros
@pytest.mark.slow
def test_the_node_says_what_it_listens_to_what_is_not_for_it_and_where_nothing_comes():
    of_others = ("-p", "camera.exposure:=3", "-p", "qos_overrides./odm.subscription.depth:=9")
    arguments = ("--ros-args", "--params-file", SCENE, "-r", "odom:=/cube/odom", *of_others)
    with Child("node", ros_environment(), "-m", "impact_predictor.ros.node", *map(str, arguments)) as node:
        end = time.monotonic() + PATIENCE
        while "nothing has come on /cube/odom for 5 s: nobody publishes there" not in node.complained():
            node.check()
            assert time.monotonic() < end, node.complained()
            time.sleep(0.1)
        said = node.complained()
        node.end()
    assert "one body is predicted from /contact_geometry, /cube/odom; executor single; the scene has friction, " in said
    assert "camera.exposure is no parameter of impact_predictor, and passed over" in said
    assert "qos_overrides./odm.subscription.depth is of no topic of this node; near it there are" in said
    assert said.count("nothing has come on") == 1


@needs_ros
@pytest.mark.slow
@pytest.mark.parametrize(("number", "said"), [(1, "1 publisher there"), (2, "2 publishers there")])
def test_where_nothing_comes_although_somebody_publishes_the_node_says_how_many_do(number, said, capfd, monkeypatch):
    import rclpy
    from nav_msgs.msg import Odometry

    from impact_predictor.ros.predictor_node import PredictorNode

    monkeypatch.setattr("impact_predictor.ros.inputs.SILENT", 0.0)
    words = ["predictor", "--ros-args", "--params-file", str(DRUM)]
    rclpy.init(args=words)
    try:
        node = PredictorNode(args=words)
        publishers = [node.create_publisher(Odometry, "odom", 1) for _ in range(number)]
        assert node.count_publishers("odom") == len(publishers)
        complaint, end = "", time.monotonic() + PATIENCE
        while "nothing has come on /odom for 0 s" not in complaint:
            assert time.monotonic() < end, complaint
            rclpy.spin_once(node, timeout_sec=0.1)
            complaint += capfd.readouterr().err
        node.destroy_node()
    finally:
        rclpy.shutdown()
    assert f"nothing has come on /odom for 0 s: {said}" in complaint


def test_without_rclpy_the_node_says_in_one_sentence_what_to_do():
    code = "import sys; sys.modules['rclpy'] = None\nfrom impact_predictor.ros.node import main; sys.exit(main())"
    finished = run_node(code=code)
    assert finished.returncode == 2
    assert len(finished.stderr.splitlines()) == 1
    assert "source /opt/ros/jazzy/setup.bash" in finished.stderr
    assert "pip install '.[ros]'" in finished.stderr


def test_the_node_shows_how_it_is_started_with_and_without_ros(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "rclpy", None)
    for help_asked in (["--help"], ["-h"], ["--params-file", "scene.yaml", "--help", "--ros-args"]):
        assert main(["predictor", *help_asked]) == 0
        assert capsys.readouterr() == (f"{USAGE}\n", "")
    assert USAGE.startswith("predictor --ros-args --params-file ")


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--params-file", "scene.yaml"], "--params-file scene.yaml"),
        (["scene.yaml"], "scene.yaml"),
        (["-p", "body.mass:=1.0", "--ros-args", "--params-file", "x.yaml"], "-p body.mass:=1.0"),
        (["--ros-args", "-p", "body.mass:=1.0", "--", "--params-file", "x.yaml"], "--params-file x.yaml"),
    ],
)
def test_what_does_not_follow_ros_args_is_refused_in_a_sentence_that_shows_the_way(capsys, arguments, named):
    assert main(["predictor", *arguments]) == 2
    way = "`predictor --ros-args --params-file scene.yaml -r odom:=/robot/odom`"
    said = f"impact_predictor: {named} is not understood: every argument goes after --ros-args, as in {way}\n"
    assert capsys.readouterr() == ("", said)


@needs_ros
@pytest.mark.slow
def test_the_node_imports_nothing_that_only_the_offline_commands_need():
    # A body on points needs the law in three dimensions, which numba compiles; a cylinder does not.
    heavy = {"click", "matplotlib", "numba", "rich", "rosbags", "ruamel", "scipy"}
    code = (
        "import gc, sys\n"
        "from impact_predictor.ros.node import main\n"
        f"main(['', '--ros-args', '--params-file', {str(DRUM)!r}])\n"
        f"print(*({heavy} & sys.modules.keys()), 'impact_predictor.ros.predictor_node' in sys.modules,"
        "gc.get_freeze_count() > 10_000)"  # what is loaded is not looked at again by each full collection
    )
    node = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    send(node, signal.SIGINT, 1.0)
    printed, _ = node.communicate(timeout=PATIENCE)
    assert (node.returncode, printed) == (0, "True True\n")
