"""Ctrl-C in the commands that write bags: what stays is named, and nothing else is left."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result
from command_line import invoke

from impact_predictor.bags.read import topics
from impact_predictor.bags.write import BagWriter
from impact_predictor.commands.progress import say_unfinished

ROOT = Path(__file__).parents[1]
REPLAY = ["replay", "--params", str(ROOT / "config/rocking_rod.yaml")]
WRITING = {
    "rod": ["simulate", "rod"],
    "wheel": ["simulate", "wheel"],
    "deck": ["simulate", "deck", "--duration", "5", "--params", str(ROOT / "config/deck_crate.yaml")],
    "replay": [*REPLAY, "rod.mcap"],
}


@pytest.fixture(scope="module")
def rod(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bag of a rod."""
    bag = tmp_path_factory.mktemp("rod") / "rod.mcap"
    assert invoke("simulate", "rod", "-o", str(bag)).exit_code == 0
    return bag


@pytest.fixture(autouse=True)
def folder(folder: Path, rod: Path) -> Path:
    (folder / "rod.mcap").hardlink_to(rod)
    return folder


@pytest.fixture
def interrupted(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Result]:
    """A command that Ctrl-C meets when it has written so many messages, in all bags."""

    def begun(messages: int, *arguments: str) -> Result:
        written = 0
        write = BagWriter.write

        def count(self: BagWriter, topic: str, type_name: str, log_time: int, data: bytes) -> None:
            nonlocal written
            if written == messages:
                raise KeyboardInterrupt
            written += 1
            write(self, topic, type_name, log_time, data)

        monkeypatch.setattr(BagWriter, "write", count)
        return invoke(*arguments)

    return begun


@pytest.mark.parametrize("command", WRITING)
def test_a_bag_that_was_begun_stays_and_is_named(
    folder: Path, interrupted: Callable[..., Result], command: str
) -> None:
    result = interrupted(20, *WRITING[command], "-o", "out.mcap")
    assert (result.exit_code, result.stdout) == (130, "")
    assert result.stderr.split("\n")[0] == (
        "note: what was written until Ctrl-C stays as a bag in out.mcap.partial/bag, until the next run with this -o "
        "replaces it"
    )
    assert topics(folder / "out.mcap.partial/bag")


@pytest.mark.parametrize("command", WRITING)
def test_without_a_message_nothing_is_left_and_nothing_said(
    folder: Path, interrupted: Callable[..., Result], command: str
) -> None:
    result = interrupted(0, *WRITING[command], "-o", "out.mcap")
    assert (result.exit_code, result.output.strip()) == (130, "")
    assert [file.name for file in folder.iterdir()] == ["rod.mcap"]


def test_of_several_bags_those_that_are_done_stay_and_the_one_that_was_begun_is_named(
    folder: Path, interrupted: Callable[..., Result], monkeypatch: pytest.MonkeyPatch
) -> None:
    bags = []
    for name in ("monday", "tuesday", "wednesday"):
        (folder / name).mkdir()
        (folder / name / "rod.mcap").hardlink_to(folder / "rod.mcap")
        bags.append(f"{name}/rod.mcap")
    whole = 0
    write = BagWriter.write

    def count(*asked: object) -> None:
        nonlocal whole
        whole += 1
        write(*asked)  # type: ignore[arg-type]

    with monkeypatch.context() as patch:
        patch.setattr(BagWriter, "write", count)
        assert invoke(*REPLAY, bags[0], "-o", "one.mcap").exit_code == 0
    result = interrupted(whole + 20, *REPLAY, *bags, "-o", "out")
    assert result.exit_code == 130
    assert "note: stopped after 1 of 3 bags; what they gave is kept" in result.stderr
    assert "stays as a bag in out/tuesday/rod.mcap.partial/bag, until" in result.stderr
    # No folder is left of the bag that was not begun.
    assert sorted(str(place.relative_to("out")) for place in Path("out").glob("*/*")) == [
        "monday/rod.mcap",
        "tuesday/rod.mcap.partial",
    ]


def test_of_many_unfinished_bags_the_first_are_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number in range(4):
        with pytest.raises(KeyboardInterrupt), BagWriter(f"{number}.mcap") as writer:
            writer.write("/mode", "std_msgs/msg/UInt8", 0, bytes([0, 1, 0, 0, 1]))
            raise KeyboardInterrupt
    outputs = [Path(f"{number}.mcap") for number in range(9)]
    say_unfinished(outputs)
    (line,) = capsys.readouterr().err.splitlines()
    assert "stays as bags in 0.mcap.partial/bag, 1.mcap.partial/bag, 2.mcap.partial/bag and 1 more, until" in line


def test_the_workers_of_a_scheduler_go_on_and_what_they_write_is_left_alone(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with BagWriter("out.mcap"):
        say_unfinished([Path("out.mcap")], "tcp://localhost:8786")
        assert Path("out.mcap.partial").is_dir()
    assert "finish the bags that they have begun" in capsys.readouterr().err
    say_unfinished([None], "tcp://localhost:8786")
    assert capsys.readouterr().err == ""
