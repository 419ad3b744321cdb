r"""Change the code at random places, one at a time, and see whether the tests that run the changed line notice.

    make mutants ARGS="--count 300 --seed 1"

First the quick tests run once, in a copy of the tree that tells what each of them runs; `--ran FILE` keeps that for
another time, and arguments of pytest after -- choose other tests. Then each mutant is tried in a copy of the tree, in a
process that is forked from one with the libraries loaded: first against a few quick tests, then against the others. The
copies have no numba, which would compile every mutant of the law code anew.

A mutant that no test notices is printed as it survives, with its place and what was changed; at the end stand the
counts of each room. The exit status is 1 where fewer than --killed of those that change what can be seen are noticed;
tools/mutants.md lists the others, with the reason.
"""

from __future__ import annotations

import argparse
import ast
import multiprocessing
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import accumulate, takewhile
from pathlib import Path
from typing import Final, NamedTuple

ROOT: Final = Path(__file__).parents[1]
PACKAGE: Final = ROOT / "impact_predictor"
ACCEPTED: Final = ROOT / "tools" / "mutants.md"
SWAPS: Final = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "is": "is not", "is not": "is",
    "in": "not in", "not in": "in", "+": "-", "-": "+", "*": "/", "/": "*", "//": "*", "%": "*", "**": "*",
    "and": "or", "or": "and",
}  # fmt: skip
NAMES: Final = {"min": "max", "max": "min", "any": "all", "all": "any", "True": "False", "False": "True"}
UNSEEN: Final = {"frozen", "slots", "strict", "maxsize", "stacklevel"}
"""Arguments that only a fault in the code itself, or a watch on its speed, would notice."""
FIRST: Final = 8
"""Tests that a mutant is tried against before the others are loaded, too."""
LONGEST: Final = 60.0
"""Seconds that the tests of one mutant took together without it: more of them are not tried."""
PATIENCE: Final = 900
"""Seconds on the clock for the tests of one mutant; one that takes longer hangs, which is noticed too."""


class Mutant(NamedTuple):
    """The text from `start` to `end` of a file becomes `new`; it begins in a line."""

    file: Path
    line: int
    start: int
    end: int
    old: str
    new: str
    text: str

    @property
    def change(self) -> str:
        """What is changed, wherever it stands."""
        return f"{self.old} -> {self.new} in: {self.text}"

    @property
    def name(self) -> str:
        """Of its file."""
        return str(self.file.relative_to(PACKAGE))

    @property
    def key(self) -> str:
        """The same wherever its line stands."""
        return f"{self.name}: {self.change}"

    def __str__(self) -> str:
        return f"{self.name}:{self.line}: {self.change}"

    def is_accepted(self, accepted: str) -> bool:
        """Whether it is listed, wherever its line stands now."""
        return f"| {self.name} | `{self.change}` |" in accepted


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

    def text_of(node: ast.expr) -> str:
        return source[begins[node.lineno - 1] :].partition("\n")[0].strip()

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
                yield Mutant(file, before.lineno, at, at + len(found[0]), found[0], SWAPS[found[0]], text_of(before))
                return

    def instead(node: ast.expr, new: str) -> Mutant:
        start, end = place(node.lineno, node.col_offset), end_of(node)
        return Mutant(file, node.lineno, start, end, source[start:end], new, text_of(node))

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
    """What of a node is annotation, text for people, or a check of the code itself."""
    whole: ast.AST | None = None
    if isinstance(node, ast.AnnAssign | ast.arg):
        whole = node.annotation
    elif isinstance(node, ast.FunctionDef):
        whole = node if node.name == "__repr__" else node.returns
    elif (
        isinstance(node, ast.JoinedStr | ast.Raise | ast.Assert)
        or (isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING")
        or (isinstance(node, ast.keyword) and node.arg in UNSEEN)
    ):
        whole = node
    return iter(()) if whole is None else ast.walk(whole)


def some_of(mutants: Sequence[Mutant], count: int, seed: int) -> list[Mutant]:
    """Those that a seed chooses by their text: a change elsewhere in the code leaves them as they are."""
    places: dict[float, Mutant] = {}
    before = Counter[str]()
    for mutant in mutants:
        text = f"{mutant.name} {mutant.change}"
        before[text] += 1
        places[random.Random(f"{seed} {text} {before[text]}").random()] = mutant
    return [places[place] for place in sorted(places)[:count]]


def marked(source: str, name: str, mutants: Sequence[Mutant]) -> str:
    """The code of a file that tells, as it runs, of each function by the name of the file, and of each mutant."""
    tree = ast.parse(source)
    statements = [node for node in ast.walk(tree) if isinstance(node, ast.stmt)]
    functions = [node for node in statements if isinstance(node, ast.FunctionDef)]
    within = {id(part) for function in functions for statement in function.body for part in ast.walk(statement)}
    marks: dict[int, list[ast.stmt]] = defaultdict(list)
    for mutant in mutants:
        # Of those that hold the line, the last begins within the others; decorators stand before their function.
        inmost = max((one for one in statements if mutant.line in lines_of(one)), key=lambda one: one.lineno)
        # What runs as the module is loaded is the same for whichever test loads it.
        told = repr(mutant.key) if id(inmost) in within else f"{mutant.key!r}, ''"
        marks[id(inmost)] += ast.parse(f"ran({told})").body
    begin = next((k for k, one in enumerate(tree.body) if not is_head(one)), len(tree.body))
    tree.body[begin:begin] = ast.parse("from ran import ran").body
    for node in ast.walk(tree):
        for field in ("body", "orelse", "finalbody"):
            if isinstance(body := getattr(node, field, None), list):
                body[:] = [one for statement in body for one in (*marks[id(statement)], statement)]
    for function in functions:
        function.body[:0] = ast.parse(f"ran({name!r})").body
    return ast.unparse(ast.fix_missing_locations(tree))


def lines_of(statement: ast.stmt) -> range:
    decorators: list[ast.expr] = getattr(statement, "decorator_list", [])
    return range(min([statement.lineno, *(one.lineno for one in decorators)]), (statement.end_lineno or 0) + 1)


def is_head(statement: ast.stmt) -> bool:
    """Whether nothing may stand before it in a module."""
    return isinstance(statement, ast.Expr) or getattr(statement, "module", "") == "__future__"


class Ran(NamedTuple):
    """What tests have told."""

    seconds: dict[str, float]
    """How long each test took that passed."""
    tests: Mapping[str, set[str]]
    """The tests that ran a mutant or a file; "" stands for those that load it."""

    @classmethod
    def read(cls, file: Path) -> Ran:
        told = [line.split("\t") for line in file.read_text().splitlines()]
        seconds = {test: float(what) for what, test in told if re.fullmatch(r"[\d.e-]+", what)}
        tests: dict[str, set[str]] = defaultdict(set)
        for what, test in told:
            if test in seconds or not test:
                tests[what].add(test)
        return cls(seconds, tests)

    def of(self, mutant: Mutant) -> dict[str, float]:
        """The tests that run a mutant and their seconds: quick ones first, of the mirrored file before others.

        Where loading runs it, they are those that run a function of its file, or else of one of its folder.
        """
        of_line = self.tests.get(mutant.key, set())
        if "" in of_line:
            of_line = of_line | self.tests.get(mutant.name, set())
            if of_line == {""}:
                folder = mutant.name.rpartition("/")[0]
                of_line = {""}.union(*(them for name, them in self.tests.items() if name.rpartition("/")[0] == folder))
        mirrored = f"test_{mutant.file.stem}.py"
        tests = sorted(of_line - {""}, key=lambda test: self.seconds[test] * (0.1 if mirrored in test else 1.0))
        totals = accumulate((self.seconds[test] for test in tests), initial=0.0)
        within = takewhile(lambda total: total < LONGEST, totals)
        return {test: self.seconds[test] for test, _ in zip(tests, within)}  # noqa: B905  as many as are within


def run_marked(mutants: Sequence[Mutant], told: Path, choice: Sequence[str]) -> None:
    """Run the tests in a copy of the tree that tells what runs."""
    with tempfile.TemporaryDirectory() as folder:
        tree = copy_tree(folder)
        for file in sorted(PACKAGE.rglob("*.py")):
            name = str(file.relative_to(PACKAGE))
            text = marked(file.read_text(), name, [one for one in mutants if one.file == file])
            (tree / PACKAGE.name / name).write_text(text)
        environment = os.environ | {"PYTHONPATH": f"{tree}:{tree / 'tools'}", "RAN_FILE": str(told.resolve())}
        command = [sys.executable, "-m", "pytest", "-q", "-p", "ran", "-p", "no:cacheprovider", *choice]
        subprocess.run(command, cwd=tree, env=environment, check=False)


def copy_tree(folder: str) -> Path:
    """A copy of the tree for this process, without numba."""
    tree = Path(folder, str(os.getpid()))
    shutil.copytree(ROOT, tree, ignore=shutil.ignore_patterns(".git", ".venv", "out", "log"))
    (tree / "numba.py").write_text("raise ImportError\n")
    return tree


def enter_copy(folder: str) -> None:
    os.chdir(copy_tree(folder))


def try_out(task: tuple[Mutant, dict[str, float]]) -> tuple[Mutant, str]:
    """What its tests find of a mutant in this copy of the tree."""
    mutant, tests = task
    file = Path(mutant.file.relative_to(ROOT))
    source, times = file.read_text(), file.stat()
    file.write_text(source[: mutant.start] + mutant.new + source[mutant.end :])
    names, outcome = list(tests), "survived" if tests else "not run"
    for part in (names[:FIRST], names[FIRST:]):
        if outcome == "survived" and part and fails(part, 60 + int(sum(map(tests.__getitem__, part)))):
            outcome = "noticed"
    file.write_text(source)
    # What is compiled stays valid.
    os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))
    return mutant, outcome


def fails(tests: Sequence[str], limit: int) -> bool:
    """Whether one of the tests fails, or takes more than some seconds of computing, in a process of its own."""
    child = os.fork()
    if not child:
        try:
            os.setpgid(0, 0)
            resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
            signal.alarm(PATIENCE)
            for stream in (1, 2):
                os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
            sys.path.insert(0, str(Path.cwd()))
            os.environ |= {"PYTHONPATH": str(Path.cwd()), "PYTHONDONTWRITEBYTECODE": "1"}
            sys.dont_write_bytecode = True
            import pytest

            os._exit(int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *tests])))
        finally:
            os._exit(1)
    _, status = os.waitpid(child, 0)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    # 5: none of them is there.
    return os.waitstatus_to_exitcode(status) not in (0, 5)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("choice", nargs="*", default=["-m", "not slow"], help="of tests, as for pytest")
    parser.add_argument("--ran", type=Path, help="what the tests told: read, or written where it is not there")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="those that have this in their line of output")
    parser.add_argument("--killed", type=float, default=0.92, help="the part that the tests shall notice")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    every = [mutant for file in sorted(PACKAGE.rglob("*.py")) for mutant in mutants_of(file)]
    chosen = some_of([one for one in every if arguments.only in str(one)], arguments.count, arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        told = arguments.ran or Path(folder, "ran")
        if not told.exists():
            run_marked(chosen, told, ["--numprocesses", str(arguments.jobs), *arguments.choice])
        ran = Ran.read(told)
    import hypothesis
    import numpy as np
    import pytest

    del hypothesis, np, pytest  # loaded once, for all that is forked
    accepted = ACCEPTED.read_text() if ACCEPTED.exists() else ""
    counts: dict[str, Counter[str]] = {}
    with (
        tempfile.TemporaryDirectory() as folder,
        multiprocessing.get_context("fork").Pool(arguments.jobs, enter_copy, (folder,)) as pool,
    ):
        for mutant, found in pool.imap_unordered(try_out, [(one, ran.of(one)) for one in chosen]):
            outcome = "accepted" if found != "noticed" and mutant.is_accepted(accepted) else found
            room = mutant.file.relative_to(PACKAGE).parts[0]
            counts.setdefault(room, Counter())[outcome] += 1
            print(f"{outcome:9} {mutant}", flush=True)
    outcomes = ("noticed", "survived", "not run", "accepted")
    for room in sorted(counts):
        print(f"{room:14}", *(f"{counts[room][outcome]:4} {outcome}" for outcome in outcomes))
    total = sum(counts.values(), Counter[str]())
    seen = total["noticed"] + total["survived"] + total["not run"]
    part = total["noticed"] / max(1, seen)
    print(f"{total['noticed']} noticed of {seen} that change what can be seen: {100.0 * part:.1f} %")
    return int(part < arguments.killed)


if __name__ == "__main__":
    sys.exit(main())
