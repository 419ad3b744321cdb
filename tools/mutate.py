"""Change the code at random places, one at a time, and see whether the tests that run the changed line notice.

    python -m pip install coverage pytest-cov
    python -m pytest -m "not slow and not extras" --cov=impact_predictor --cov-context=test --cov-report=
    python tools/mutate.py .coverage --count 300 --seed 1

A mutant that no test notices is printed as it survives, with its place and what was changed; at the end stand the
counts of each room. Each mutant is tried in a copy of the tree, so that the clone stays as it is. The exit status is 1
where fewer than --killed of them are noticed. Read what survives: some change nothing that can be seen.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

ROOT: Final = Path(__file__).parents[1]
SWAPS: Final = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "is": "is not", "is not": "is",
    "in": "not in", "not in": "in", "+": "-", "-": "+", "*": "/", "/": "*", "//": "*", "%": "*", "**": "*",
    "and": "or", "or": "and",
}  # fmt: skip
NAMES: Final = {"min": "max", "max": "min", "any": "all", "all": "any", "True": "False", "False": "True"}
MOST_TESTS: Final = 300
"""Tests of one mutant, those of the mirrored file first."""
PATIENCE: Final = 240.0
"""Seconds for the tests of one mutant; one that takes longer hangs, which is noticed too."""


class Mutant(NamedTuple):
    """The text from `start` to `end` of a file becomes `new`; it begins in a line."""

    file: Path
    line: int
    start: int
    end: int
    old: str
    new: str

    def __str__(self) -> str:
        return f"{self.file.relative_to(ROOT)}:{self.line}: {self.old!r} -> {self.new!r}"


def mutants_of(file: Path) -> Iterator[Mutant]:
    """All changes of one operator, constant or name in the code of a file; texts and annotations stay."""
    source = file.read_text()
    begins = [0, *(match.end() for match in re.finditer("\n", source))]
    tree = ast.parse(source)
    unseen = {id(part) for whole in ast.walk(tree) for part in parts_unseen(whole)}

    def place(line: int, column: int) -> int:
        # Columns count bytes.
        begin = begins[line - 1]
        return begin + len(source[begin : begin + column].encode()[:column].decode(errors="ignore"))

    def end_of(node: ast.expr) -> int:
        return place(node.end_lineno or 0, node.end_col_offset or 0)

    def between(before: ast.expr, after: ast.expr) -> Iterator[Mutant]:
        """The operator between two operands."""
        start, end = end_of(before), place(after.lineno, after.col_offset)
        for found in re.finditer(
            r"is not\b|not in\b|\b(?:is|in|and|or)\b|\*\*|//|[<>=!]=|[-+*/%<>]", source[start:end]
        ):
            if found[0] in SWAPS:
                at = start + found.start()
                yield Mutant(file, before.lineno, at, at + len(found[0]), found[0], SWAPS[found[0]])
                return

    def instead(node: ast.expr, new: str) -> Mutant:
        start, end = place(node.lineno, node.col_offset), end_of(node)
        return Mutant(file, node.lineno, start, end, source[start:end], new)

    for node in ast.walk(tree):
        if id(node) in unseen:
            continue
        if isinstance(node, ast.BinOp):
            yield from between(node.left, node.right)
        elif isinstance(node, ast.BoolOp):
            yield from between(node.values[0], node.values[1])
        elif isinstance(node, ast.Compare):
            yield from between(node.left, node.comparators[0])
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
            yield instead(node, f"({ast.unparse(node.operand)})")
        elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
            yield instead(node, NAMES[repr(node.value)])
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            yield instead(node, repr(1 if node.value == 0 else 2 * node.value))
        elif isinstance(node, ast.Name) and node.id in NAMES:
            yield instead(node, NAMES[node.id])


def parts_unseen(node: ast.AST) -> Iterator[ast.AST]:
    """What of a node is annotation or text for people."""
    whole: ast.AST | None = None
    if isinstance(node, ast.AnnAssign | ast.arg):
        whole = node.annotation
    elif isinstance(node, ast.FunctionDef):
        whole = node.returns
    elif isinstance(node, ast.JoinedStr | ast.Raise | ast.Assert) or (
        isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    ):
        whole = node
    return iter(()) if whole is None else ast.walk(whole)


def tests_of(data: Any, mutant: Mutant) -> list[str]:
    """The tests that run the line of a mutant, or its file if loading that runs the line; the mirrored ones first."""
    contexts = data.contexts_by_lineno(str(mutant.file))
    of_line = {context.partition("|")[0] for context in contexts.get(mutant.line, [])}
    if "" in of_line:
        of_line = {context.partition("|")[0] for several in contexts.values() for context in several}
    tests = sorted(of_line - {""})
    random.Random(str(mutant)).shuffle(tests)
    return sorted(tests, key=lambda test: f"test_{mutant.file.stem}.py" not in test)[:MOST_TESTS]


def is_noticed(mutant: Mutant, tests: Sequence[str], tree: Path) -> bool:
    """Whether a test fails in a copy of the tree with the change."""
    file = tree / mutant.file.relative_to(ROOT)
    source = file.read_text()
    file.write_text(source[: mutant.start] + mutant.new + source[mutant.end :])
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-n", "0", "-p", "no:cacheprovider", *tests]
    try:
        done = subprocess.run(
            command,
            cwd=tree,
            env={**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "1"},
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=PATIENCE,
        )
    except subprocess.TimeoutExpired:
        return True
    finally:
        file.write_text(source)
    return done.returncode != 0


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("coverage", type=Path, help="what coverage has recorded of the tests")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="a part of the names of files, such as mechanics/")
    parser.add_argument("--killed", type=float, default=0.92, help="the part that the tests shall notice")
    arguments = parser.parse_args()
    from coverage import CoverageData  # type: ignore[import-not-found]

    data = CoverageData(str(arguments.coverage))
    data.read()
    files = [file for file in sorted((ROOT / "impact_predictor").rglob("*.py")) if arguments.only in str(file)]
    every = [mutant for file in files for mutant in mutants_of(file)]
    chosen = random.Random(arguments.seed).sample(every, min(arguments.count, len(every)))
    killed, left, unrun = Counter[str](), Counter[str](), Counter[str]()
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder, "tree")
        shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(".git", ".venv", "out", "log"))
        for mutant in chosen:
            room = mutant.file.relative_to(ROOT / "impact_predictor").parts[0]
            tests = tests_of(data, mutant)
            if not tests:
                unrun[room] += 1
                print(f"not run   {mutant}", flush=True)
            elif is_noticed(mutant, tests, tree):
                killed[room] += 1
            else:
                left[room] += 1
                print(f"survived  {mutant}  ({len(tests)} tests)", flush=True)
    for room in sorted({*killed, *left, *unrun}):
        print(f"{room:14} {killed[room]:4} noticed {left[room]:4} survived {unrun[room]:4} not run by these tests")
    part = killed.total() / max(1, killed.total() + left.total())
    print(f"{killed.total()} of {killed.total() + left.total()} noticed: {100.0 * part:.1f} %")
    return int(part < arguments.killed)


if __name__ == "__main__":
    sys.exit(main())
