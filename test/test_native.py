"""The library of machine code: when it runs, that it answers as the files do, and what may not be compiled."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from recordings import first_messages, write_mcap, write_plan

from impact_predictor import native, solve_impact
from impact_predictor.cli import main
from impact_predictor.mechanics.random_problems import random_problems

ROOT = Path(__file__).parents[1]


def run(code: str, folder: Path = ROOT, **variables: str) -> list[str]:
    """The lines that a program prints where a copy of the package is in a folder."""
    environment = {**os.environ, "PYTHONPATH": str(folder), **variables}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert not done.returncode, done.stderr
    return done.stdout.splitlines()


def test_the_files_run_as_python_where_the_variable_says_so() -> None:
    assert run("from impact_predictor.native import form; print(form())", IMPACT_PREDICTOR_PLAIN="1") == [
        "as Python: IMPACT_PREDICTOR_PLAIN is set"
    ]


def test_what_was_compiled_of_other_sources_never_runs(tmp_path: Path) -> None:
    package = tmp_path / "impact_predictor"
    shutil.copytree(ROOT / package.name, package, ignore=shutil.ignore_patterns("__pycache__", "*.so"))
    ask = "from impact_predictor import solve_impact; from impact_predictor.native import form; print(form())"
    assert run(ask, tmp_path, IMPACT_PREDICTOR_PLAIN="0") == ["as Python: nothing was compiled for this Python"]
    (package / f"{native.library_name()}{EXTENSION_SUFFIXES[0]}").write_bytes(b"")
    [said] = run(ask, tmp_path, IMPACT_PREDICTOR_PLAIN="0")
    assert said.startswith("as Python: what was compiled cannot be loaded: ")
    changed = package / "mechanics/types.py"
    changed.write_text(changed.read_text() + "# changed\n")
    [said] = run(ask, tmp_path, IMPACT_PREDICTOR_PLAIN="0")
    assert said == "as Python: what was compiled is of other sources: `make compiled` compiles these"


@pytest.mark.skipif(isinstance(native.library(), str), reason="needs the library: `make compiled`")
def test_the_files_run_as_python_where_the_vectors_of_machine_code_are_not_installed() -> None:
    code = "import sys; sys.modules['librt'] = None; from impact_predictor.native import form; print(form())"
    [said] = run(code)
    assert said.startswith("as Python: what was compiled cannot be loaded: ")
    assert "librt" in said


def one_of(part: Any, i: int) -> Any:
    """One of many problems, whose fields are arrays."""
    if isinstance(part, tuple):
        fields = [one_of(field, i) for field in part]
        return part._make(fields) if hasattr(part, "_make") else tuple(fields)
    return part if part is None else float(part[i] if np.ndim(part) else part)


@pytest.mark.skipif(isinstance(native.library(), str), reason="needs the library: `make compiled`")
def test_compiled_and_as_python_the_laws_answer_the_same_to_the_last_bit() -> None:
    plain = native.as_python("mechanics.impact.solve", "of_tests").solve_impact
    assert type(plain) is not type(solve_impact)
    for problems in random_problems(7, 2000, 100):
        for i in range(100):
            body, twist = one_of(problems.body, i), one_of(problems.twist, i)
            for law in ("path", "total"):
                assert repr(solve_impact(body, twist, law)) == repr(plain(body, twist, law))


SAID = """
import sys
from pathlib import Path
from impact_predictor.bags.replay import replay
from impact_predictor.native import form
from impact_predictor.prediction.scene import read_scenes
for case in sys.argv[1:]:
    bag, scene, output, *remapped = case.splitlines()
    replay(bag, read_scenes(scene), dict(one.split("=") for one in remapped), output)
print(form())
"""


def tosses(path: Path) -> Path:
    return write_mcap(path / "tosses.mcap", first_messages(1200))


def plan(path: Path) -> Path:
    return write_plan(path / "plan.bag", 4.0)


def simulated(path: Path, *options: str) -> Path:
    bag = path / "simulated.mcap"
    result = CliRunner().invoke(main, ["simulate", *options, "-o", str(bag)])
    assert not result.exit_code, result.output
    return bag


def recorded_deck(path: Path) -> Path:
    options = "--params", str(ROOT / "config/deck_many.yaml"), "--record", str(ROOT / "examples/vessel_deck")
    return simulated(path, "deck", *options, "--duration", "12")


def simulated_deck(path: Path) -> Path:
    return simulated(path, "deck", "--seed", "3", "--duration", "8")


def simulated_robot(path: Path) -> Path:
    pytest.importorskip("mujoco")
    return simulated(path, "robot", "solo12", "--duration", "2", "--noise-position", "0.001")


def said(cases: Sequence[tuple[Path, Path, Sequence[str]]], plain: bool) -> list[bytes]:
    """What replays of bags write, with their scenes and remapped topics, one after the other in a process."""
    outputs = [bag.with_suffix(f".said_{plain:d}.mcap") for bag, _, _ in cases]
    given = [
        "\n".join(map(str, (bag, scene, output, *remapped)))
        for (bag, scene, remapped), output in zip(cases, outputs, strict=True)
    ]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "IMPACT_PREDICTOR_PLAIN": f"{plain:d}"}
    done = subprocess.run(
        [sys.executable, "-c", SAID, *given], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines() == ["as Python: IMPACT_PREDICTOR_PLAIN is set" if plain else "compiled"]
    return [output.read_bytes() for output in outputs]


OF_TOSSES = ["odom=/cube/odom", "contact_geometry=/cube/contact_geometry"]


@pytest.mark.slow
@pytest.mark.skipif(isinstance(native.library(), str), reason="needs the library: `make compiled`")
@pytest.mark.parametrize(
    "made",
    [
        {
            tosses: ("config/cube_tosses.yaml", OF_TOSSES),
            plan: ("config/walker_hyq.yaml", []),
            recorded_deck: ("config/deck_many.yaml", []),
            simulated_deck: ("config/deck_crate.yaml", []),
        },
        pytest.param({simulated_robot: ("simulated.yaml", [])}, marks=pytest.mark.extras),
    ],
    ids=["recorded", "robot"],
)
def test_compiled_and_as_python_a_replay_writes_the_same_bytes(
    made: dict[Callable[[Path], Path], tuple[str, list[str]]], tmp_path: Path
) -> None:
    cases = []
    for make, (scene, remapped) in made.items():
        folder = tmp_path / make.__name__
        folder.mkdir()
        cases.append((make(folder), (ROOT if scene.startswith("config/") else folder) / scene, remapped))
    for make, compiled, plain in zip(made, said(cases, False), said(cases, True), strict=True):
        assert compiled == plain, make.__name__


def odd_in(node: ast.AST) -> str | None:
    """Why mypyc makes something else of a piece of code than Python does, or cannot take it; None where it can."""
    match node:
        case ast.Compare(ops=ops, comparators=others):
            for op, other in zip(ops, others, strict=True):
                known = isinstance(other, ast.Constant) or (isinstance(other, ast.Attribute) and other.attr.isupper())
                if isinstance(op, ast.Is | ast.IsNot) and not known:
                    return "`is` is false for tuples that are one"
        case ast.Call(func=ast.Name(id="sum"), args=[ast.GeneratorExp(), *_]):
            return "`sum` over a generator rounds floats otherwise than that of a list, from Python 3.12 on"
        case ast.Call(func=ast.Name(id="vars" | "setattr" | "globals")) | ast.Attribute(attr="__dict__"):
            return "a compiled object has no __dict__"
        case ast.Name(id="cached_property"):
            return "a compiled object has no __dict__ to keep it in"
        case ast.Lambda() | ast.FunctionDef(body=[*_, ast.FunctionDef(), _]):
            return "a function in a function leaves a cycle to the collector at each call"
        case ast.AnnAssign(annotation=said, value=(ast.Tuple() | ast.BinOp(left=ast.Tuple())) as value) if (
            "Final" in ast.unparse(said)
            and "..." not in ast.unparse(said)
            and any(isinstance(one, ast.Constant) and isinstance(one.value, float) for one in ast.walk(value))
        ):
            return "a Final tuple of floats and of a known length counts as not set"
        case ast.FunctionDef() if taken_for_none(node):
            return "what was set to None counts as None in the rest of the function, whatever a method makes of it"
    return None


def taken_for_none(function: ast.FunctionDef) -> bool:
    """Whether a function sets an attribute to None and looks at it later, with no other assignment between."""
    none: set[str] = set()
    for statement in function.body:
        attributes = [node for node in ast.walk(statement) if isinstance(node, ast.Attribute)]
        stored = {ast.unparse(one) for one in attributes if isinstance(one.ctx, ast.Store)}
        if none & {ast.unparse(one) for one in attributes if isinstance(one.ctx, ast.Load)} - stored:
            return True
        none -= stored
        match statement:
            case ast.Assign(value=ast.Constant(value=None)) | ast.AnnAssign(value=ast.Constant(value=None)):
                none |= stored
    return False


LAW_CODE = [name for name in native.MODULES if ".mechanics.impact." in name]


@pytest.mark.parametrize("name", LAW_CODE)
def test_law_code_unpacks_to_names_for_machine_code_makes_an_object_of_what_goes_to_an_underscore(name: str) -> None:
    boxed = []
    for node in ast.walk(ast.parse(Path(native.file_of(name)).read_text())):
        # The parts of a record, as a contact is, are objects already.
        if isinstance(node, ast.Assign) and ast.unparse(node.value) not in ("old", "new"):
            targets = [one for one in ast.walk(node.targets[0]) if isinstance(one, ast.Tuple)]
            boxed += [f"line {one.lineno}" for one in targets if "_" in map(ast.unparse, one.elts)]
    assert not boxed


@pytest.mark.parametrize("name", native.MODULES)
def test_nothing_is_compiled_that_would_mean_something_else(name: str) -> None:
    path = Path(native.file_of(name))
    found = [(f"line {node.lineno}", odd) for node in ast.walk(ast.parse(path.read_text())) if (odd := odd_in(node))]
    assert not found


@pytest.mark.parametrize(
    "code",
    [
        "one is other",
        "sum(one.x for one in values)",
        "vars(it).update(more)",
        "class A:\n    @cached_property\n    def b(self): ...",
        "sorted(pairs, key=lambda pair: pair[1])",
        "NOWHERE: Final[Place] = (0.0, 0.0)",
        "def of(self):\n    def inner(): ...\n    return inner",
        "def of(self):\n    self.x = None\n    self.find()\n    return self.x",
    ],
)
def test_the_check_finds_what_would_mean_something_else(code: str) -> None:
    assert any(map(odd_in, ast.walk(ast.parse(code))))
