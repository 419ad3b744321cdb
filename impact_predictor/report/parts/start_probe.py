"""What a start costs, step by step: a program of its own, so that nothing is loaded before.

    python start_probe.py [ROS ARGUMENTS]

Standard input gives a list of steps: the parameters of a scene whose predictor is made, or the name of a part of the
node. With arguments the first step is the node that they make. Every step prints the CPU time in ms and the memory in
MB that it adds. The node then prints the us of CPU time in which a message without a touchdown is published, received
and answered, with either executor; else that is 0. The program imports next to nothing itself: it would not be counted.
"""

import marshal
import os
import sys
import time
from typing import Any

MESSAGES = 200


def memory() -> float:
    """Resident MB of this process; 0 where the system does not tell."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123  # pathlib loads much
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") * 1e-6
    except OSError:
        return 0.0


def make_node() -> Any:
    """The node of the arguments."""
    import rclpy

    rclpy.init(args=sys.argv)
    from impact_predictor.ros.predictor_node import PredictorNode
    from impact_predictor.ros.process import executor_of

    node = PredictorNode()
    executor_of(node, node.executor_kind)
    return node


def take(step: dict[str, Any] | str, node: Any) -> object:
    """Make what a step is about."""
    if step == "geometry topic":
        from impact_predictor.ros.latched_topic import LatchedTopic
        from impact_predictor.ros.messages import POLYGON

        return LatchedTopic(node, print, "contact_geometry", POLYGON)
    if step == "events executor":
        from impact_predictor.ros.process import executor_of

        return executor_of(node, "events")
    from impact_predictor.prediction.monitor import Monitor
    from impact_predictor.prediction.scene import scenes_of

    return Monitor(scenes_of(step))  # type: ignore[arg-type]


def us_per_message(node: Any, values: dict[str, Any], kind: str) -> float:
    """What a message costs with an executor, of a body at rest far away."""
    from impact_predictor.prediction.types import Sample
    from impact_predictor.ros.messages import ODOMETRY, encode_odometry
    from impact_predictor.ros.process import executor_of, message_class

    runner, _ = executor_of(node, kind)
    runner.add_node(node)
    publisher = node.create_publisher(message_class(ODOMETRY), "/".join([*values["bodies"][:1], "odom"]), 10)
    nothing, covariance = (0.0, 0.0, 0.0), (0.0,) * 36
    spent, patience = [], time.monotonic() + 5.0
    while not publisher.get_subscription_count() and time.monotonic() < patience:
        runner.spin_once(timeout_sec=0.05)
    for _ in range(MESSAGES):
        stamp, served = time.time_ns(), node.served()
        data = encode_odometry(
            Sample(
                stamp,
                values["support.frame"],
                "",
                nothing,
                (0.0, 0.0, 0.0, 1.0),
                nothing,
                nothing,
                covariance,
                covariance,
            )
        )
        began = time.process_time()
        publisher.publish(data)
        while node.served() == served and time.monotonic() < patience:
            runner.spin_once(timeout_sec=0.1)
        spent.append(time.process_time() - began)
    runner.remove_node(node)
    node.destroy_publisher(publisher)
    return 1e6 * sorted(spent)[MESSAGES // 2]


def main() -> None:
    """Take every step."""
    steps = marshal.load(sys.stdin.buffer)
    node, kept = None, []
    for step in steps:
        had, began = memory(), time.process_time()
        if node is None and sys.argv[1:]:
            node = make_node()
        else:
            kept.append(take(step, node))
        print(1e3 * (time.process_time() - began), memory() - had)
    if node is None:
        print(0.0, 0.0)
    else:
        print(*[us_per_message(node, steps[0], kind) for kind in ("single", "events")])
        sys.stdout.flush()
        os._exit(0)  # the executors of this process end in no defined order


if __name__ == "__main__":
    # Instead of the folder of this file, whose modules have common names.
    sys.path[0] = __file__.rsplit(os.sep, 4)[0]
    main()
