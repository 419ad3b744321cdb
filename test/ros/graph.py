"""The rest of the ROS graph of a test: the node as a process of its own, and a peer that talks with it over DDS."""

import json
import os
import pickle
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.bags.replay import replay
from impact_predictor.prediction.scene import inputs_of, scenes_of
from impact_predictor.ros.cdr import STALE, Diagnostic, decode_diagnostic_array
from impact_predictor.ros.messages import OUTPUTS
from impact_predictor.ros.process import message_class
from impact_predictor.ros.processes import Child

# A process starts within a second or two, on a busy machine within ten; a test that waits longer has failed.
PATIENCE = 60.0
PAUSE = 0.02

WITHOUT_NUMBA = Path(__file__).with_name("without_numba")
"""A folder of which a process finds no numba: to load it, and what it compiled, takes most of the start of a node. The
answers are the same to the last bit, which `test_determinism.py` shows; the nodes of `test_node_start.py`,
`test_live_and_replay.py` and `test_endurance.py` have numba.
"""


class Peer:
    """The rest of the ROS graph: what publishes to the node and hears it."""

    def __init__(self, context, outputs=tuple(OUTPUTS)):
        """Be a node that hears these outputs of the predictor, and its reports."""
        self.node = rclpy.create_node("peer", context=context)
        self.executor = SingleThreadedExecutor(context=context)
        self.executor.add_node(self.node)
        self.heard = {name: [] for name in (*outputs, "diagnostics")}
        for name in outputs:
            self.hear(f"/impact_predictor/{name}", OUTPUTS[name].type_name, self.heard[name])
        self.hear("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", self.heard["diagnostics"])

    def hear(self, topic, type_name, heard):
        self.node.create_subscription(message_class(type_name), topic, heard.append, QoSProfile(depth=1000), raw=True)

    def until(self, condition, act=bool):
        """Serve the topics until something is so, and act again and again, but not as often as answers come."""
        now = time.monotonic()
        patience, due = now + PATIENCE, now
        while not condition():
            if (now := time.monotonic()) >= due:
                act()
                due = now + PAUSE
            assert now < patience, f"not within {PATIENCE:.0f} s; reported: {self.report()}"
            self.executor.spin_once(timeout_sec=PAUSE)

    def publisher(self, message_type, topic, qos):
        return self.node.create_publisher(message_type, topic, qos)

    def connected(self, publisher):
        """A publisher that has found the node: a reliable subscription gets all that it publishes from now on.

        One of best effort gets what is published after the node has found the publisher, which a busy machine puts off.
        """
        self.until(publisher.get_subscription_count)
        return publisher

    def found(self, publisher):
        """The only publisher of samples, once the node has found it too."""
        self.until(lambda: self.reported("samples.publishers") == "1")
        return self.connected(publisher)

    def until_reported(self, condition, act=bool):
        """As `until`, for the node's latest report on itself; that report.

        Each report that comes is looked at, so that one that holds for a second alone is not missed.
        """
        self.until(lambda: self.heard["diagnostics"] and condition(self.report()), act)
        return self.report()

    def report(self):
        """The latest of the node's reports on itself, one that tells nothing where none has come yet."""
        heard = self.heard["diagnostics"]
        return decode_diagnostic_array(heard[-1])[0] if heard else Diagnostic("", STALE, "", {}, "")

    def statuses(self):
        """The latest status of each name."""
        heard = self.heard["diagnostics"]
        return {one.name: one for data in heard for one in decode_diagnostic_array(data)}.values()

    def reported(self, key):
        """A value of the latest report; None where it has none, or none has come yet."""
        return self.report().values.get(key)


def arguments_of(values):
    """Parameters as arguments of a node."""
    given = [f"{name}:={json.dumps(value)}" for name, value in values.items() if value not in ((), "")]
    return ["--ros-args", *[word for one in given for word in ("-p", one)]]


def without_numba(*path):
    """The environment of a process that finds no numba, and what else it finds in the place of PYTHONPATH."""
    found = path or os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, [str(WITHOUT_NUMBA), *found]))}


def serve(values, messages, outputs):
    """What the node publishes when it is told messages one by one, and which topics it reads."""
    done = subprocess.run(
        [sys.executable, str(Path(__file__).with_name("serve.py")), *arguments_of(values)],
        input=pickle.dumps((messages, outputs)),
        capture_output=True,
        env=without_numba(str(Path(__file__).parents[2]), *sys.path),
        timeout=120.0,
    )
    assert done.returncode == 0, done.stderr.decode()
    heard, read, _ = pickle.loads(done.stdout)
    return heard, read


def served_and_replayed(values, bag, output):
    """What the node publishes of the messages in a bag and what a replay writes, by topics; the topics it reads."""
    scenes = scenes_of(values)
    replay(bag, scenes, output=output)
    written = topics(output)
    replayed = {topic: [] for topic in written}
    for message in read_messages(output, written):
        replayed[message.topic].append(message.data)
    inputs = {f"/{one.name}" for one in inputs_of(scenes)}
    types = {topic: kind for topic, kind in topics(bag).items() if topic in inputs}
    messages = [(topic, types[topic], data) for topic, _, data in read_messages(bag, types)]
    heard, read = serve(values, messages, written)
    return heard, replayed, read


@contextmanager
def peer_of_node(outputs=tuple(OUTPUTS)):
    context = rclpy.Context()
    context.init()
    peer = Peer(context, outputs)
    yield peer
    peer.executor.shutdown()
    peer.node.destroy_node()
    context.shutdown()


@contextmanager
def running_node(scene, *arguments, numba=False):
    """The node as a process, with a parameter file and more arguments; it must end in order when asked to."""
    ros = ("--ros-args", "--params-file", str(scene), "-p", "messages:=strings", *arguments)
    environment = dict(os.environ) if numba else without_numba()
    with Child("node", environment, "-m", "impact_predictor.ros.node", *ros) as child:
        yield child
        child.end()
