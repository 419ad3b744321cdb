"""Size of the page of many replays, and the time it takes: python benchmarks/bench_replay_page.py [--bags 2000]

The answers are made from those of the cube tosses: each bag has 50 of their touchdowns, with other errors.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

from impact_predictor.bags.replay import replay
from impact_predictor.parameters.file import read_values
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.report.answers import as_json
from impact_predictor.report.page.replay import write_replay_page

ROOT = Path(__file__).parent.parent
SCORED, OTHERS = 10, 40


def made(source: dict[str, Any], number: int, random: Random) -> dict[str, Any]:
    """The answer of a bag with some of the touchdowns, its errors and measured velocities changed at random."""
    scored = [one for one in source["touchdowns"] if one["scored"]]
    others = [one for one in source["touchdowns"] if not one["scored"]]
    factor = random.lognormvariate(0.0, 0.4)
    changed = [
        one
        | {
            "relative_error": factor * one["relative_error"],
            "measured_twist": [part + random.gauss(0.0, 0.05) for part in one["measured_twist"]],
        }
        for one in random.sample(scored, SCORED)
    ]
    touchdowns = sorted([*changed, *random.sample(others, OTHERS)], key=lambda one: one["stamp"])
    return source | {"bag": f"day_{number // 100}/run_{number:04d}.mcap", "touchdowns": touchdowns}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bags", type=int, default=2000)
    bags = parser.parse_args().bags
    values = read_values(ROOT / "config/cube_tosses.yaml")
    source = as_json(replay(ROOT / "examples/cube_tosses", scenes_of(values)))
    random = Random(1)
    with TemporaryDirectory() as folder:
        for count in (1, bags):
            answers = [source if count == 1 else made(source, number, random) for number in range(count)]
            touchdowns = sum(len(answer["touchdowns"]) for answer in answers)
            file, began = Path(folder) / "replay.html", process_time()
            write_replay_page(file, answers)
            seconds, size = process_time() - began, file.stat().st_size / 1e6
            print(f"{count:,} bags, {touchdowns:,} touchdowns: {size:.2f} MB in {seconds:.1f} s of CPU time")


if __name__ == "__main__":
    main()
