"""`impact-predictor replay` of many bags: what it says of them, what it keeps, and what it needs."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from impact_predictor import read_scenes
from impact_predictor.cli import main
from impact_predictor.commands import outcomes
from impact_predictor.commands import replay as command
from impact_predictor.fleet import cluster
from impact_predictor.fleet.job import BagOutcome, Job, failed, replay_bag

SCENE = str(Path(__file__).parents[2] / "config/cube_tosses.yaml")


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["replay", *arguments, "--params", SCENE], terminal_width=80)


@pytest.fixture
def many(monkeypatch: pytest.MonkeyPatch, bags: list[str]) -> list[str]:
    """More bags than have tables: each has the outcome of the first one, but the second of them fails."""
    outcome = replay_bag(Job(read_scenes(SCENE), {}, answers=True), bags[0], None)
    assert outcome.result is not None
    result = outcome.result

    def told(job: Job, given: tuple[str, ...], outputs: list[Path | None]) -> Iterator[BagOutcome]:
        for number, bag in enumerate(given):
            same = outcome._replace(bag=bag, result=result._replace(bag=bag), answer=outcome.answer | {"bag": bag})
            yield failed(bag, f"{bag} is no bag") if number == 1 else same

    monkeypatch.setattr(command, "one_by_one", told)
    monkeypatch.setattr(outcomes, "MANY", 4)
    return [f"run_{number}.mcap" for number in range(5)]


def test_many_bags_have_a_line_each_and_their_notes_are_said_once(many: list[str]) -> None:
    result = run(*many)
    assert result.exit_code == 2
    lines = [line for line in result.stdout.splitlines() if line.startswith("run_")]
    assert len(lines) == len(many) - 1
    assert "touchdowns scored" in lines[0]
    assert f"{len(many) - 1} bags together" in result.stdout
    assert result.stderr.count("error: run_1.mcap is no bag") == 1
    notes = [line for line in result.stderr.splitlines() if line.startswith("note: ")]
    assert notes
    assert all(line.startswith(f"note: of {len(many) - 1} bags: ") for line in notes)
    assert "too slow" in run(*many, "--all").stdout.partition("run_2.mcap")[0]


def test_the_json_of_many_bags_is_one_list_although_it_is_printed_bag_by_bag(many: list[str]) -> None:
    answers = json.loads(run(*many, "--json").stdout)
    assert [answer["bag"] for answer in answers] == many
    assert answers[1] == {"bag": "run_1.mcap", "error": "run_1.mcap is no bag"}


def test_after_ctrl_c_what_is_done_is_told_as_if_it_had_been_all(
    monkeypatch: pytest.MonkeyPatch, many: list[str]
) -> None:
    told = command.one_by_one

    def interrupted(*asked: object) -> Iterator[BagOutcome]:
        outcomes = told(*asked)  # type: ignore[arg-type]
        yield from (next(outcomes) for _ in range(3))
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "one_by_one", interrupted)
    result = run(*many, "--json")
    assert result.exit_code == 130
    assert [answer["bag"] for answer in json.loads(result.stdout)] == many[:3]
    assert f"note: stopped after 3 of {len(many)} bags" in result.stderr


@pytest.mark.parametrize(
    ("missing", "arguments"),
    [
        ("distributed", ["--workers", "2"]),
        ("distributed", ["--scheduler", "tcp://localhost:8786"]),
        ("pyarrow", ["--table", "t.parquet"]),
    ],
)
def test_what_the_extra_brings_is_missed_in_one_sentence(
    monkeypatch: pytest.MonkeyPatch, bags: list[str], missing: str, arguments: list[str]
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    result = run(*bags, *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    (line,) = result.stderr.splitlines()
    assert line.startswith(f"error: this needs {missing}, which is not installed")
    assert line.endswith("`pip install 'impact_predictor[fleet]'`")


@pytest.mark.slow  # in a fresh process
def test_one_worker_needs_nothing_of_dask(bags: list[str]) -> None:
    code = (
        "import sys; from click.testing import CliRunner; from impact_predictor.cli import main\n"
        f"result = CliRunner().invoke(main, ['replay', {bags[0]!r}, {bags[1]!r}, '--params', {SCENE!r}])\n"
        "print(result.exit_code, *{'dask', 'distributed', 'pyarrow'} & sys.modules.keys())"
    )
    assert subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout == "0\n"


def test_a_scheduler_gets_absolute_paths_and_what_is_told_has_the_names_that_were_given(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, bags: list[str]
) -> None:
    sent: list[str] = []

    class Sent:
        def __init__(self, client: None, job: Job, bags: list[str], outputs: list[Path]) -> None:
            sent.extend([*bags, *map(str, outputs)])
            self.outcomes: Callable[[object], Iterator[BagOutcome]] = lambda bar: map(
                replay_bag, [job] * len(bags), bags, outputs
            )

    monkeypatch.setattr(cluster, "connected", lambda *_: nullcontext())
    monkeypatch.setattr(cluster, "Fleet", Sent)
    monkeypatch.chdir(Path(bags[0]).parent)
    given = [Path(bags[0]).name, "missing.mcap"]
    near, far = (run(*given, "--json", "-o", "out", *more) for more in ([], ["--scheduler", "tcp://localhost:8786"]))
    assert sent == [bags[0], str(Path("missing.mcap").absolute()), *(str(Path("out", one).absolute()) for one in given)]
    assert far.stderr == near.stderr

    def told(answers: str) -> list[object]:
        return [{key: value for key, value in one.items() if "us" not in key} for one in json.loads(answers)]

    assert told(far.stdout) == told(near.stdout)
