"""The node in lock step: a message is published when the one before is served, so that nothing depends on timing.

    python test/ros/serve.py ROS ARGUMENTS

Standard input gives a pickle of (messages, outputs): topic, type and bytes of each message, and the type of each topic
to hear. Messages on topics that the node does not read are left out, as are contact points that it knows already.
Standard output gives a pickle of the bytes heard by topic, the topics that the node reads, and the modules it loads.
"""

import os
import pickle
import sys
import time

PATIENCE = 60.0
SILENCE = 50
"""Rounds without a message after which all was heard."""


def main() -> None:
    messages, outputs = pickle.load(sys.stdin.buffer)
    import rclpy

    import impact_predictor.ros.node  # noqa: F401  # the program loads it too

    rclpy.init(args=sys.argv)
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node

    from impact_predictor.ros.predictor_node import PredictorNode
    from impact_predictor.ros.process import executor_of, message_class

    node, other = PredictorNode(), Node("other", use_global_arguments=False)
    runner = executor_of(node, node.executor_kind)
    runner.add_node(node)
    hearing = SingleThreadedExecutor()
    hearing.add_node(other)

    def until(true, executor=runner):
        patience = time.monotonic() + PATIENCE
        while not true():
            assert time.monotonic() < patience, {topic: len(data) for topic, data in heard.items()}
            executor.spin_once(timeout_sec=0.003)

    heard = {topic: [] for topic in outputs}
    for topic, kind in outputs.items():
        other.create_subscription(message_class(kind), topic, heard[topic].append, 10_000, raw=True)
    topics = {one.topic_name for one in node.subscriptions}
    types = {topic: kind for topic, kind, _ in messages if topic in topics}
    publishers = {topic: other.create_publisher(message_class(kind), topic, 100) for topic, kind in types.items()}
    spoken = [one for one in node.publishers if one.topic_name in outputs]
    until(lambda: all(one.get_subscription_count() for one in (*publishers.values(), *spoken)))
    predictors = node._monitor.predictors
    for topic, _, data in messages:
        predictor = predictors.get(topic[1:].rpartition("/")[0])
        if topic.endswith("contact_geometry") and predictor.scene.walking is None:
            if topic in topics and not predictor._points:
                publishers[topic].publish(data)
                until(lambda predictor=predictor: predictor._points)
        elif topic in topics:
            served = node.served()
            publishers[topic].publish(data)
            until(lambda served=served: node.served() > served)
    node.finish()
    counts = [0]

    def silent():
        counts.append(sum(map(len, heard.values())))
        return len(counts) > SILENCE and counts[-SILENCE] == counts[-1]

    until(silent, hearing)
    sys.stdout.buffer.write(pickle.dumps((heard, topics, set(sys.modules))))
    sys.stdout.flush()
    os._exit(0)  # the executors of this process end in no defined order


if __name__ == "__main__":
    main()
