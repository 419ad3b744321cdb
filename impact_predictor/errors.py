"""The one exception of this package, and what is to be installed where something is missing."""

from __future__ import annotations

from importlib import import_module
from typing import Final

EXTRAS: Final = {
    "contourpy": ("contourpy", "plot"),
    "dask": ("dask", "fleet"),
    "distributed": ("distributed", "fleet"),
    "jinja2": ("jinja2", "page"),
    "matplotlib": ("matplotlib", "plot"),
    "mujoco": ("mujoco", "robot"),
    "numba": ("numba", "fast"),
    "pinocchio": ("pin", "articulated"),
    "plotly": ("plotly", "page"),
    "pyarrow": ("pyarrow", "fleet"),
    "scipy": ("scipy", "calibrate"),
}
"""Modules that not every installation has: what brings each, and the extra of this package that does so."""


REQUIRED: Final = {"backports": "backports.zstd", "ruamel": "ruamel.yaml"} | {
    name: name for name in ("lz4", "mcap", "numpy", "rich", "rosbags")
}
"""What every installation by pip has, and one of colcon has not: ROS knows some of these by no name."""


class InputError(ValueError):
    """A file, a parameter or an argument is wrong; the message is one sentence: what, where, what to do."""


def missing(module: str) -> InputError | None:
    """What is to be installed for a module that cannot be imported; None where it is none that may be missing."""
    name = module.partition(".")[0]
    if name in REQUIRED:
        return InputError(
            f"this needs {REQUIRED[name]}, which is not installed: `pip install {' '.join(REQUIRED.values())}`; where "
            "pip refuses that, as beside a ROS of Debian or Ubuntu, in `python3 -m venv --system-site-packages venv`, "
            "and then start `venv/bin/python -m impact_predictor`"
        )
    if name not in EXTRAS:
        return None
    package, extra = EXTRAS[name]
    return InputError(
        f"this needs {package}, which is not installed: `pip install {package}`, "
        f"or `pip install 'impact_predictor[{extra}]'`"
    )


def need(*modules: str) -> None:
    """Import what a command is going to use, so that it can be refused before any work is done.

    Raises:
        InputError: a module is not installed.
    """
    try:
        for module in modules:
            import_module(module)
    except ModuleNotFoundError as error:
        raise missing(error.name or "") or error from error
