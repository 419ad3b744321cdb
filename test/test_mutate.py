"""The places at which tools/mutate.py changes the code, and what it makes of them."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from mutate import PACKAGE, Mutant, Ran, marked, mutants_of, some_of

CODE = '''"""A text of 3 - 2 words."""
LEAST: "int | 3" = -4


def f(a: int = 0, é: str = "3 < 4") -> bool:
    if not a <= 2 * a:
        raise ValueError("1" + é)
    return a is not None and (a >= 1 or all(é)) != True
'''
CHANGES = {
    ("-4", "(4)"), ("4", "8"), ("0", "1"), ("<=", "<"), ("*", "/"), ("2", "4"), ("is not", "is"), ("and", "or"),
    ("or", "and"), (">=", ">"), ("1", "2"), ("all", "any"), ("!=", "=="), ("True", "False"),
}  # fmt: skip


def changed(file: Path, mutant: Mutant) -> str:
    source = file.read_text()
    assert source[mutant.start : mutant.end] == mutant.old
    return source[: mutant.start] + mutant.new + source[mutant.end :]


def test_each_operator_constant_and_name_is_changed_once_and_no_text_or_annotation(tmp_path: Path) -> None:
    file = tmp_path / "code.py"
    file.write_text(CODE)
    mutants = list(mutants_of(file))
    assert len(mutants) == len(CHANGES) + 1
    assert {(mutant.old, mutant.new) for mutant in mutants} - {("not a <= 2 * a", "(a <= 2 * a)")} == CHANGES
    before = ast.unparse(ast.parse(CODE))
    assert all(ast.unparse(ast.parse(changed(file, mutant))) != before for mutant in mutants)
    assert all(CODE.splitlines()[mutant.line - 1].count(mutant.old) for mutant in mutants)


def test_what_no_test_is_for_is_left_as_it_is(tmp_path: Path) -> None:
    file = tmp_path / "code.py"
    file.write_text(
        "def f(a, b):\n    assert a < 1\n    return zip(a, b, strict=True)\n\ndef __repr__(self):\n    return 2 * 'x'\n"
    )
    assert list(mutants_of(file)) == []


def test_a_seed_chooses_the_same_changes_where_code_elsewhere_has_moved() -> None:
    def mutant(line: int, text: str) -> Mutant:
        return Mutant(PACKAGE / "code.py", line, 0, 1, "1", "2", text)

    before = [mutant(k, f"x = {k}") for k in range(1, 100)]
    after = [mutant(k + 7, f"x = {k}") for k in range(1, 100) if k != 50]
    chosen = [one.text for one in some_of(before, 10, seed=3)]
    assert "x = 50" not in chosen
    assert [one.text for one in some_of(after, 10, seed=3)] == chosen
    assert chosen != [one.text for one in some_of(before, 10, seed=4)]


MARKED = '''"""Words."""
from __future__ import annotations
SIZE = 1

def f(x):
    """Words."""
    if x < 2:
        return lambda: (
            x + 4
        )
    elif x == 8:
        x = 16
    return x
'''


def test_marked_code_tells_which_functions_and_mutants_run_and_does_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[tuple[str, ...]] = []
    monkeypatch.setitem(sys.modules, "ran", SimpleNamespace(ran=lambda *given: told.append(given)))
    lines = MARKED.splitlines()
    mutants = [
        Mutant(PACKAGE / "code.py", lines.index(line) + 1, 0, 1, "", "", line) for line in lines if "= 1" in line
    ]
    mutants += [Mutant(PACKAGE / "code.py", 9, 0, 1, "", "", "x + 4")]
    names: dict[str, object] = {}
    exec(marked(MARKED, "code.py", mutants), names)
    at_load, in_branch, in_lambda = (mutant.key for mutant in mutants)
    assert told == [(at_load, "")]  # whichever test loads it
    f = names["f"]
    assert callable(f)
    assert [f(8), f(9)] == [16, 9]
    assert told[1:] == [("code.py",), (in_branch,), ("code.py",)]
    assert f(1)() == 5
    assert told[4:] == [("code.py",), (in_lambda,)]


def test_the_tests_of_a_mutant_are_those_that_passed_and_ran_it_the_quick_and_the_mirrored_first(
    tmp_path: Path,
) -> None:
    mutant = Mutant(PACKAGE / "room/code.py", 1, 0, 1, "1", "2", "x = 1")
    file = tmp_path / "ran"
    rows = [
        *[(mutant.key, test) for test in ("test_other.py::quick", "test_code.py::slow", "test_a.py::fails")],
        *[("room/code.py", test) for test in ("test_other.py::quick", "test_b.py::loads")],
        *[("room/beside.py", "test_c.py::beside"), ("elsewhere/code.py", "test_d.py::apart")],
        *[("1.0", "test_other.py::quick"), ("2e-05", "test_c.py::beside")],
        *[("3.5", "test_code.py::slow"), ("0.25", "test_b.py::loads"), ("4.0", "test_d.py::apart")],
    ]

    def tests_of(*more: tuple[str, str], but: int = 0) -> list[str]:
        file.write_text("".join(f"{what}\t{of}\n" for what, of in [*rows[but:], *more]))
        return list(Ran.read(file).of(mutant))

    assert tests_of() == ["test_code.py::slow", "test_other.py::quick"]
    at_load = mutant.key, ""
    assert tests_of(at_load, but=3) == ["test_b.py::loads", "test_other.py::quick"]
    assert tests_of(at_load, but=5) == ["test_c.py::beside"]
