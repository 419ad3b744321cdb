"""Which bags the arguments of a command stand for."""

from __future__ import annotations

import errno
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from impact_predictor.bags.find import bags_of, names_of
from impact_predictor.errors import InputError


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    """A folder of bags of every kind, and of what is none."""
    names = ("run_10.mcap", "run_2.bag", "run_2.db3", "notes.txt", "live.bag.active", ".hidden.mcap")
    for name in (*names, "monday/a.mcap.zstd", "split/split_0.mcap", "split/split_1.mcap", "split/split_2.mcap"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    for folder in ("recorded", "out.partial"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "metadata.yaml").touch()
        (tmp_path / folder / "a_0.mcap").touch()
    (tmp_path / "empty").mkdir()
    return tmp_path


def names(runs: Path, *arguments: str) -> list[str]:
    """The bags of arguments in a folder, by their names in it."""
    found = bags_of([str(runs / argument) for argument in arguments])
    return [str(Path(bag).relative_to(runs)) for bag in found]


ALL = ["live.bag.active", "monday/a.mcap.zstd", "recorded", "run_2.bag", "run_2.db3", "run_10.mcap", "split"]


def test_a_folder_stands_for_the_bags_in_it_and_below_it_in_natural_order(runs: Path) -> None:
    assert names(runs, "") == ALL
    assert names(runs, "monday") == ["monday/a.mcap.zstd"]


def test_a_pattern_stands_for_the_bags_that_it_matches(runs: Path) -> None:
    assert names(runs, "run_*") == ["run_2.bag", "run_2.db3", "run_10.mcap"]
    assert names(runs, "*") == names(runs, "**") == ALL
    assert names(runs, "**/*.zstd") == ["monday/a.mcap.zstd"]
    # Who names the files of a recording gets the files.
    assert names(runs, "split/*_[01].mcap") == ["split/split_0.mcap", "split/split_1.mcap"]


def test_what_is_a_bag_or_is_not_there_is_kept_as_it_is(runs: Path) -> None:
    kept = ["recorded", "split", "run_10.mcap", "nothing.mcap", "run_10.mcap"]
    assert names(runs, *kept) == kept
    assert bags_of(["./here.mcap"]) == ["./here.mcap"]


def test_files_that_are_numbered_but_not_named_as_their_folder_are_bags_of_their_own(runs: Path) -> None:
    for number in (0, 1):
        (runs / "empty" / f"toss_{number}.mcap").touch()
    assert names(runs, "empty") == ["empty/toss_0.mcap", "empty/toss_1.mcap"]


def test_where_nothing_is_found_it_is_said_in_one_sentence(runs: Path) -> None:
    for argument, said in (("empty", "holds no bag, and no folder below it does"), ("x*", "no bag matches")):
        with pytest.raises(InputError) as caught:
            bags_of([str(runs / argument)])
        assert said in str(caught.value)
        assert str(runs / argument) in str(caught.value)


def test_a_folder_that_cannot_be_read_is_told_in_one_sentence(runs: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def locked(folder: Path) -> Iterator[Path]:
        raise PermissionError(errno.EACCES, "Permission denied", str(folder))

    monkeypatch.setattr(Path, "iterdir", locked)
    with pytest.raises(InputError, match=f"^{re.escape(str(runs))} cannot be read: Permission denied$"):
        bags_of([str(runs)])


@pytest.mark.parametrize(
    ("bags", "names"),
    [
        (["a/run.mcap", "b/walk.bag", "c/folder"], ["run", "walk", "folder"]),
        (["mon/run.mcap", "tue/run.mcap", "tue/walk.mcap"], ["mon/run", "tue/run", "walk"]),
        (["1/mon/run.mcap", "2/mon/run.mcap", "2/tue/run.mcap"], ["1/mon/run", "2/mon/run", "tue/run"]),
        (["a/run.mcap", "a/run.bag", "b/run.db3"], ["run.mcap", "run.bag", "run"]),
        (["/run.mcap", "/a/run.mcap"], ["run", "a/run"]),
    ],
)
def test_bags_of_one_name_keep_as_much_of_their_folders_as_tells_them_apart(bags: list[str], names: list[str]) -> None:
    assert names_of(bags) == [Path(name) for name in names]


def test_a_bag_given_twice_is_refused() -> None:
    with pytest.raises(InputError, match=r"run\.mcap would be written for two bags; give each bag once"):
        names_of(["a/run.mcap", "a/../a/run.mcap"])
