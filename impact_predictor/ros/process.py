"""What the programs share that need ROS: a start that explains itself, a clean end at any moment, messages by name."""

from __future__ import annotations

import importlib
import re
import signal
import sys
import threading
from collections.abc import Callable
from functools import partial
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any, Final

from ..errors import InputError

if TYPE_CHECKING:
    from rclpy.node import Node

_SIGNALS: Final = (signal.SIGINT, signal.SIGTERM)
_PLACE_IN_SOURCE: Final = re.compile(r", at \S+:\d+")


class Stop:
    """The wish of SIGINT or SIGTERM that the process ends; a context manager, for the main thread.

    The signals are blocked, and a thread waits for the first of them: nothing is interrupted half-way, and ROS is
    still there for the last messages. Threads started within inherit the block.
    """

    def __init__(self) -> None:
        self._event = threading.Event()
        self._wake: Callable[[], object] = bool

    def __enter__(self) -> Stop:
        self._mask = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
        self._waiter = threading.Thread(target=self._await_signal, name="stop", daemon=True)
        self._waiter.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._wake = bool
        if self.requested:
            # The process is about to end: a second signal shall not end it less cleanly.
            return
        assert self._waiter.ident is not None
        signal.pthread_kill(self._waiter.ident, signal.SIGTERM)
        self._waiter.join()
        signal.pthread_sigmask(signal.SIG_SETMASK, self._mask)

    def _await_signal(self) -> None:
        signal.sigwait(_SIGNALS)
        self.request()

    def request(self) -> None:
        """End, as if a signal had come."""
        self._event.set()
        self._wake()

    @property
    def requested(self) -> bool:
        return self._event.is_set()

    def wait(self, seconds: float) -> bool:
        """Sleep, but not beyond the request; whether it has come."""
        return self._event.wait(seconds)

    def call(self, wake: Callable[[], object]) -> None:
        """Call `wake`, from another thread, when the request comes; at once if it has come."""
        self._wake = wake
        if self.requested:
            wake()


def run(work: Callable[[Stop], int], args: list[str] | None) -> int:
    """Do the work of a program with ROS and return its exit status; what the user did wrong is said in one sentence."""
    with Stop() as stop:
        try:
            import rclpy
        except ImportError as error:
            return _refuse(
                f"ROS 2 is needed here, but cannot be imported ({error}): source it, for example "
                "`source /opt/ros/jazzy/setup.bash`, or in a clone `pip install '.[ros]' -c constraints/jazzy.txt`",
                2,
            )
        from rclpy.signals import SignalHandlerOptions

        try:
            rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        except RuntimeError as error:
            return _refuse(flaw_of_file(args) or f"ROS refuses the arguments: {sentence(error)}")
        try:
            return work(stop)
        except InputError as error:
            return _refuse(str(error))
        finally:
            rclpy.try_shutdown()


def only_for_ros(args: list[str] | None, usage: str) -> int | None:
    """Look at the arguments of a program that takes those of ROS alone: its exit status where it shall not start.

    `--help` prints the `usage`, whose first line shows a start; what does not follow `--ros-args` is refused.
    """
    own, _ = _split(args)
    if {"-h", "--help"} & set(own):
        print(usage)
        return 0
    if own:
        start = usage.splitlines()[0].strip()
        return _refuse(f"{' '.join(own)} is not understood: every argument goes after --ros-args, as in `{start}`", 2)
    return None


def overrides_of(args: list[str] | None) -> list[str]:
    """The `-p` that follow the last file of the arguments, as arguments of one node.

    Of one parameter rcl keeps a value of each type that the arguments give it, and rclpy takes that of the first type,
    so that a text in the place of a number would be passed over. Arguments of a node are read by themselves, and win.
    """
    _, words = _split(args)
    for k in [k for k, word in enumerate(words) if word == "--params-file"][-1:]:
        words = words[k:]
    given = [rule for option, rule in pairwise(words) if option in ("-p", "--param")]
    last = {rule.partition(":=")[0]: rule for rule in given}
    return ["--ros-args", *chain.from_iterable([("-p", rule) for rule in last.values()])]


def _split(args: list[str] | None) -> tuple[list[str], list[str]]:
    """The words of the arguments that are for the program, and those for ROS."""
    own: list[str] = []
    of_ros: list[str] = []
    words = own
    for word in (sys.argv if args is None else args)[1:]:
        if word in ("--ros-args", "--"):
            words = of_ros if word == "--ros-args" else own
        else:
            words.append(word)
    return own, of_ros


def flaw_of_file(args: list[str] | None, node: str = "impact_predictor") -> str:
    """What is wrong with the parameter file of the arguments for a node, said as offline, or "": rcl says less."""
    words = sys.argv if args is None else args
    for option, path in pairwise(words):
        if option == "--params-file":
            from ..parameters.file import read_parameters

            try:
                read_parameters(path, node)
            except InputError as flaw:
                return str(flaw)
    return ""


def _refuse(sentence: str, exit_status: int = 1) -> int:
    print(f"impact_predictor: {sentence}", file=sys.stderr)
    return exit_status


def sentence(error: Exception) -> str:
    """What rcl says over several lines, in one, without the places in its source."""
    return " ".join(_PLACE_IN_SOURCE.sub("", str(error)).split()) or type(error).__name__


def spin(node: Node, stop: Stop, served: Callable[[], int], executor: str = "single") -> None:
    """Serve a node until the stop; what has arrived by then is served too.

    `served` counts the messages served so far. `executor` is single, or events where this rclpy has it (else single,
    with a warning).
    """
    from rclpy.task import Future

    runner = executor_of(node, executor)
    runner.add_node(node)
    try:
        while not stop.requested:
            over = Future()
            stop.call(partial(over.set_result, None))
            # Without a timeout some versions of the events executor neither serve nor return.
            runner.spin_until_future_complete(over, timeout_sec=1.0)
        idle, before = 0, served()
        while idle < _IDLE_ROUNDS:
            runner.spin_once(timeout_sec=0.0)
            now = served()
            idle, before = 0 if now != before else idle + 1, now
    finally:
        stop.call(bool)
        runner.remove_node(node)


_IDLE_ROUNDS: Final = 20
"""A round may go to a timer, a service or the wish to stop; after this many without a message there is none."""


def executor_of(node: Node, kind: str) -> Any:
    """An executor of a kind, single or events."""
    if kind == "events":
        try:
            from rclpy.experimental import EventsExecutor
        except ImportError:
            node.get_logger().warning("this rclpy has no events executor, so the single-threaded one is used")
        else:
            return EventsExecutor()
    from rclpy.executors import SingleThreadedExecutor

    return SingleThreadedExecutor()


def message_class(type_name: str) -> Any:
    """The class of a message, of a name like nav_msgs/msg/Odometry; InputError where it is not installed."""
    package, _, name = type_name.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError) as error:
        raise InputError(f"the message type {type_name} is not installed; install the ROS package {package}") from error
