"""Solo12 and its controller as a ROS 2 node at 500 Hz, which goes by what the predictor tells over topics.

    predictor --ros-args --params-file config/walker.yaml -p messages:=strings
    python3 examples/walker_controller/node.py --ros-args -p seed:=1

It publishes `contact_geometry` and `odom`, and listens to `/impact_predictor/prediction` (remap it for a predictor of
another name). A walk that has ended begins anew after a pause. Parameter `seed`: of the ground and the pushes.
"""

from __future__ import annotations

import sys

from impact_predictor.ros.process import Stop, run


def main(args: list[str] | None = None) -> int:
    """Walk until SIGINT or SIGTERM; the exit status."""
    return run(_serve, args)


def _serve(stop: Stop) -> int:
    # Numpy's library begins threads when it is loaded: they are to leave the signals to the program.
    from walker import walk

    return walk(stop)


if __name__ == "__main__":
    sys.exit(main())
