"""Parameter files against the parser of ROS itself: the same value of the same type, or a refusal.

The odd values are those on which YAML 1.1, YAML 1.2 and strtol or strtod differ.
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import PARAMETERS

SCENES = Path(__file__).parents[2] / "config"

READ: dict[str, Any] = {
    "1": 1,
    "0": 0,
    "-0": 0,
    "+5": 5,
    "0x10": 16,
    "0X1A": 26,
    "-0x10": -16,
    "9223372036854775807": 2**63 - 1,
    "0x7fffffffffffffff": 2**63 - 1,
    "-9223372036854775808": -(2**63),
    "9.0": 9.0,
    "-0.0": -0.0,
    "5.": 5.0,
    ".5": 0.5,
    "-.5": -0.5,
    "+.5": 0.5,
    "007.5": 7.5,
    "1e-3": 1e-3,
    "1E5": 1e5,
    "1e+5": 1e5,
    "1.e5": 1e5,
    "0e5": 0.0,
    "0.0e-999": 0.0,
    "2.2250738585072014e-308": 2.2250738585072014e-308,
    "1.7976931348623157e308": 1.7976931348623157e308,
    ".nan": math.nan,
    ".NaN": math.nan,
    ".inf": math.inf,
    "+.Inf": math.inf,
    "-.INF": -math.inf,
    "true": True,
    "True": True,
    "FALSE": False,
    **{text: text for text in ("tRuE", "path", "a b", "base_link", "é", "a#b", "1,5", "1.5m", "1.0.0", "1e", "1d3")},
    **{text: text for text in (".e5", "--5", "+", ".", "=")},
    "''": "",
    '""': "",
    '"5"': "5",
    "'on'": "on",
    '"~"': "~",
    '"0x10"': "0x10",
    "'it''s'": "it's",
    '"a\\tb"': "a\tb",
    "a #b": "a",
    "1 # comment": 1,
    "one\n      two": "one two",
    "&anchor 5": 5,
    "[1, 2]": [1, 2],
    "[0x10, 1]": [16, 1],
    "[1.0, 2.0]": [1.0, 2.0],
    "[1.0,]": [1.0],
    "[1.0, .nan]": [1.0, math.nan],
    "[1e-3, 5.]": [1e-3, 5.0],
    "[a, 'b', \"1\"]": ["a", "b", "1"],
    "[true, False]": [True, False],
    "\n      - 1.0\n      - 2.0": [1.0, 2.0],
}

AMBIGUOUS = [
    *("on", "On", "ON", "off", "yes", "Yes", "no", "NO", "y", "Y", "n", "N"),
    *("010", "-010", "08", "00", "0o10", "0b11", "0x", "0xg", "0x1p3", "1_000", "1__0", "1_0.5", "12:30:45", "1:2"),
    *("inf", "-inf", "INF", "infinity", "nan", "NaN", "nan(1)", "-.nan", "+.NAN"),
    *("1e400", "-1e400", "1e-400", "1e-310", "4.9e-324", "1e-999", "1.8e308"),
    *("9223372036854775808", "-9223372036854775809", "0xffffffffffffffff", "9" * 5000, "0x" + "f" * 5000),
    *("~", "null", "Null", "NULL", "2020-01-01", "2020-01-01 10:00:00"),
    *("[010]", "[1, on]", "[~]", "[1.0, inf]"),
]

REFUSED = [
    *("", "[]", "{}", "[1, 2.0]", "[1.0, true]", "[a, 1]", "[1, [2]]", "[[1]]", "[{a: 1}]", "[a: b]", "[a:b]", "[:]"),
    *("!!str 5", "!!float 5", "!foo 5", "!", "*a", "|\n      5", "|-\n      5", ">-\n      5"),
    *('"', "'", "- 5", "a: b", "@a", "`a", "%a", "[1", "{a: 1", "? a"),
]


def parameter_file(folder: Path, text: str) -> Path:
    file = folder / "scene.yaml"
    file.write_text(text, encoding="utf-8")
    return file


def section(value: str, name: str = "/**") -> str:
    return f"{name}:\n  ros__parameters:\n    x: {value}\n"


def refusal(file: Path) -> str:
    with pytest.raises(InputError) as caught:
        read_parameters(file)
    sentence = str(caught.value)
    assert sentence.startswith(f"the parameter file {file}")
    assert "\n" not in sentence
    assert len(sentence) < 400
    return sentence


def same(ours: object, theirs: object) -> bool:
    """Equal in value and type; NaN like NaN, -0.0 not like 0.0."""
    return type(ours) is type(theirs) and repr(ours) == repr(theirs)


@pytest.mark.parametrize("text", READ)
def test_a_value_is_read(tmp_path: Path, text: str) -> None:
    (value,) = read_parameters(parameter_file(tmp_path, section(text))).values()
    assert same(value, READ[text])


@pytest.mark.parametrize("text", AMBIGUOUS, ids=lambda text: text[:20])
def test_a_value_that_readers_understand_differently_is_refused(tmp_path: Path, text: str) -> None:
    sentence = refusal(parameter_file(tmp_path, section(text)))
    assert "line 3 sets `x` to " in sentence
    assert "which YAML readers understand differently; write " in sentence


@pytest.mark.parametrize("text", REFUSED)
def test_what_is_no_value_is_refused(tmp_path: Path, text: str) -> None:
    assert "line " in refusal(parameter_file(tmp_path, section(text)))


def by_ros(file: Path, node: str = "impact_predictor") -> dict[str, Any] | None:
    """The parameters that a node of ROS gets from the file; None where rcl refuses the file."""
    rclpy = pytest.importorskip("rclpy", reason="ROS is not installed: its parameter parser is not compared")
    from rclpy.context import Context
    from rclpy.node import Node

    context = Context()
    try:
        rclpy.init(args=["--ros-args", "--params-file", str(file)], context=context)
    except Exception as error:
        assert "Couldn't parse params file" in str(error)  # noqa: PT017 - the class is private
        return None
    try:
        instance = Node(
            node,
            context=context,
            enable_rosout=False,
            start_parameter_services=False,
            allow_undeclared_parameters=True,
            automatically_declare_parameters_from_overrides=True,
        )
        parameters: dict[str, Any] = dict(instance.get_parameters_by_prefix(""))
        values = {name: parameter.value for name, parameter in parameters.items() if name not in OF_EVERY_NODE}
        instance.destroy_node()  # type: ignore[no-untyped-call,unused-ignore]
    finally:
        rclpy.shutdown(context=context)
    return values


OF_EVERY_NODE = {"use_sim_time", "start_type_description_service"}


def check_against_ros(file: Path) -> None:
    """The same parameters with the same values of the same types, or refused here."""
    theirs = by_ros(file)
    try:
        ours = read_parameters(file)
    except InputError:
        return
    assert theirs is not None
    assert set(ours) == set(theirs)
    for name in ours:
        assert same(ours[name], theirs[name]), name


def test_ros_reads_the_same_values(tmp_path: Path) -> None:
    lines = [f"    x{k}: {text}\n" for k, text in enumerate(READ)]
    file = parameter_file(tmp_path, "/**:\n  ros__parameters:\n" + "".join(lines))
    theirs = by_ros(file)
    assert theirs is not None
    for k, text in enumerate(READ):
        # Written here as they are, so that a value is what this file says, in ROS as well.
        assert same(theirs[f"x{k}"], READ[text]), text
    check_against_ros(file)


def test_ros_reads_what_is_refused_here_in_one_of_several_ways(tmp_path: Path) -> None:
    scalars = [text for text in AMBIGUOUS if not text.startswith("[")]
    lines = [f"    x{k}: {text}\n" for k, text in enumerate(scalars)]
    theirs = by_ros(parameter_file(tmp_path, "/**:\n  ros__parameters:\n" + "".join(lines)))
    assert theirs is not None
    read = {text: theirs[f"x{k}"] for k, text in enumerate(scalars)}
    assert (read["on"], read["010"], read["08"], read["~"], read["1e400"]) == (True, 8, 8.0, "~", "1e400")


SECTIONS = {
    "a section for every node": section("1"),
    "a name wins over what stands above it": section("1") + section("2", "impact_predictor"),
    "a wildcard wins over what stands above it": section("2", "impact_predictor") + section("1"),
    "a star is one name": section("1") + section("2", "/*"),
    "two stars and a name": section("1") + section("2", "/**/impact_predictor"),
    "a name with and without its slash": section("1", "/impact_predictor") + section("2", "impact_predictor"),
    "a star in quotes": section("1", '"*"'),
    "a section that goes on": section("1") + section("2", "impact_predictor") + "/**:\n  ros__parameters:\n    y: 3\n",
    "a section that goes on under its other name": (
        section("1", "impact_predictor") + section("2") + section("3", "/impact_predictor")
    ),
    "a nested namespace": "/:\n  impact_predictor:\n    ros__parameters:\n      x: 1\n",
    "a nested wildcard": "/**:\n  impact_predictor:\n    ros__parameters:\n      x: 1\n",
    "others besides": section("1") + section("2", "other") + section("3", "/a/impact_predictor"),
    "nested names": (
        "/**:\n  ros__parameters:\n    a:\n      b:\n        c: 1\n      d: [1.0]\n    e.f: 3\n    g.h:\n      i: 4\n"
    ),
    "brackets": '{"/**": {"ros__parameters": {"a": {"b": 1.0}, "c": [1.0, 2.0]}}}',
    "no parameters": "/**:\n  ros__parameters: {}\n",
    "odd names": "/**:\n  ros__parameters:\n    5: 1\n    on: 2\n    x y: 3\n    '~': 4\n",
    "carriage returns": section("path").replace("\n", "\r\n"),
    "a byte order mark": "\ufeff" + section("1"),
    "a comment": "# scene\n---\n" + section("1 # why"),
}


@pytest.mark.parametrize("text", SECTIONS.values(), ids=SECTIONS)
def test_ros_finds_the_same_parameters_in_the_same_sections(tmp_path: Path, text: str) -> None:
    file = tmp_path / "scene.yaml"
    file.write_bytes(text.encode())
    read_parameters(file)
    check_against_ros(file)


REFUSED_FILES = {
    "nothing": ("", "it has no parameters for impact_predictor"),
    "a comment alone": ("# nothing\n", "it has no parameters for impact_predictor"),
    "another node": (section("1", "other"), "it has parameters for other, but none for impact_predictor"),
    "another namespace": (section("1", "/a/impact_predictor"), "but none for impact_predictor"),
    "no ros__parameters": ("/**:\n  x: 1\n", "line 2 sets `x` outside `ros__parameters:`"),
    "names without a section": ("body:\n  mass: 1.0\n", "line 2 sets `mass` outside `ros__parameters:`"),
    "no section": ("ros__parameters:\n  x: 1\n", "line 1 has `ros__parameters:` outside a section"),
    "a value for the section": ("/**:\n  ros__parameters: 3\n", "line 2 has no `name: value`"),
    "a list for the section": ("/**:\n  ros__parameters: [3]\n", "line 2 has no `name: value`"),
    "an empty section": ("/**:\n  ros__parameters:\n", "has no `name: value`"),
    "a list": ("- a\n- b\n", "line 1 is not a section"),
    "a text": ("hello\n", "line 1 is not a section"),
    "more beside": ("/**:\n  ros__parameters:\n    x: 1\n  y: 2\n", "has more than `ros__parameters:`"),
    "a name with a space": (section("1", "my node") + section("1"), "line 1 begins a section 'my node'"),
    "a tab": ("/**:\n\tros__parameters:\n    x: 1\n", "line 2 is not YAML"),
    "two documents": (section("1") + "---\n" + section("2"), "line 5 begins a second document"),
    "a directive": ("%YAML 1.1\n---\n" + section("1"), "begins with %"),
    "a name twice": (section("1\n    x: 2"), "`x` is set twice, in the lines 3 and 4"),
    "a name twice in two sections": (section("1") + section("2"), "`x` is set twice, in the lines 3 and 6"),
    "a name twice in two spellings": (section("0\n    a:\n      b: 1\n    a.b: 2"), "`a.b` is set twice"),
    "a value and names below": (section("0\n    x:\n      y:\n        z: 1"), "`x` has a value in line 3 and holds"),
    "no value": (section("1\n    y:"), "line 4 gives `y` no value"),
    # The list that begins in line 4 goes on in line 5, where it breaks off.
    "a list that breaks off": (section("1\n    y: [1\n    z: 2"), ", line 5 is not YAML: "),
    "names beyond reason": (section("{a: " * 1200 + "1" + "}" * 1200), "nested too deeply"),
    "an empty group": (section("1\n    y: {}"), "line 4 gives `y` no value"),
}


@pytest.mark.parametrize(("text", "why"), REFUSED_FILES.values(), ids=REFUSED_FILES)
def test_a_file_that_is_no_parameter_file_is_refused(tmp_path: Path, text: str, why: str) -> None:
    assert why in refusal(parameter_file(tmp_path, text))


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    assert refusal(tmp_path / "nothing.yaml").endswith("cannot be read: No such file or directory")
    assert refusal(tmp_path).endswith("cannot be read: Is a directory")
    (tmp_path / "latin.yaml").write_bytes(section("é").encode("latin-1"))
    assert "is not UTF-8 text" in refusal(tmp_path / "latin.yaml")
    (tmp_path / "null.yaml").write_bytes(section("a\0b").encode())
    assert "is not YAML" in refusal(tmp_path / "null.yaml")


def test_a_node_in_a_namespace_has_its_own_sections(tmp_path: Path) -> None:
    file = parameter_file(tmp_path, section("1", "/robot/impact_predictor") + section("2", "impact_predictor"))
    assert read_parameters(file, "/robot/impact_predictor") == {"x": 1}
    assert read_parameters(file) == {"x": 2}


def test_every_parameter_is_explained_in_a_shipped_scene() -> None:
    lines = [line.strip() for file in SCENES.glob("*.yaml") for line in file.read_text().splitlines()]
    # Right behind a comment, or named in one.
    set_behind = {line.partition(":")[0] for above, line in pairwise(lines) if above.startswith("#")}
    comments = " ".join(line for line in lines if line.startswith("#"))
    unexplained = [name for name in PARAMETERS if name.split(".")[-1] not in set_behind and name not in comments]
    assert unexplained == []
