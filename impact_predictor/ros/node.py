"""The node `impact_predictor`: bytes of samples in, bytes of predictions out, with the predictor in between."""

from __future__ import annotations

import gc
import os
import sys
from functools import partial
from typing import Final

from .process import Stop, only_for_ros, run, spin

USAGE: Final = """\
predictor --ros-args --params-file scene.yaml -r odom:=/robot/odom

The node of impact_predictor: it predicts touchdowns from the samples that arrive, until Ctrl-C.

All arguments are those of ROS, and follow --ros-args:
  --params-file FILE   parameters of the scene, as in config/cube_tosses.yaml
  -p NAME:=VALUE       one parameter, after the file in the place of that in it
  -r FROM:=TO          the topic TO in the place of the input FROM

docs/node.md has topics and parameters; with a sourced ROS 2 the start is `ros2 run impact_predictor predictor ...`."""


def main(args: list[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM; the exit status."""
    # Read when numpy is loaded. A second thread of a product waits for the first in a loop, which holds up what runs
    # beside the node: on a busy machine a fit of the sea took 90 ms, and takes 3 ms.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    refused = only_for_ros(args, USAGE)
    return run(partial(_serve, args), args) if refused is None else refused


def _serve(args: list[str] | None, stop: Stop) -> int:
    # ROS may be missing: whoever starts this program is to learn so in one sentence.
    from .predictor_node import PredictorNode

    try:
        node = PredictorNode(lambda: stop.requested, args)
    except KeyboardInterrupt:
        return 0
    # All that is loaded now stays: to look at it again would hold the messages up for 20 ms and more, now and then.
    gc.freeze()
    try:
        spin(node, stop, node.served, node.executor_kind)
        node.finish()
    finally:
        node.destroy_node()
    return 0


if __name__ == "__main__":
    sys.exit(main())
