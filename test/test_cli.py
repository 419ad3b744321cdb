"""The command line: what it prints where, its exit statuses, and one sentence for each mistake."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from command_line import refusal_of

from impact_predictor import Flag, Mode, Outcome, Twist, __version__, plate, solve_impact
from impact_predictor.bags.read import BagMessage, read_messages, topics
from impact_predictor.bags.write import BagWriter
from impact_predictor.cli import main
from impact_predictor.commands import progress
from impact_predictor.ros.messages import ODOMETRY, POLYGON

ROOT = Path(__file__).parents[1]
SCENE = str(ROOT / "config/cube_tosses.yaml")
WANTED = {"/cube/odom": ODOMETRY, "/cube/contact_geometry": POLYGON}
END = 75_000_000_000
"""Log time in ns that ends the excerpt: four tosses."""

PLATE = ["solve", "plate", "--length", "1", "--height", "0.4", "--mass", "10", "--friction", "0.2"]
BODY = ["solve", "body", "--mass", "10", "--inertia", "1"]
HEAVY = {"matplotlib", "numpy", "rclpy", "rich", "rosbags", "scipy"}


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, arguments, terminal_width=80)


def refused(*arguments: str) -> str:
    return refusal_of(run(*arguments))


@pytest.fixture(scope="module")
def messages() -> list[BagMessage]:
    excerpt = []
    for message in read_messages(ROOT / "examples/cube_tosses/cube_tosses.mcap", WANTED):
        if message.log_time > END:
            break
        excerpt.append(message)
    return excerpt


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory, messages: list[BagMessage]) -> str:
    return write_bag(tmp_path_factory.mktemp("excerpt") / "tosses.mcap", messages)


def write_bag(path: Path, messages: list[BagMessage]) -> str:
    with BagWriter(path) as writer:
        for topic, log_time, data in messages:
            writer.write(topic, WANTED[topic], log_time, data)
    return str(path)


COMMANDS = [
    ["demo"],
    ["solve"],
    ["solve", "plate"],
    ["solve", "rod"],
    ["solve", "cylinder"],
    ["solve", "body"],
    ["replay"],
    ["lashings"],
]


@pytest.mark.parametrize("command", [[], *COMMANDS], ids=" ".join)
def test_every_command_has_help_with_examples(command: list[str]) -> None:
    result = run(*command, "--help")
    assert result.exit_code == 0
    assert "Examples:\n    impact-predictor " in result.stdout


def examples() -> list[str]:
    return [
        line.strip()
        for command in COMMANDS
        if command[0] == "solve"
        for line in run(*command, "--help").stdout.splitlines()
        if line.startswith("    impact-predictor ")
    ]


@pytest.mark.parametrize("example", examples())
def test_every_example_of_solve_shows_an_impact(example: str) -> None:
    result = run(*example.split()[1:])
    assert (result.exit_code, result.stderr) == (0, "")
    assert "NO_IMPACT" not in result.stdout


def test_the_version_is_that_of_the_package() -> None:
    assert run("--version").stdout == f"impact-predictor {__version__}\n"


@pytest.mark.parametrize("command", [[], ["solve"]])
def test_a_missing_command_is_said(command: list[str]) -> None:
    assert "Missing command" in refused(*command)


def test_a_wrong_option_is_said_in_one_line_that_names_the_help() -> None:
    assert refused("replay", "--speed", "3").endswith("replay --help`")
    assert "Missing option '--height'" in refused("solve", "plate", "--length", "1")
    assert "'x' is not a valid float" in refused(*PLATE, "--omega", "x")
    three = refused(*PLATE, "--twist", "0.3", "-0.5", "--json")
    assert "'--json' is not a valid float, and --twist takes VX VY OMEGA; see" in three


def test_help_and_solve_load_nothing_that_they_do_not_need() -> None:
    code = "\n".join(
        (
            "import atexit, sys",
            "from impact_predictor.cli import main",
            f"atexit.register(lambda: print(*({HEAVY} & sys.modules.keys()), file=sys.stderr))",
            "main()",
        )
    )
    for arguments in ["--help"], ["replay", "--help"], [*PLATE, "--omega", "-1", "--json"]:
        command = [sys.executable, "-c", code, *arguments]
        assert subprocess.run(command, check=True, capture_output=True, text=True).stderr.split() == []


def test_solve_prints_the_outcome_of_the_library_as_json() -> None:
    answer = json.loads(run(*PLATE, "--omega", "-1", "--json").stdout)
    body = plate(length=1.0, height=0.4, mass=10.0, friction=0.2)
    outcome = solve_impact(body, body.turning(-1.0))
    assert answer.keys() == {*Outcome._fields, "margins"} - {"body", "restitution"}
    assert answer["margins"]["friction"] == {"change": outcome.margins.friction.change, "mode": "STOP"}
    assert answer["margins"]["slip"] is None
    assert answer["mode"] == outcome.mode.name
    assert answer["twist"] == list(outcome.twist)
    assert answer["impulses"] == [list(impulse) for impulse in outcome.impulses]
    assert answer["segments"] == list(outcome.segments)


def test_both_laws_give_a_list() -> None:
    answers = json.loads(run(*PLATE, "--omega", "-1", "--law", "both", "--json").stdout)
    assert [answer["law"] for answer in answers] == ["path", "total"]


def test_a_body_that_turns_away_has_no_impact_and_a_hint_says_which_way_it_would() -> None:
    result = run(*PLATE, "--omega", "1", "--json")
    assert result.exit_code == 0
    assert json.loads(result.stdout)["mode"] == "NO_IMPACT"
    assert "towards it the body turns clockwise, negative: --omega -1" in result.stderr


def test_any_twist_may_be_given() -> None:
    answer = json.loads(run(*PLATE, "--twist", "0.2", "-0.5", "-1", "--json").stdout)
    assert answer == json.loads(run(*PLATE, "--omega", "-1", "--json").stdout)
    result = run(*PLATE, "--twist", "0.2", "0.5", "0", "--json")
    assert "the new contact is not approached: its normal velocity, 0.5 m/s" in result.stderr


def test_any_body_is_the_plate_of_the_same_numbers() -> None:
    contacts = ["--old", "-0.5", "-0.2", "0.2", "--new", "0.5", "-0.2", "0.2", "--old-normal", "0", "2"]
    body = run("solve", "body", "--mass", "12", "--inertia", "1.16", *contacts, "--omega", "-1", "--json")
    same = run(*PLATE[:6], "--mass", "12", "--friction", "0.2", "--omega", "-1", "--json")
    assert json.loads(body.stdout)["twist"] == pytest.approx(json.loads(same.stdout)["twist"], abs=1e-15)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([*PLATE], "Give either --omega OMEGA or --twist VX VY OMEGA"),
        ([*PLATE, "--omega", "1", "--twist", "0", "0", "1"], "Give either --omega OMEGA or --twist VX VY OMEGA"),
        ([*PLATE, "--omega", "-1", "--length", "-1"], "length is -1.0; give a finite number above 0"),
        ([*PLATE, "--omega", "-1", "--restitution", "2"], "restitution is 2.0; give a number from 0 to 1"),
        ([*PLATE, "--omega", "nan"], "give finite numbers"),
        ([*PLATE, "--omega", "-1", "--law", "newton"], "'newton' is not one of"),
        ([*BODY, "--new", "0.5", "0", "0.1", "--omega", "1"], "Give either --old X Y FRICTION or --no-old"),
        ([*BODY, "--no-old", "--new", "0.5", "0", "0.1", "--omega", "1"], "turns about nothing"),
        ([*BODY, "--no-old", "--new", "0.5", "0", "-0.1", "--twist", "0", "-1", "0"], "friction is -0.1"),
        (
            [*BODY, "--no-old", "--new", "0.5", "0", "0.1", "--new-normal", "0", "0", "--twist", "0", "-1", "0"],
            "--new-normal is 0 0, which has no direction",
        ),
    ],
)
def test_solve_says_what_is_wrong_with_its_numbers(arguments: list[str], sentence: str) -> None:
    assert sentence in refused(*arguments)


def test_an_impact_without_a_solution_is_no_success(monkeypatch: pytest.MonkeyPatch) -> None:
    outcome = solve_impact(plate(length=1.0, height=0.4, mass=10.0, friction=0.2), Twist(0.0, 1.0, 0.0))
    unsolved = outcome._replace(flags=Flag.NO_SOLUTION)
    monkeypatch.setattr("impact_predictor.commands.solve.solve_impact", lambda *_: unsolved)
    result = run(*PLATE, "--omega", "-1")
    assert (result.exit_code, result.stderr) == (1, "")
    assert "no law has a solution" in result.stdout


def test_replay_prints_tables_and_notes(bag: str) -> None:
    result = run("replay", bag, "--params", SCENE)
    assert result.exit_code == 0
    assert "touchdowns scored by the whole twist: relative error" in result.stdout
    assert "before touchdown" in result.stdout
    assert "per second, with reading and writing" in result.stdout
    assert result.stderr.startswith("note: ")


def test_replay_prints_only_json_when_asked(bag: str) -> None:
    result = run("replay", bag, "--params", SCENE, "--remap", "odom:=/cube/odom", "--json")
    answer = json.loads(result.stdout)
    assert answer["bag"] == bag
    assert {"samples", "us_per_sample", "touchdowns", "median_relative_error", "error_by_lead_time"} <= answer.keys()
    scored = [touchdown for touchdown in answer["touchdowns"] if touchdown["scored"]]
    assert scored
    assert all(touchdown["mode"] in Mode.__members__ for touchdown in scored)


def test_replay_writes_predictions(tmp_path: Path, bag: str) -> None:
    output = tmp_path / "out.mcap"
    result = run("replay", bag, "--params", SCENE, "-o", str(output))
    assert result.exit_code == 0
    assert "/impact_predictor/mode" in topics(output)
    assert f"Predictions: {output}" in result.stdout


def test_of_several_bags_one_that_cannot_be_read_stops_no_other(tmp_path: Path, bag: str) -> None:
    output = tmp_path / "out"
    missing = str(tmp_path / "missing.mcap")
    result = run("replay", missing, bag, "--params", SCENE, "-o", str(output), "--json")
    assert result.exit_code == 2
    failed, answer = json.loads(result.stdout)
    assert failed == {
        "bag": missing,
        "error": f"{missing} does not exist; give an .mcap, .db3 or ROS 1 .bag file, or a rosbag2 folder",
    }
    assert answer["touchdowns"]
    assert [path.name for path in output.iterdir()] == ["tosses.mcap"]
    assert "error: " in result.stderr


def test_a_bag_that_fails_leaves_no_folder_and_others_keep_theirs(tmp_path: Path, bag: str) -> None:
    output = tmp_path / "out"
    missing = [str(tmp_path / day / "tosses.mcap") for day in ("monday", "tuesday")]
    assert run("replay", missing[0], bag, "--params", SCENE, "-o", str(output), "--json").exit_code == 2
    folder = Path(bag).parent.name
    assert sorted(path.relative_to(output).as_posix() for path in output.rglob("*")) == [
        folder,
        f"{folder}/tosses.mcap",
    ]
    assert run("replay", *missing, "--params", SCENE, "-o", str(tmp_path / "none"), "--json").exit_code == 2
    assert not (tmp_path / "none").exists()
    (tmp_path / "mine").mkdir()
    assert run("replay", *missing, "--params", SCENE, "-o", str(tmp_path / "mine"), "--json").exit_code == 2
    assert list((tmp_path / "mine").iterdir()) == []


@pytest.mark.parametrize(
    ("option", "value", "said"),
    [
        ("--workers", "x", "'x' is not a valid integer"),
        ("--workers", "0", "0 is not in the range x>=1"),
    ],
)
def test_an_option_says_which_numbers_it_takes(bag: str, option: str, value: str, said: str) -> None:
    assert said in refused("replay", bag, "--params", SCENE, option, value)


def test_without_geometry_the_sentence_and_the_empty_answer_are_given(
    tmp_path: Path, messages: list[BagMessage]
) -> None:
    alone = write_bag(tmp_path / "alone.mcap", [message for message in messages if message.topic == "/cube/odom"])
    result = run("replay", alone, "--params", SCENE, "--json")
    assert result.exit_code == 2
    assert json.loads(result.stdout)["touchdowns"] == []
    assert "error: " in result.stderr
    assert "give body.contact_points" in result.stderr


def test_of_a_damaged_bag_the_readable_part_is_used_with_status_3(tmp_path: Path) -> None:
    data = bytearray((ROOT / "examples/cube_tosses/cube_tosses.mcap").read_bytes())
    data[400_000:405_000] = b"\xff" * 5000
    (tmp_path / "damaged.mcap").write_bytes(data)
    result = run("replay", str(tmp_path / "damaged.mcap"), "--params", SCENE, "--json")
    assert result.exit_code == 3
    assert "is damaged" in json.loads(result.stdout)["damaged"]
    assert "warning: " in result.stderr


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["missing.mcap", "--params", SCENE], "missing.mcap does not exist"),
        (["{bag}", "--params", "missing.yaml"], "the parameter file missing.yaml cannot be read"),
        (["{bag}", "--params", "{bad}"], "bad.yaml: there is no parameter body.weight"),
        (["{bag}"], "Missing option '--params'"),
        (["--params", SCENE], "Missing argument 'BAG...'"),
        (["{bag}", "--params", SCENE, "--remap", "odom"], "is not of the form from:=to"),
        (["{bag}", "--params", SCENE, "--remap", "odom:=/nowhere"], "has no topic /nowhere"),
        (["{bag}", "{bag}", "--params", SCENE, "-o", "both.mcap"], "both.mcap is one file, but 2 bags are given"),
        (["{bag}", "{bag}", "--params", SCENE, "-o", "both"], "would be written for two bags"),
        (["{bag}", "--params", SCENE, "-o", "{bag}/out"], "cannot be written"),
        (["{bag}", "--params", SCENE, "-o", "none/out.mcap"], "the folder of none/out.mcap does not exist; make it"),
        (["{bag}", "b.mcap", "--params", SCENE, "-o", "none/out"], "the folder of none/out does not exist; make it"),
        (["{bag}", "--params", SCENE, "--markers"], "--markers are written into an output: give its name with -o"),
    ],
)
def test_replay_says_what_is_wrong_with_its_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, bag: str, arguments: list[str], sentence: str
) -> None:
    bad = tmp_path / "bad.yaml"
    bad.write_text("/**:\n  ros__parameters:\n    body:\n      weight: 1.0\n")
    monkeypatch.chdir(tmp_path)
    assert sentence in refused("replay", *(argument.format(bag=bag, bad=bad) for argument in arguments))
    assert [path.name for path in tmp_path.iterdir()] == ["bad.yaml"]


def test_a_bar_appears_only_on_a_terminal_and_only_after_a_while(monkeypatch: pytest.MonkeyPatch, bag: str) -> None:
    assert "samples" not in run("replay", bag, "--params", SCENE, "--json").stderr
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "samples" not in run("replay", bag, "--params", SCENE, "--json").stderr
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    assert "samples" in run("replay", bag, "--params", SCENE, "--json").stderr


def test_ctrl_c_ends_without_a_traceback(monkeypatch: pytest.MonkeyPatch, bag: str) -> None:
    def interrupt(path: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("impact_predictor.parameters.file.read_parameters", interrupt)
    result = run("replay", bag, "--params", SCENE)
    assert (result.exit_code, result.output.strip()) == (130, "")


def test_the_module_is_the_command() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "impact_predictor", *PLATE, "--omega=-1", "--json"],
        check=True,
        capture_output=True,
        text=True,
    )
    assert json.loads(done.stdout)["mode"] == "SLIDE"


@pytest.mark.parametrize("arguments", [["replay", "--help"], [*PLATE, "--omega", "-1"]])
def test_a_reader_that_goes_away_is_no_reason_for_a_traceback(arguments: list[str]) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "impact_predictor", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == b""
    process.stderr.close()
    process.wait()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that takes nothing")
def test_an_output_that_cannot_be_written_is_one_sentence() -> None:
    with Path("/dev/full").open("w") as full:
        solved = subprocess.run(
            [sys.executable, "-m", "impact_predictor", *PLATE, "--omega", "-1"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert (solved.returncode, solved.stderr) == (
        2,
        "error: the output cannot be written: No space left on device\n",
    )
