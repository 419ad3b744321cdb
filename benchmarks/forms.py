"""A benchmark in both forms, compiled and as Python, in one run."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable

from impact_predictor.native import form


def in_both_forms(main: Callable[[], int | None]) -> int:
    """Carry out a benchmark, and where that runs compiled once more as Python; the exit status."""
    print(f"The predictor runs {form()}.", flush=True)
    status = main() or 0
    if form() == "compiled":
        environment = os.environ | {"IMPACT_PREDICTOR_PLAIN": "1"}
        status = subprocess.run([sys.executable, *sys.argv], env=environment, check=False).returncode or status
    return status
