"""The node `impact_predictor`: bytes of samples in, bytes of predictions out, with the predictor in between."""

from __future__ import annotations

import gc
import sys

from .process import Stop, run, spin


def main(args: list[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM; the exit status."""
    return run(_serve, args)


def _serve(stop: Stop) -> int:
    # ROS may be missing: whoever starts this program is to learn so in one sentence.
    from .predictor_node import PredictorNode

    node = PredictorNode()
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
