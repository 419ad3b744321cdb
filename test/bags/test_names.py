"""Names of the outputs of many bags."""

from pathlib import Path

import pytest

from impact_predictor.bags.find import names_of
from impact_predictor.errors import InputError


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


def test_no_name_leaves_the_folder_of_the_output() -> None:
    assert not any(
        name.is_absolute() or ".." in name.parts for name in names_of(["/run.mcap", "../run.mcap", "run.mcap"])
    )


def test_a_bag_given_twice_is_refused() -> None:
    with pytest.raises(InputError, match=r"run\.mcap would be written for two bags; give each bag once"):
        names_of(["a/run.mcap", "a/../a/run.mcap"])
