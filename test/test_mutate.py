"""The places at which tools/mutate.py changes the code, and what it makes of them."""

from __future__ import annotations

import ast
from pathlib import Path

from mutate import PACKAGE, Mutant, mutants_of, some_of

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
