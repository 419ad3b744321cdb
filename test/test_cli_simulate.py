"""`impact-predictor simulate`: what it prints and writes, and one sentence for each mistake."""

from __future__ import annotations

import json
import shlex
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from command_line import answer_of, invoke, refusal_of
from matplotlib.image import imread

from impact_predictor.bags.read import read_messages, topics
from impact_predictor.commands import simulate_deck
from impact_predictor.commands.simulate import EXAMPLES
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import Scene
from impact_predictor.ros.messages import POLYGON, decode_polygon
from impact_predictor.scenarios.truth import TRUTH_TOPIC

ROOT = Path(__file__).parents[1]
GOLDEN = json.loads((ROOT / "test/mechanics/golden/motion.json").read_text())["rocking"]
BODIES = ["rod", "plate", "cylinder"]
THREE_RODS = ["rod", "--a", "0.1", "--a", "0.075", "--a", "0.05"]


pytestmark = pytest.mark.usefixtures("folder")

run = partial(invoke, "simulate")


def simulated(*arguments: str) -> Any:
    return answer_of(run(*arguments, "--json"))


def scene(name: str) -> Scene:
    return Scene.from_parameters(validate(read_parameters(ROOT / "config" / name)))


@pytest.mark.parametrize("case", GOLDEN, ids=lambda case: f"a = {case['a']}")
def test_the_json_of_a_rod_is_its_reference_sequence(case: dict[str, Any]) -> None:
    options = ["--length", case["length"], "--a", case["a"], "--b", case["b"], "--angle", case["release_angle_deg"]]
    answer = simulated("rod", *options)
    assert set(answer) == {"impacts", "accumulation_time", "end"}
    assert answer["end"] == "RESTS"
    # The sequences are known to 40 digits; the simulation is asked for 1e-9.
    assert answer["accumulation_time"] == pytest.approx(float(case["accumulation_time"]), rel=1e-9)
    assert len(answer["impacts"]) >= 8
    for impact, reference in zip(answer["impacts"][:8], case["impacts"][:8], strict=True):
        assert impact == {
            "mode": "PIVOT",
            **{name: pytest.approx(float(number), rel=1e-9) for name, number in reference.items()},
        }


def test_several_rods_are_a_list_of_each_alone() -> None:
    assert simulated(*THREE_RODS) == [simulated("rod", "--a", a) for a in ("0.1", "0.075", "0.05")]
    unequal = simulated("rod", "--a", "0.1", "--a", "0.05", "--b", "0.05", "--b", "0.1")
    assert unequal == [simulated("rod", "--a", "0.1", "--b", "0.05"), simulated("rod", "--a", "0.05", "--b", "0.1")]


def test_friction_restitution_law_slope_and_duration_reach_the_simulation() -> None:
    first = simulated("plate")["impacts"][0]
    assert simulated("plate", "--friction", "0.05")["impacts"][0]["mode"] != first["mode"] == "PIVOT"
    assert simulated("plate", "--slope", "10")["impacts"][0]["time"] > first["time"]
    assert simulated("plate", "--inertia", "1")["impacts"][0]["time"] > first["time"]
    assert simulated("plate", "--duration", "0.5")["end"] == "TIME_UP"
    bounces = [
        simulated("plate", "--height", "0.4", "--friction", "0.2", "--restitution", "0.4", "--law", law, "--angle", "5")
        for law in ("path", "total")
    ]
    assert bounces[0]["impacts"][0] != bounces[1]["impacts"][0]


def test_people_read_the_impacts_when_they_accumulate_and_the_end() -> None:
    result = run("rod")
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0] == "rod, a = b = 0.1 m"
    assert any(line.split()[:3] == ["0.166294", "B", "PIVOT"] for line in lines)
    assert "Impacts accumulate at 0.217703 s; then the body stays on both contacts." in lines
    assert lines[-1] == "The motion ends at 0.217703 s: rests."


@pytest.mark.parametrize("name", ["rocking_rod.yaml", "rocking_plate.yaml"])
def test_the_commands_of_a_shipped_scene_find_every_touchdown(folder: Path, name: str) -> None:
    head = (ROOT / "config" / name).read_text().partition("/**:")[0]
    lines = [shlex.split(line.removeprefix("#")) for line in head.splitlines() if "impact-predictor " in line]
    simulate, its_replay = (line[1:] for line in lines)
    assert invoke(*simulate).exit_code == 0
    (folder / "config").symlink_to(ROOT / "config")
    truth = answer_of(invoke(*its_replay, "--json"))["truth"]
    assert list(truth)[:3] == ["touchdowns", "missed", "false"]
    assert truth["touchdowns"] >= 3
    assert (truth["missed"], truth["false"], truth["mode_accuracy"]) == (0, 0, 1.0)
    assert truth["median_velocity_error"] < 1e-9
    said = invoke(*its_replay).stdout
    assert f"Against the truth in the bag: {truth['touchdowns']} of {truth['touchdowns']} touchdowns found" in said


@pytest.mark.parametrize("body", ["rod", "plate"])
def test_a_shipped_scene_is_the_body_of_the_command(body: str) -> None:
    shipped = scene(f"rocking_{body}.yaml")
    assert run(body, "-o", "bag").exit_code == 0
    (message,) = read_messages("bag", {"/contact_geometry": POLYGON})
    told = [part for point in decode_polygon(message.data).points for part in point]
    assert told == pytest.approx([part for point in shipped.points for part in point], rel=1e-7)


def test_the_options_of_the_bag(folder: Path) -> None:
    run(*THREE_RODS, "-o", "rods", "--rate", "100")
    assert set(topics("rods")) == {
        *(f"/rod_{k}/{name}" for k in (1, 2, 3) for name in ("odom", "contact_geometry")),
        TRUTH_TOPIC,
    }
    assert len(list(read_messages("rods", {"/rod_1/odom": topics("rods")["/rod_1/odom"]}))) == 1 + int(46.77)
    assert run("cylinder", "-o", "cylinder").exit_code == 2


@pytest.fixture
def short_voyages(monkeypatch: pytest.MonkeyPatch) -> None:
    """A twentieth of the time that a deck sails, where only that a line works counts."""
    monkeypatch.setattr(simulate_deck, "DURATION", 0.05 * simulate_deck.DURATION)


@pytest.mark.slow
@pytest.mark.usefixtures("short_voyages")
def test_the_documentation_is_what_its_lines_make(folder: Path) -> None:
    page = (ROOT / "docs/simulation.md").read_text(encoding="utf-8")
    # Robots need MuJoCo: test_cli_simulate_robot.py.
    robots = page.index("## Robots"), page.index("## ", page.index("## Robots") + 1)
    page = page[: robots[0]] + page[robots[1] :]
    lines = [line.strip() for line in page.splitlines() if line.startswith("    impact-predictor ")]
    (folder / "config").symlink_to(ROOT / "config")
    for line in lines:
        assert invoke(*shlex.split(line)[1:]).exit_code == 0
    assert "](rocking_rods.png)" in page
    made, shown = (imread(path).shape for path in ("rocking_rods.png", ROOT / "docs/rocking_rods.png"))
    assert made == shown


@pytest.mark.slow
@pytest.mark.parametrize("body", BODIES)
def test_every_example_works(folder: Path, body: str) -> None:
    for line in EXAMPLES[body]:
        assert line in run(body, "--help").stdout
        result = invoke(*shlex.split(line)[1:])
        assert result.exit_code == 0, result.stderr
        files = [name for name in shlex.split(line) if "." in name and not name.replace(".", "").isdigit()]
        assert all(Path(name).exists() for name in files)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["rod", "--length", "-1"], "length is -1.0; give a finite number above 0"),
        (["rod", "--angle", "90"], "90.0 is not in the range -90.0<x<90.0"),
        (["rod", "--restitution", "2"], "restitution is 2.0; give a number from 0 to 1"),
        (["rod", "--a", "0.1", "--b", "0.1", "--b", "0.2"], "--a is given 1 times but --b 2 times"),
        (["rod", "--duration", "0"], "duration is 0.0; give a number between 0 and 1e9"),
        (["rod", "--rate", "10"], "--rate is that of a bag: give -o BAG too"),
        (["rod", "--a", "0.3"], "a is 0.3; give a distance in m that ends within the body, at most 0.2"),
        (["plate", "--b", "1.1"], "b is 1.1; give a distance in m that ends within the body, at most 1"),
        (["rod", "-o", "x.mcap", "--rate", "0"], "rate is 0.0; give a number above 0, up to 1e6"),
        (["rod", "--friction", "nan"], "friction is nan"),
        (["plate", "--plot", "x.gif"], "give a name that ends in .png or .svg"),
        (["plate", "--plot", "no/x.png"], "the folder of no/x.png does not exist"),
        (["plate", "-o", "taken"], "taken is there and is not an output of impact_predictor"),
        (["rod", "-o", "rod.txt"], "rod.txt is no bag; give a name that ends in .mcap, or a folder without an ending"),
        (["cylinder", "--gamma", "95"], "--gamma is 95, for both edges; give degrees between 0 and 90"),
        (
            ["cylinder", "--gamma", "95", "--gamma-new", "95"],
            "--gamma and --gamma-new have the sum 190; give degrees between 0 and 180",
        ),
    ],
)
def test_a_mistake_is_said_in_one_sentence_and_nothing_is_written(
    folder: Path, arguments: list[str], sentence: str
) -> None:
    (folder / "taken").write_text("something else")
    assert sentence in refusal_of(run(*arguments))
    assert [file.name for file in folder.iterdir()] == ["taken"]


@pytest.mark.parametrize(
    ("name", "option", "last"),
    [
        ("rod.mcap", "-o", "rosbags.rosbag2.Writer.close"),
        ("rod.png", "--plot", "matplotlib.figure.Figure.savefig"),
    ],
)
def test_what_is_interrupted_leaves_no_output_named_as_whole(
    folder: Path, monkeypatch: pytest.MonkeyPatch, name: str, option: str, last: str
) -> None:
    def interrupt(*arguments: Any, **named: Any) -> None:
        for one in arguments:
            if isinstance(one, Path):
                one.write_bytes(b"half")
        raise KeyboardInterrupt

    arguments = ["rod", option, name]
    assert run(*arguments).exit_code == 0
    older = Path(name).read_bytes()
    monkeypatch.setattr(last, interrupt)
    assert run(*arguments).exit_code == 130
    assert Path(name).read_bytes() == older
    Path(name).unlink()
    assert run(*arguments).exit_code == 130
    assert not Path(name).exists()
