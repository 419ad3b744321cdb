"""`impact-predictor map`: what it writes and prints, and one sentence for each mistake."""

from __future__ import annotations

import json
import shlex
from functools import partial
from pathlib import Path

import pytest
from command_line import invoke, refusal_of

from impact_predictor.commands.progress import compiling_is_said
from impact_predictor.mechanics.compiled import COMPILING

BODIES = ["plate", "rod", "cylinder"]
DOCS = Path(__file__).parents[1] / "docs"


pytestmark = pytest.mark.usefixtures("folder")

run = partial(invoke, "map")


def examples() -> list[str]:
    return [
        line.strip()
        for body in [[], *([body] for body in BODIES)]
        for line in run(*body, "--help").stdout.splitlines()
        if line.startswith("    impact-predictor map ")
    ]


@pytest.mark.parametrize("example", sorted(set(examples())))
def test_every_example_draws_a_map(folder: Path, example: str) -> None:
    arguments = shlex.split(example)[2:]
    result = run(*arguments, "--resolution", "40")
    assert result.exit_code == 0, result.stderr
    assert len(list(folder.iterdir())) == (0 if "--json" in arguments else max(1, arguments.count("-o")))


def quoted(command: str) -> list[str]:
    """The lines of docs/mechanics.md that call a command."""
    lines = (DOCS / "mechanics.md").read_text(encoding="utf-8").splitlines()
    return [line.strip() for line in lines if line.startswith(f"    impact-predictor {command} ")]


@pytest.mark.parametrize("line", quoted("map"))
def test_the_pictures_of_the_documentation_are_made_by_the_lines_beside_them(folder: Path, line: str) -> None:
    assert run(*shlex.split(line)[2:], "--resolution", "30").exit_code == 0
    (picture,) = folder.iterdir()
    assert f"]({picture.name})" in (DOCS / "mechanics.md").read_text(encoding="utf-8")
    assert (DOCS / picture.name).is_file()


def test_the_impacts_of_the_documentation_end_as_it_says() -> None:
    slips, jams = (json.loads(invoke(*shlex.split(line)[1:], "--json").stdout) for line in quoted("solve"))
    assert (slips["mode"], slips["segments"]) == ("STOP", ["--", "SS"])
    assert jams["mode"] == "BACK_PIVOT"
    assert "JAMMED" in jams["flags"]


def test_several_files_are_written_in_the_formats_of_their_names(folder: Path) -> None:
    result = run("plate", "--resolution", "20", "-o", "a.svg", "-o", "b.PNG", "-o", "c.csv")
    assert result.stdout.splitlines()[-3:] == ["Picture: a.svg", "Picture: b.PNG", "Data: c.csv"]
    assert (folder / "a.svg").read_text().startswith("<?xml")
    assert (folder / "b.PNG").read_bytes().startswith(b"\x89PNG")
    assert len((folder / "c.csv").read_text().splitlines()) == 401


def test_json_is_all_that_is_printed_and_the_options_reach_the_law(folder: Path) -> None:
    options = ["--x", "friction-old", "0", "3", "--y", "inertia", "0.1", "2", "--friction-new", "0.2", "--height", "4"]
    answer = json.loads(run("plate", *options, "--slip", "-1", "--law", "total", "--json", "--resolution", "50").stdout)
    assert answer["x"] == {"name": "friction_old", "low": 0.0, "high": 3.0}
    assert answer["y"] == {"name": "inertia", "low": 0.1, "high": 2.0}
    assert answer["law"] == "total"
    # Both frictions are told, so that the friction of both contacts is none of them.
    assert answer["fixed"] == {"length": 1.0, "height": 4.0, "friction_new": 0.2, "restitution": 0.0, "slip": -1.0}
    assert answer["resolution"] == 50
    assert answer["jammed"] > 0.05
    assert answer["path_not_unique"] > 0.3
    assert sum(answer["shares"].values()) == pytest.approx(1.0)
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["plate", "--x", "warp", "0", "1"], "there is no parameter 'warp' for an axis; give one of delta, length"),
        (["plate", "--friction", "0.3"], "friction is an axis of the map and --friction a number"),
        (["rod", "--x", "a", "0.2", "0"], "the axis a goes from 0.2 to 0; give two finite numbers, the lower one"),
        (
            ["cylinder", "--x", "gamma", "0", "180"],
            "gamma + gamma-new is 180.1",
        ),
        (["rod", "--x", "friction", "0", "1"], "both axes, --x and --y, are friction; give two parameters"),
        (["plate", "--x", "delta", "0", "nan"], "the axis delta goes from 0 to nan"),
        (["plate", "--height", "0.1"], "delta and height are one thing"),
        (["plate", "--x", "delta", "-1", "1", "--resolution", "4"], "height is -0.75; give a finite number above 0"),
        (["plate", "--slip", "inf"], "slip is inf; give a number of at most 1e6"),
        (["plate", "--friction-new", "-1"], "friction_new is -1.0; give a finite"),
        (["plate", "--restitution", "3"], "restitution is 3.0; give a number from 0 to 1"),
        (["plate", "-o", "map.pdf"], "map.pdf is no picture or data; give a name that ends in .png or .svg or .csv"),
        (["plate", "-o", "no/map.png"], "the folder of no/map.png does not exist"),
        (["plate", "--resolution", "1"], "1 is not in the range 2<=x<=5000"),
        (["plate", "--x", "delta", "0"], "'--x' requires 3 arguments"),
        (["plate", "--gamma", "3"], "No such option"),
    ],
)
def test_a_mistake_is_said_in_one_sentence_and_nothing_is_written(
    folder: Path, arguments: list[str], sentence: str
) -> None:
    assert sentence in refusal_of(run(*arguments))
    assert list(folder.iterdir()) == []


def test_the_first_compilation_is_said_once(capsys: pytest.CaptureFixture[str]) -> None:
    numba = pytest.importorskip("numba")
    twice = numba.njit(lambda value: 2.0 * value)
    with compiling_is_said():
        assert twice(1.0) + twice(1) == 4.0
    assert capsys.readouterr().err == f"note: {COMPILING}\n"
    with compiling_is_said():
        assert twice(2.0) == 4.0
    assert capsys.readouterr().err == ""
