import os
import socket
import time

import pytest

from impact_predictor.errors import InputError
from impact_predictor.ros import processes
from impact_predictor.ros.processes import Child, ros_environment


def python(code):
    return Child("test", dict(os.environ), "-c", code)


def wait(child):
    while not child.ended:
        time.sleep(0.01)
    return child


@pytest.mark.parametrize("program", ["node", "player"])
def test_a_program_of_ros_loads_numpy_only_once_it_waits_for_signals(program):
    # The threads of numpy's library begin with it: one that began before takes the signal, and Python raises.
    code = f"import sys, impact_predictor.ros.{program}; print('numpy' in sys.modules)"
    with python(code) as child:
        wait(child).end()
        assert child.said() == "False\n"


def test_a_process_that_ends_in_order_is_no_error():
    with python("print('done', flush=True)") as child:
        wait(child).end()
        assert child.said() == "done\n"


@pytest.mark.slow
def test_a_process_that_runs_is_asked_to_end_with_sigint():
    code = "import time\ntry:\n  print('up', flush=True); time.sleep(60)\nexcept KeyboardInterrupt: print('asked')"
    with python(code) as child:
        while "up" not in child.said():
            child.check()
        child.end()
        assert child.said() == "up\nasked\n"


def test_a_process_that_fails_is_quoted_in_one_sentence():
    with python("import sys; sys.exit('no such scene\\nat all')") as child, pytest.raises(InputError) as error:
        wait(child).end()
    assert str(error.value) == "the process of the test ended with status 1: no such scene / at all"


@pytest.mark.slow
def test_a_process_that_does_not_listen_is_not_left_running(monkeypatch):
    monkeypatch.setattr(processes, "PATIENCE", 0.2)
    deaf = "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); print('up', flush=True); time.sleep(60)"
    child = python(deaf)
    with child:
        while "up" not in child.said():
            child.check()
    assert child.ended


@pytest.mark.parametrize("offset", [0, 10, 14])
def test_a_ros_domain_in_which_somebody_listens_is_not_free(offset):
    domain = int(ros_environment()["ROS_DOMAIN_ID"])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("", 7400 + 250 * domain + offset))
        assert not processes.is_free(domain)


@pytest.mark.slow
def test_a_ros_domain_with_a_node_in_it_is_not_free():
    rclpy = pytest.importorskip("rclpy", reason="the node needs ROS 2: source it, or install the extra `ros`")
    domain = int(ros_environment()["ROS_DOMAIN_ID"])
    context = rclpy.Context()
    context.init(domain_id=domain)
    try:
        node = rclpy.create_node("somebody", context=context)
        assert not processes.is_free(domain)
        node.destroy_node()
    finally:
        context.shutdown()
