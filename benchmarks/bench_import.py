"""How long imports take, each in a fresh process.

    python benchmarks/bench_import.py

Prints a row for each: median, spread and worst of the runs in ms, Python's own start not included. What a scene leaves
out is not imported: `bench_parts.py` shows what each feature adds.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
from typing import Final

from rich.console import Console
from rich.table import Table

RUNS: Final = 15
LIMIT: Final = 150.0
"""ms that the library may take."""

NODE: Final = "impact_predictor.prediction.predictor, impact_predictor.ros.messages"
IMPORTS: Final = {
    "the library": "impact_predictor, impact_predictor.mechanics.impact",
    "what the node needs besides ROS": NODE,
    "the plugin, after pytest itself": "impact_predictor.testing.plugin",
    "impact-predictor --help": "impact_predictor.cli",
    "impact-predictor solve": "impact_predictor.cli, impact_predictor.report.outcome",
    "impact-predictor replay": "impact_predictor.cli, impact_predictor.bags.replay, impact_predictor.report.replay",
    "... --report": "impact_predictor.cli, impact_predictor.report.page.replay",
    "impact-predictor explain": "impact_predictor.cli, impact_predictor.prediction.scene",
}
LOADED: Final = {"the plugin, after pytest itself": "pytest"}
"""What is loaded before the clock starts."""

TIMED: Final = "import time, {}; begin = time.perf_counter(); import {}; print(1e3 * (time.perf_counter() - begin))"


def milliseconds(modules: str, loaded: str = "sys") -> list[float]:
    """How long an import takes, one number for each run; the first, which fills the caches, is left out."""
    command = [sys.executable, "-c", TIMED.format(loaded, modules)]
    runs = [subprocess.run(command, check=True, capture_output=True, text=True) for _ in range(RUNS + 1)]
    return [float(run.stdout) for run in runs[1:]]


def main() -> int:
    """Print the table; the exit status says whether the library is fast enough."""
    table = Table("import of", "median", "5 to 95 %", "worst", title=f"Import times in ms, {RUNS} runs each")
    medians = {}
    for name, modules in IMPORTS.items():
        times = milliseconds(modules, LOADED.get(name, "sys"))
        low, *_, high = statistics.quantiles(times, n=20)
        medians[name] = statistics.median(times)
        table.add_row(name, f"{medians[name]:.0f}", f"{low:.0f} to {high:.0f}", f"{max(times):.0f}")
    Console().print(table)
    return 0 if medians["the library"] <= LIMIT else 1


if __name__ == "__main__":
    sys.exit(main())
