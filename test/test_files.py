"""Files that have their name only when they are whole, and whose fault it is when they are not."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from impact_predictor.errors import InputError
from impact_predictor.files import named, whole


@pytest.mark.parametrize(
    ("stop", "raised"),
    [
        (OSError(errno.ENOSPC, "No space left"), InputError),
        (BrokenPipeError(errno.EPIPE, "Broken pipe"), BrokenPipeError),  # of what is printed meanwhile
        (KeyboardInterrupt(), KeyboardInterrupt),
    ],
)
def test_after_an_exception_the_older_file_stays_and_the_file_is_blamed_for_what_is_its_fault(
    tmp_path: Path, stop: BaseException, raised: type[BaseException]
) -> None:
    file = tmp_path / "file.txt"
    file.write_text("older")
    with pytest.raises(raised) as caught, whole(file) as partial:
        partial.write_text("newer")
        raise stop
    assert str(caught.value) == (f"{file} cannot be written: No space left" if raised is InputError else str(stop))
    assert [(one.name, one.read_text()) for one in tmp_path.iterdir()] == [("file.txt", "older")]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("picture.gif", r"picture\.gif is no picture; give a name that ends in \.png or \.svg"),
        ("no/a.png", "folder of"),
    ],
)
def test_a_name_that_cannot_be_written_is_refused_before_the_work(tmp_path: Path, name: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        named(tmp_path / name, "picture", (".png", ".svg"))
    assert named(tmp_path / "a.PNG", "picture", (".png", ".svg")) == tmp_path / "a.PNG"
