"""Values that are each allowed, and what does not fit together: several bodies, moving supports, watches and feet."""

from __future__ import annotations

from math import hypot, inf, nan, pi, sqrt
from typing import Any

import pytest

from impact_predictor.errors import InputError
from impact_predictor.parameters.validation import PARAMETERS, parameter_of, validate
from impact_predictor.prediction.scene import Chock, Lashing, MovingDeck, Watching, Wind, scenes_of

BODY: dict[str, Any] = {"body.mass": 100.0, "body.inertia": [20.0], "contact.friction": 0.5}
BOX = [x for a in (-0.5, 0.5) for b in (-0.5, 0.5) for x in (a, b, -0.8)]
EDGES = [0.0, -0.2, 0.0, 0.0, 0.2, 0.0]
UP = [0.0, 0.0, 9.81]
EXTENT = [-5.0, 5.0, -2.0, 2.0]
STANDS = [0.0, 0.0, 0.8]
BLIND: dict[str, Any] = {"source": "none", "onset.watch": True, "body.contact_points": BOX}
STOOD = {"place.position": STANDS}
LASHED = {
    **BLIND,
    **STOOD,
    "lashings.points": [0.0, 0.5, 0.0, 0.0, -0.5, 0.0],
    "lashings.anchors": [0.0, 3.0, 0.0, 0.0, -3.0, 0.0],
    "lashings.msl": [1e4],
}
HIGH = sqrt(0.3**2 - 0.2**2)
DRUM: dict[str, Any] = {"body.radius": 0.3, "support.edges": EDGES}
BLIND_DRUM = {**DRUM, "source": "none", "onset.watch": True}
MIXED = {"bodies": ["box", "drum"], "body.contact_points": BOX, "support.edges": EDGES, "drum.body.radius": 0.3}
FEET: dict[str, Any] = {"feet.names": ["left", "right"]}
WALKS = "but feet.names makes the body a machine that walks, and"
WITH_WALKER = {"bodies": ["crate", "walker"], "body.contact_points": BOX, "walker.feet.names": ["one"]}
MODEL = {"feet.names": ["foot"], "robot.urdf": "robot.urdf", "robot.frames": ["sole"]}


def refusal(given: dict[str, Any]) -> str:
    """What is said about values given beside those of a body; one that is None is not given at all."""
    values = {name: value for name, value in {**BODY, **given}.items() if value is not None}
    with pytest.raises(InputError) as caught:
        validate(values)
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence


REFUSED: list[tuple[dict[str, Any], str]] = [
    # Several bodies
    ({"bodies": ["a", "b", "a"]}, "but 'a' is there twice"),
    ({"bodies": "a"}, "but it must be a list of texts"),
    ({"bodies": [1, 2]}, "but it must be a list of texts"),
    (
        {"body.mass": None, "bodies": ["a", "b"], "a.body.mass": 1.0},
        (
            "the parameter body.mass is missing: give a finite double from 1e-09 to 1e+12 kg (Mass of the body), "
            "or b.body.mass for b alone"
        ),
    ),
    (
        {"bodies": ["crate", "drum"], "crat.body.mass": 1.0},
        "there is no parameter crat.body.mass, for crat is not among the bodies: crate, drum",
    ),
    ({"crate.body.mass": 1.0}, "there is no parameter crate.body.mass, for bodies is not given"),
    ({"bodies": ["crate", "drum"], "crate.body.masss": 1.0}, "did you mean crate.body.mass?"),
    ({"bodies": ["crate", "drum"], "body.masss": 1.0}, "did you mean body.mass?"),
    ({"bodies": ["a"], "a.body.mass": -1.0}, "the parameter a.body.mass is -1.0, but"),
    # What holds a body besides friction
    ({**LASHED, "onset.watch": False, "source": "odom"}, "lashings.points counts in the margins under watch alone, so"),
    ({**BLIND_DRUM, "wind.pressure": 9.0}, "wind.pressure counts in the margins under watch alone, not for a cylinder"),
    ({**LASHED, "lashings.anchors": [0.0, 3.0, 0.0]}, "lashings.points has 2 points, but lashings.anchors has 1: give"),
    ({**LASHED, "lashings.anchors": [0.0, 3.0]}, "but it must have three numbers for each, not 2 in all"),
    ({**LASHED, "lashings.msl": None}, "lashings.msl must be above 0 N: give what each of the 2 lashings may bear"),
    ({**LASHED, "lashings.msl": [1.0, 2.0, 3.0]}, "lashings.msl has 3 numbers, but lashings.points has 2 points: give"),
    ({**LASHED, "lashings.preload": [0.0, 2e4]}, "lashing 1 has an MSL of 10000 N, below its preload of 20000 N"),
    (
        {**LASHED, "lashings.anchors": [0.0, 0.5, 0.8, 0.0, -3.0, 0.0]},
        "lashing 0 has no length: its point and its anch",
    ),
    (
        {**LASHED, "support.motion": "odom", "support.extent": EXTENT},
        "lashing 0 goes nowhere: its anchor is outside support.extent",
    ),
    (
        {**LASHED, "lashings.anchors": [0.0, 3e4, 0.0, 0.0, -3.0, 0.0]},
        "lashing 0 goes nowhere: its anchor is 29999.5 m",
    ),
    ({**BLIND, **STOOD, "chocks.points": [0.0, 0.5, 0.1]}, "chocks.points has 1 points, but chocks.normals has 0"),
    (
        {**BLIND, **STOOD, "chocks.points": [0.0, 0.5, 0.1], "chocks.normals": [0.0, 0.0, 0.0]},
        "chocks.normals has a direction of length zero",
    ),
    ({**BLIND, **STOOD, "wind.pressure": 100.0}, "wind.pressure is given, but no wind.area that it acts on: give both"),
    (
        {**BLIND, **STOOD, "contact.friction_band": [0.1, 0.3]},
        "contact.friction_band is 0.1 to 0.3, and contact.friction is 0.5: it must lie between them",
    ),
    # Bodies whose pose is not measured
    (
        {"source": "imu", "body.contact_points": BOX},
        "source is imu, so no impact can be predicted: set onset.watch: tr",
    ),
    ({"source": "none", "body.contact_points": BOX}, "source is none, so no impact can be predicted: set onset.watch:"),
    (
        {"bodies": ["a", "b"], "b.source": "imu", "onset.watch": True},
        "b.source is imu, so the contact points of b must be parameters: give body.contact_points",
    ),
    (
        {**BLIND, "support.extent": EXTENT, "support.motion": "odom", "place.position": [0.0, 2.1, 0.8]},
        "place.position is outside support.extent",
    ),
    (
        {**BLIND, "support.height": 0.3, "place.position": [0.0, 0.0, 1.125]},
        "at place.position the body floats 0.025 m above its support: correct place.position, or where its support is",
    ),
    (
        {"bodies": ["a", "b"], **BLIND, "place.position": STANDS, "b.place.position": [0.0, 0.0, 0.5]},
        "at b.place.position the body of b sinks 0.3 m into its support",
    ),
    # Cylinders
    ({"body.radius": 0.3}, "makes the body a cylinder: give the support.edges on which it lies"),
    ({"support.edges": EDGES}, "carry a cylinder: give the radius of the body as body.radius"),
    ({"body.radius": 0.3, "support.edges": EDGES[:3] * 2}, "but the two edges coincide"),
    ({**DRUM, "body.contact_points": BOX}, "body.contact_points and body.radius are both given: a cylinder has no poi"),
    ({**MIXED, "drum.body.contact_points": BOX}, "drum.body.contact_points and drum.body.radius are both given"),
    ({**MIXED, "box.support.edges": EDGES}, "box.support.edges carry a cylinder"),
    (
        {**BLIND_DRUM, "place.position": [0.0, 0.0, HIGH + 0.1]},
        f"at place.position the body floats {hypot(0.2, HIGH + 0.1) - 0.3:.3g} m above its edges",
    ),
    ({**BLIND_DRUM, "place.position": [0.0, 0.0, HIGH - 0.1]}, "m into its edges"),
    ({**BLIND_DRUM, "place.position": [0.0, 0.0, -HIGH]}, "m into its edges"),
    # Supports
    ({"onset.watch": True, "gravity": UP}, "gravity points out of the support, so everything falls off it"),
    ({"support.motion": "imu", "gravity": UP}, "gravity points out of the support, so everything falls off it"),
    (
        {"support.motion": "odom", "gravity": [0.0, 7.0, -7.0], "support.normal": [0.0, 1.0, 0.5]},
        "gravity points out of the support",
    ),
    ({"support.extent": [5.0, -5.0, -2.0, 2.0]}, "but each least must be below its greatest"),
    ({"support.extent": [-5.0, 5.0, 2.0, 2.0]}, "but each least must be below its greatest"),
    (
        {"bodies": ["a"], "a.onset.warn": 1.2},
        "a.onset.warn is 1.2, above onset.error, which is 1: the level is WARN before it is ERROR",
    ),
    # Feet
    ({**FEET, "source": "none"}, f"source is none, {WALKS} its pose and twist must be measured: give odom"),
    ({**FEET, "support.motion": "odom"}, f"support.motion is odom, {WALKS} its ground must not move: give fixed"),
    ({**FEET, "body.radius": 0.3}, f"body.radius is 0.3, {WALKS} it touches the ground with its feet: give 0.0"),
    (
        {**FEET, "onset.watch": True},
        f"onset.watch is true, {WALKS} it is not watched for sliding and tipping: give fal",
    ),
    ({**FEET, "margins": True}, f"margins is true, {WALKS} the margins of its impacts are not known: give false"),
    ({**FEET, "odom.twist_window": 0.01}, f"odom.twist_window is 0.01, {WALKS} its twist must be that of the very ins"),
    ({**FEET, "uncertainty.samples": 64}, f"uncertainty.samples is 64, {WALKS} no uncertainty is carried through its "),
    (
        {**WITH_WALKER, "walker.onset.watch": True},
        "walker.onset.watch is true, but walker.feet.names makes the body of walker a machine that walks",
    ),
    (
        {**FEET, "body.contact_points": BOX},
        "body.contact_points and feet.names are both given: feet move, so their points come with messages",
    ),
    ({"feet.names": ["a", "b", "a"]}, "but 'a' is there twice"),
    ({**FEET, "contact.tolerance": 0.0}, "contact.tolerance is 0, which feet do not learn: give it in m"),
    ({"feet.names": ["a", ""]}, "but a name is empty"),
    ({"feet.points": 2}, "feet.points is for a machine that walks: give the names of its feet as feet.names"),
    ({"feet.force": 30.0}, "feet.force is for a machine that walks: give the names of its feet as feet.names"),
    ({"feet.has_schedule": True}, "feet.has_schedule is for a machine that walks: give the names of its feet as feet"),
    (
        {**FEET, "feet.friction": [0.4, -0.1]},
        "feet.friction is [0.4, -0.1], but it must be a list of finite doubles",
    ),
    (
        {**FEET, "feet.restitution": [1.2]},
        "feet.restitution is [1.2], but it must be a list of finite doubles",
    ),
    (
        {**FEET, "feet.friction": [0.4, 0.5, 0.6]},
        "feet.friction has 3 numbers, but feet.names has 2: give one number for each foot, or one for all of them",
    ),
    (
        {"feet.restitution": [0.1]},
        "feet.restitution is for a machine that walks: give the names of its feet",
    ),
    ({"robot.urdf": "a.urdf"}, "robot.urdf is for a machine that walks: give the names of its feet as feet.names"),
    # Models
    ({**FEET, "robot.urdf": "a.urdf", "robot.frames": ["a", "a"]}, "but 'a' is there twice"),
    (
        {**FEET, "robot.urdf": "a.urdf", "robot.frames": ["a", "b", "c"]},
        "robot.frames has 3 names, but feet.names has 2 and feet.points is 1: give one frame for each point of each",
    ),
    ({**FEET, "robot.urdf": "a.urdf"}, "robot.frames has 0 names, but"),
    ({**MODEL, "robot.soles": [0.1, 0.0]}, "robot.soles has 2 numbers, but feet.points is 1: give x y z of each point"),
    (
        {**MODEL, "feet.points": 2, "robot.frames": ["a", "b"], "robot.soles": [0.1] * 6},
        "give one frame for each point of each foot, or for each foot with robot.soles",
    ),
    ({**FEET, "robot.frames": ["a", "b"]}, "robot.frames is for the model of a machine: give its file as robot.urdf"),
    ({**FEET, "robot.armature": [0.1]}, "robot.armature is for the model of a machine: give its file as robot.urdf"),
    ({**MODEL, "robot.armature": [-0.1]}, "robot.armature is [-0.1], but it must be a list of finite doubles"),
    ({**MODEL, "robot.armature": [0.1, 0.2]}, "robot.armature has 2 numbers, but robot.joints has 0 names: give one"),
    ({**MODEL, "robot.joints": ["a", "a"]}, "but 'a' is there twice"),
    ({**MODEL, "robot.kd": [2.0]}, "robot.drives is free with robot.kd: give pd and at least one of robot.kp and"),
    ({**MODEL, "robot.drives": "pd"}, "robot.drives is pd with no gains: give pd and at least one of robot.kp and"),
    ({**MODEL, "robot.drives": "pd", "robot.kp": [nan]}, "robot.kp is [nan], but it must be a list of finite doubles"),
    (
        {**MODEL, "robot.drives": "pd", "robot.joints": ["a", "b"], "robot.kp": [1.0] * 3},
        "robot.kp has 3 numbers, but robot.joints has 2 names: give one number for all joints, or name each joint",
    ),
    (
        {**FEET, "feet.force": 20.0, "feet.force_source": "effort"},
        "feet.force_source is effort: give robot.urdf, by which joints tell the force on a foot, and feet.force",
    ),
    ({**MODEL, "feet.force_source": "effort"}, "feet.force_source is effort: give robot.urdf"),
    ({**MODEL, "body.mass": None, "robot.urdf": ""}, "body.mass is missing"),
]


@pytest.mark.parametrize(("given", "said"), REFUSED, ids=range(len(REFUSED)))
def test_what_does_not_fit_together_is_refused_in_one_sentence(given: dict[str, Any], said: str) -> None:
    assert said in refusal(given)


@pytest.mark.parametrize(
    "given",
    [
        *({**BLIND, "place.position": STANDS, "source": source} for source in ("imu", "none")),
        {"source": "imu", "support.motion": "odom", "body.contact_points": BOX, "place.position": STANDS},
        *({**BLIND, "support.extent": EXTENT, "place.position": [x, y, 0.8]} for x, y in ((5.0, -2.0), (-5.0, 2.0))),
        {"support.extent": EXTENT, "place.position": [0.0, 2.1, 0.8]},
        # A hundredth of its size, the diagonal of 1 m x 1 m, is 0.0141 m.
        *({**BLIND, "support.height": 0.3, "place.position": [0.0, 0.0, z]} for z in (1.1, 1.114, 1.086)),
        {**BLIND, "place.position": [0.0, 0.0, 0.825], "contact.tolerance": 0.03},
        {**BLIND, "place.position": [0.0, 0.0, 0.825], "source": "odom"},
        *({**BLIND, "place.position": STANDS, "support.normal": up} for up in ([0.0, 0.0, 3.0], [0.0, 1e-6, 3.0])),
        {**BLIND_DRUM, "place.position": [4.0, 0.0, HIGH]},
        # The axis of a cylinder runs through the mass centre, which the yaw takes along.
        {
            **BLIND_DRUM,
            "body.center_of_mass": [0.1, 0.0, 0.0],
            "place.yaw": 0.5 * pi,
            "place.position": [0.0, -0.1, HIGH],
        },
        {
            **BLIND_DRUM,
            "support.edges": [0.0, -0.2, 0.0, 0.0, 0.2, 0.3],
            "place.position": [0.0, -0.6 * sqrt(0.3**2 - 0.25**2), 0.15 + 0.8 * sqrt(0.3**2 - 0.25**2)],
        },
        {"gravity": UP},
        {"onset.warn": 1.0},
        {"feet.names": ["left foot", "LF_FOOT-1"]},
        {**WITH_WALKER, "feet.points": 2, "robot.urdf": "a.urdf", "walker.robot.frames": ["heel", "toe"]},
        {**FEET, "feet.points": 2, "robot.urdf": "a.urdf", "robot.frames": ["a", "b", "c", "d"]},
        {**MODEL, "feet.points": 2, "robot.soles": [-0.1, 0.0, 0.0, 0.1, 0.0, 0.0]},
    ],
)
def test_what_fits_together_is_taken(given: dict[str, Any]) -> None:
    validate({**BODY, **given})


@pytest.mark.parametrize("normal", [[0.0, 0.1, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 2e-6, 1.0]])
def test_a_body_watched_where_it_was_placed_needs_a_support_across_z(normal: list[float]) -> None:
    blind = {**BLIND, "place.position": STANDS, "support.normal": normal, "gravity": [0.0, 0.0, 0.0]}
    assert refusal(blind) == (
        "support.normal is not along z, and source is none: the place of a body is not turned onto an inclined "
        "support, so give source: odom, or choose the support's frame with z along the normal"
    )
    validate({**BODY, **blind, "source": "odom"})


@pytest.mark.parametrize("name", ["a-b", "1", "", "_a", "a_", "a__b", "a b", "a/b", "é"])
def test_a_name_is_a_part_of_the_name_of_a_topic(name: str) -> None:
    assert f"but {name!r} is no part of a ROS name" in refusal({"bodies": ["ok", name]})


@pytest.mark.parametrize(
    "name", ["body", "contact", "support", "odom", "onset", "place", "use_sim_time", "qos_overrides"]
)
def test_a_name_hides_no_parameter(name: str) -> None:
    assert refusal({"bodies": [name]}).startswith(f"a body cannot be named {name}, as parameters begin with that")


def test_what_concerns_the_support_as_a_whole_is_shared_and_given_once() -> None:
    shared = {name for name, parameter in PARAMETERS.items() if parameter.shared}
    assert shared == {
        *("bodies", "executor", "gravity", "messages", "support.extent", "support.frame", "support.imu_position"),
        *("support.motion", "support.timeout", "support.window"),
    }
    for name in shared:
        assert refusal({"bodies": ["a"], f"a.{name}": PARAMETERS[name].default}) == (
            f"the parameter {name} holds for all bodies: give {name} in the place of a.{name}"
        )


def test_a_body_has_the_common_values_and_its_own_instead() -> None:
    given = {**BODY, "bodies": ["crate", "drum"], "drum.body.mass": 50.0, "crate.horizon": 0.5, "horizon": 0.3}
    scenes = scenes_of(validate(given))
    assert list(scenes) == ["crate", "drum"]
    assert [(scene.mass, scene.horizon) for scene in scenes.values()] == [(100.0, 0.5), (50.0, 0.3)]
    assert list(scenes_of(validate(BODY))) == [""]
    del given["body.mass"]
    values = validate({**given, "crate.body.mass": 1.0})
    assert "body.mass" not in values
    assert [scene.mass for scene in scenes_of(values).values()] == [1.0, 50.0]


def test_values_that_were_checked_are_allowed_as_they_are() -> None:
    given = {**BODY, "bodies": ["a", "b"], "body.contact_points": BOX, "a.source": "none", "onset.watch": True}
    values = validate({**given, "place.position": STANDS})
    assert validate({name: value for name, value in values.items() if value != ()}) == values
    assert all(parameter_of(name).name == name.removeprefix("a.") for name in values)


def test_common_points_and_edges_are_for_the_bodies_that_use_them() -> None:
    scenes = scenes_of(validate({**BODY, **MIXED}))
    assert [len(scene.points) for scene in scenes.values()] == [4, 0]
    drum = scenes["drum"]
    assert (drum.radius, drum.edges) == (0.3, ((0.0, -0.2, 0.0), (0.0, 0.2, 0.0)))
    assert not drum.needs_geometry
    walking = scenes_of(validate({**BODY, **WITH_WALKER}))
    assert [(len(scene.points), scene.walking is not None) for scene in walking.values()] == [(4, False), (0, True)]


def test_a_machine_whose_model_tells_its_mass_needs_neither_mass_nor_inertia() -> None:
    values = validate({**MODEL, "contact.friction": 0.7})
    assert not {"body.mass", "body.inertia"} & values.keys()
    assert validate({name: value for name, value in values.items() if value not in ((), "")}) == values
    assert validate({**MODEL, "contact.friction": 0.7, "body.mass": 3.0})["body.mass"] == 3.0
    several = {**{f"dog.{name}": value for name, value in MODEL.items()}, "bodies": ["dog", "crate"]}
    assert "or crate.body.mass for crate alone" in refusal({**several, "body.mass": None})


def test_a_moving_support_and_a_watch_reach_the_scene() -> None:
    given = {
        "support.motion": "imu",
        "support.imu_position": [1.0, 2.0, 3.0],
        "support.window": 0.1,
        "support.timeout": 0.4,
        "support.extent": [-1.0, 1.0, -2.0, 2.0],
        "onset.watch": True,
        "onset.warn": 0.5,
        "onset.error": 0.9,
        "onset.hysteresis": 0.2,
        "onset.hold": 3.0,
        "onset.horizon": 12.0,
        "onset.vain": 0.3,
    }
    (scene,) = scenes_of(validate({**BODY, **given})).values()
    assert scene.deck == MovingDeck("imu", (1.0, 2.0, 3.0), 0.1, 0.4, (-1.0, 1.0, -2.0, 2.0))
    assert scene.watching == Watching(0.5, 0.9, 0.2, 3.0, 12.0, 0.3)


def test_the_defaults_of_a_moving_support_and_of_a_watch_are_those_of_their_types() -> None:
    (scene,) = scenes_of(validate({**BODY, "support.motion": "odom", "onset.watch": True})).values()
    assert (scene.deck, scene.watching) == (MovingDeck(), Watching())


def test_lashings_chocks_and_wind_reach_the_scene_with_what_is_left_out() -> None:
    given = {
        **LASHED,
        "lashings.preload": [1e3, 0.0],
        "chocks.points": [0.0, 0.5, 0.1],
        "chocks.normals": [0.0, -2.0, 0.0],
        "wind.pressure": 100.0,
        "wind.area": [1.0, 2.0],
        "contact.friction_band": [0.3, 0.6],
    }
    (scene,) = scenes_of(validate({**BODY, **given})).values()
    assert scene.lashings == (
        Lashing((0.0, 0.5, 0.0), (0.0, 3.0, 0.0), 1e4, 1e3, 0.0),
        Lashing((0.0, -0.5, 0.0), (0.0, -3.0, 0.0), 1e4, 0.0, 0.0),
    )
    assert scene.chocks == (Chock((0.0, 0.5, 0.1), (0.0, -1.0, 0.0), inf),)
    assert scene.wind == Wind(100.0, (1.0, 2.0), (0.0, 0.0, 0.0))
    assert scene.friction_band == (0.3, 0.6)
