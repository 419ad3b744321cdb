"""One name for one thing: no class of the package is defined in two of its files."""

import ast
from collections import defaultdict
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "impact_predictor"


def test_no_class_or_type_alias_has_the_name_of_another():
    places = defaultdict(set)
    for path in PACKAGE.rglob("*.py"):
        for statement in ast.parse(path.read_text()).body:
            if isinstance(statement, ast.ClassDef):
                names = [statement.name]
            elif isinstance(statement, ast.Assign):
                names = [target.id for target in statement.targets if isinstance(target, ast.Name)]
                names = [
                    name for name in names if not name.startswith("_") and not name.isupper() and name[0].isupper()
                ]
            else:
                continue
            for name in names:
                places[name].add(path.relative_to(PACKAGE).as_posix())
    assert {name: files for name, files in places.items() if len(files) > 1} == {}
