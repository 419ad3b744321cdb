import ast
import re
import runpy
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest
from ruamel.yaml import YAML

import impact_predictor
from impact_predictor.errors import EXTRAS, REQUIRED, missing

ROOT = Path(__file__).parents[1]


@pytest.fixture
def setup_arguments(monkeypatch):
    """What setup.py hands to setuptools, which need not be installed for that."""
    arguments = {}
    fake = SimpleNamespace(
        Extension=SimpleNamespace,
        find_packages=lambda **_: [],
        setup=lambda **given: arguments.update(given),
    )
    monkeypatch.setitem(sys.modules, "setuptools", fake)
    monkeypatch.setitem(sys.modules, "setuptools.command.build_ext", SimpleNamespace(build_ext=object))
    monkeypatch.setenv("IMPACT_PREDICTOR_PLAIN", "1")
    monkeypatch.chdir(ROOT)
    runpy.run_path(str(ROOT / "setup.py"))
    return arguments


@pytest.fixture
def manifest():
    return ElementTree.parse(ROOT / "package.xml").getroot()


def test_package_xml_setup_py_changelog_and_the_library_say_the_same_of_the_package(setup_arguments, manifest):
    version, maintainer = manifest.findtext("version"), manifest.find("maintainer")
    newest = re.search(r"^(\S+) \(.+\)\n-+$", (ROOT / "CHANGELOG.rst").read_text(), re.MULTILINE)
    assert newest is not None
    assert setup_arguments["version"] == impact_predictor.__version__ == newest[1] == version
    assert setup_arguments["maintainer"] == maintainer.text
    assert setup_arguments["maintainer_email"] == maintainer.get("email")
    assert setup_arguments["license"] == manifest.findtext("license")
    assert (ROOT / manifest.find("license").get("file")).is_file()


def test_the_package_of_messages_and_the_citation_name_the_same_version_maintainer_and_licence(manifest):
    messages = ElementTree.parse(ROOT / "impact_predictor_msgs/package.xml").getroot()
    for name in ("version", "maintainer", "author", "license"):
        assert messages.findtext(name) == manifest.findtext(name)
    assert messages.find("maintainer").get("email") == manifest.find("maintainer").get("email")
    citation = YAML(typ="safe").load(ROOT / "CITATION.cff")
    assert (citation["version"], citation["license"]) == (manifest.findtext("version"), manifest.findtext("license"))
    assert citation["authors"] == [{"name": manifest.findtext("author")}]


def test_rosdoc2_takes_its_settings_from_a_file_that_package_xml_names_and_the_pages_from_docs(manifest):
    file = ROOT / manifest.findtext("export/rosdoc2")
    _, settings = YAML(typ="safe").load_all(file)
    assert (ROOT / settings["builders"][0]["sphinx"]["sphinx_sourcedir"] / "conf.py").is_file()


def test_colcon_builds_it_as_an_ament_python_package_that_the_ament_index_finds(setup_arguments, manifest):
    assert manifest.get("format") == "3"
    assert manifest.findtext("export/build_type") == "ament_python"
    marker = f"resource/{manifest.findtext('name')}"
    assert ("share/ament_index/resource_index/packages", [marker]) in setup_arguments["data_files"]
    assert (ROOT / marker).is_file()


def test_every_folder_of_modules_is_a_package_and_the_marker_of_typed_ones_is_shipped(setup_arguments):
    folders = {path.parent for path in (ROOT / "impact_predictor").rglob("*.py")}
    assert not {folder.name for folder in folders if not (folder / "__init__.py").is_file()}
    [marker] = setup_arguments["package_data"]["impact_predictor"]
    assert marker == "py.typed"
    assert (ROOT / "impact_predictor" / marker).is_file()


def test_every_file_of_config_examples_and_launch_is_installed_under_share(setup_arguments):
    installed = {file: place for place, files in setup_arguments["data_files"] for file in files}
    shipped = [
        path.relative_to(ROOT)
        for folder in ("config", "examples", "launch")
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    ]
    assert {path.as_posix(): f"share/impact_predictor/{path.parent.as_posix()}" for path in shipped}.items() <= (
        installed.items()
    )
    assert Path("examples/cube_tosses/cube_tosses.mcap") in shipped
    # The launch files start with some.
    defaults = [re.search(r'scene="(\w+)"', path.read_text()) for path in (ROOT / "launch").glob("*.launch.py")]
    named = {Path("config", f"{default[1]}.yaml") for default in defaults if default}
    assert len(named) == 2
    assert named <= set(shipped)


def test_ros_from_pypi_is_pinned_wherever_setup_py_asks_for_it(setup_arguments):
    pinned = {line.partition("==")[0] for line in (ROOT / "constraints/jazzy.txt").read_text().split()}
    assert {re.match(r"[\w-]+", requirement)[0] for requirement in setup_arguments["extras_require"]["ros"]} <= pinned


DISTRIBUTIONS = {"backports": "backports.zstd", "compression": "", "ruamel": "ruamel.yaml"}
"""Modules whose distributions have other names; `compression` is of Python 3.14 itself."""


def imports_of(path):
    """The packages that a module imports from elsewhere, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.add(node.module)
    names = {name.partition(".")[0] for name in found}
    return names - sys.stdlib_module_names - {"impact_predictor"}


def names_of(requirements):
    return {re.match(r"[\w.-]+", one)[0] for one in requirements}


def test_every_import_is_declared_or_in_the_extra_that_the_error_sentence_names(setup_arguments):
    base, extras = names_of(setup_arguments["install_requires"]), setup_arguments["extras_require"]
    of_ros = r"rclpy|ament_index_python|launch\w*|\w+_msgs|\w+_interfaces"
    for path in sorted((ROOT / "impact_predictor").rglob("*.py")):
        for module in imports_of(path):
            distribution = DISTRIBUTIONS.get(module, module)
            if not distribution or distribution in base or re.fullmatch(of_ros, module):
                continue
            if module == "pytest":
                assert path.parent.name == "testing"
                continue
            assert module in EXTRAS, f"{path} imports {module}, which nothing declares"
            package, extra = EXTRAS[module]
            assert package in names_of(extras[extra]), f"{package} is not in the extra {extra}"
            assert f"`pip install {package}`" in str(missing(f"{module}.any"))


def test_what_a_workspace_of_colcon_may_lack_is_named_with_a_way_that_debian_allows(setup_arguments):
    # Without click nothing starts that could say so; what machine code needs is there where it was made.
    assert {*REQUIRED.values(), "click", "librt", "mypy_extensions"} == names_of(setup_arguments["install_requires"])
    said = str(missing("rosbags.interfaces"))
    assert said.startswith("this needs rosbags, which is not installed: `pip install ")
    assert "`python3 -m venv --system-site-packages venv`" in said


def test_what_no_code_imports_is_not_declared(setup_arguments):
    imported = {name for path in (ROOT / "impact_predictor").rglob("*.py") for name in imports_of(path)}
    distributions = {DISTRIBUTIONS.get(name, EXTRAS.get(name, (name, ""))[0]) for name in imported}
    assert names_of(setup_arguments["install_requires"]) <= distributions
    assert EXTRAS.keys() <= imported
    extras = setup_arguments["extras_require"]
    assert {package for package, _ in EXTRAS.values()} <= names_of(extras["all"])
    assert not names_of(extras["all"]) & names_of(extras["test"])


def test_package_xml_has_every_ros_package_that_the_code_imports_and_none_that_only_pip_has(manifest):
    # The messages of adapters are in no ROS: the bags that have them bring their definitions.
    files = [path for path in (ROOT / "impact_predictor").rglob("*.py") if path.name != "adapters.py"]
    code = "\n".join(path.read_text() for path in files)
    ros = r"(rclpy|ament_index_python|\w+_msgs|\w+_interfaces)"
    imported = set(re.findall(rf"^\s*(?:from|import) {ros}\b", code, re.MULTILINE))
    imported |= set(re.findall(rf'"{ros}/msg/', code))
    assert imported <= {element.text for element in manifest.findall("exec_depend")}
    dependencies = {element.text for element in manifest if element.tag.endswith("depend")}
    assert not {name for name in dependencies if name.endswith("-pip") or "rosbags" in name}


def test_importing_the_library_loads_neither_ros_nor_what_only_some_commands_need():
    heavy = {"matplotlib", "numba", "rclpy", "rosbags", "scipy"}
    code = f"import sys, impact_predictor; impact_predictor.solve_impact; print(*({heavy} & sys.modules.keys()))"
    loaded = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert loaded.stdout.split() == []


def test_no_class_or_type_alias_has_the_name_of_another():
    places = defaultdict(set)
    for path in (ROOT / "impact_predictor").rglob("*.py"):
        for statement in ast.parse(path.read_text()).body:
            names = [statement.name] if isinstance(statement, ast.ClassDef) else []
            if isinstance(statement, ast.Assign):
                names = [target.id for target in statement.targets if isinstance(target, ast.Name)]
                names = [name for name in names if name[0].isupper() and not name.isupper()]
            for name in names:
                places[name].add(path.relative_to(ROOT).as_posix())
    assert {name: files for name, files in places.items() if len(files) > 1} == {}
