"""Parameters of several bodies and of a support that moves: what holds for whom, and what does not fit together."""

from __future__ import annotations

from math import hypot, pi, sqrt
from typing import Any

import pytest

from impact_predictor.errors import InputError
from impact_predictor.parameters.validation import PARAMETERS, parameter_of, validate
from impact_predictor.prediction.scene import MovingDeck, Watching, scenes_of

BODY: dict[str, Any] = {"body.mass": 100.0, "body.inertia": [20.0], "contact.friction": 0.5}
BOX = [x for a in (-0.5, 0.5) for b in (-0.5, 0.5) for x in (a, b, -0.8)]
EDGES = [0.0, -0.2, 0.0, 0.0, 0.2, 0.0]
UP = [0.0, 0.0, 9.81]
BLIND: dict[str, Any] = {"source": "none", "onset.watch": True, "body.contact_points": BOX}
STANDS = [0.0, 0.0, 0.8]


def refusal(given: dict[str, Any]) -> str:
    """What is said about values given beside those of a body; one that is None is not given at all."""
    values = {name: value for name, value in {**BODY, **given}.items() if value is not None}
    with pytest.raises(InputError) as caught:
        validate(values)
    sentence = str(caught.value)
    assert "\n" not in sentence
    return sentence


def test_a_body_has_the_common_values_and_its_own_instead() -> None:
    given = {**BODY, "bodies": ["crate", "drum"], "drum.body.mass": 50.0, "crate.horizon": 0.5, "horizon": 0.3}
    scenes = scenes_of(validate(given))
    assert list(scenes) == ["crate", "drum"]
    assert [(scene.mass, scene.horizon) for scene in scenes.values()] == [(100.0, 0.5), (50.0, 0.3)]


def test_without_names_there_is_one_body() -> None:
    assert list(scenes_of(validate(BODY))) == [""]


def test_what_every_body_has_of_its_own_needs_no_common_value() -> None:
    given = {**BODY, "bodies": ["a", "b"], "a.body.mass": 1.0, "b.body.mass": 2.0}
    del given["body.mass"]
    values = validate(given)
    assert "body.mass" not in values
    assert [scene.mass for scene in scenes_of(values).values()] == [1.0, 2.0]
    assert refusal({"body.mass": None, "bodies": ["a", "b"], "a.body.mass": 1.0}) == (
        "the parameter body.mass is missing: give a finite double from 1e-09 to 1e+12 kg (Mass of the body), "
        "or b.body.mass for b alone"
    )


def test_values_that_were_checked_are_allowed_as_they_are() -> None:
    given = {**BODY, "bodies": ["a", "b"], "body.contact_points": BOX, "a.source": "none", "onset.watch": True}
    given["place.position"] = STANDS
    values = validate(given)
    assert validate({name: value for name, value in values.items() if value != ()}) == values
    assert all(parameter_of(name).name == name.removeprefix("a.") for name in values)


@pytest.mark.parametrize("name", ["a-b", "1", "", "_a", "a_", "a__b", "a b", "a/b", "é"])
def test_a_name_is_a_part_of_the_name_of_a_topic(name: str) -> None:
    assert f"but {name!r} is no part of a ROS name" in refusal({"bodies": ["ok", name]})


def test_names_are_texts_that_differ_from_each_other() -> None:
    assert refusal({"bodies": ["a", "b", "a"]}).endswith("but 'a' is there twice")
    assert refusal({"bodies": "a"}).endswith("but it must be a list of texts")
    assert refusal({"bodies": [1, 2]}).endswith("but it must be a list of texts")


@pytest.mark.parametrize(
    "name", ["body", "contact", "support", "odom", "onset", "place", "use_sim_time", "qos_overrides"]
)
def test_a_name_hides_no_parameter(name: str) -> None:
    assert refusal({"bodies": [name]}).startswith(f"a body cannot be named {name}, as parameters begin with that")


@pytest.mark.parametrize("name", [name for name, parameter in PARAMETERS.items() if parameter.shared])
def test_what_holds_for_all_bodies_is_given_once(name: str) -> None:
    value = PARAMETERS[name].default
    assert refusal({"bodies": ["a"], f"a.{name}": value}) == (
        f"the parameter {name} holds for all bodies: give {name} in the place of a.{name}"
    )


def test_all_that_concerns_the_support_as_a_whole_is_shared() -> None:
    assert {name for name, parameter in PARAMETERS.items() if parameter.shared} == {
        *("bodies", "executor", "gravity", "support.extent", "support.extrapolation", "support.frame"),
        *("support.harmonic_window", "support.imu_position", "support.motion", "support.timeout", "support.window"),
    }


def test_a_name_of_no_body_or_parameter_is_answered_with_a_hint() -> None:
    bodies = ["crate", "drum"]
    assert refusal({"bodies": bodies, "crat.body.mass": 1.0}) == (
        "there is no parameter crat.body.mass, for crat is not among the bodies: crate, drum"
    )
    assert refusal({"crate.body.mass": 1.0}) == "there is no parameter crate.body.mass, for bodies is not given"
    assert refusal({"bodies": bodies, "crate.body.masss": 1.0}).endswith("did you mean crate.body.mass?")
    assert refusal({"bodies": bodies, "body.masss": 1.0}).endswith("did you mean body.mass?")


def test_a_wrong_value_of_one_body_is_named_with_it() -> None:
    assert refusal({"bodies": ["a"], "a.body.mass": -1.0}).startswith("the parameter a.body.mass is -1.0, but")


@pytest.mark.parametrize("source", ["imu", "none"])
def test_a_body_whose_pose_is_not_measured_is_watched_or_on_a_deck_and_has_its_points(source: str) -> None:
    assert refusal({"source": source, "body.contact_points": BOX}).startswith(
        f"source is {source}, so no impact can be predicted: set onset.watch: true"
    )
    assert refusal({"bodies": ["a", "b"], "b.source": source, "onset.watch": True}) == (
        f"b.source is {source}, so the contact points of b must be parameters: give body.contact_points"
    )
    for enough in ({"onset.watch": True}, {"support.motion": "odom"}):
        validate({**BODY, "source": source, "body.contact_points": BOX, "place.position": STANDS, **enough})


def test_a_cylinder_has_a_radius_and_two_edges_and_no_points() -> None:
    assert refusal({"body.radius": 0.3}).endswith("makes the body a cylinder: give the support.edges on which it lies")
    assert refusal({"support.edges": EDGES}).endswith("carry a cylinder: give the radius of the body as body.radius")
    assert refusal({"body.radius": 0.3, "support.edges": EDGES[:3] * 2}).endswith("but the two edges coincide")
    assert refusal({"body.radius": 0.3, "support.edges": EDGES, "body.contact_points": BOX}) == (
        "body.contact_points and body.radius are both given: a cylinder has no points"
    )
    (drum,) = scenes_of(validate({**BODY, "body.radius": 0.3, "support.edges": EDGES})).values()
    assert (drum.radius, drum.edges, drum.points) == (0.3, ((0.0, -0.2, 0.0), (0.0, 0.2, 0.0)), ())
    assert not drum.needs_geometry


def test_common_points_and_edges_are_for_the_bodies_that_use_them() -> None:
    given = {"bodies": ["box", "drum"], "body.contact_points": BOX, "support.edges": EDGES, "drum.body.radius": 0.3}
    scenes = scenes_of(validate({**BODY, **given}))
    assert len(scenes["box"].points) == 4
    assert scenes["drum"].points == ()
    assert refusal({**given, "drum.body.contact_points": BOX}).startswith("drum.body.contact_points and drum.body.radi")
    assert refusal({**given, "box.support.edges": EDGES}).startswith("box.support.edges carry a cylinder")


@pytest.mark.parametrize("given", [{"onset.watch": True}, {"support.motion": "odom"}, {"support.motion": "imu"}])
def test_gravity_with_the_wrong_sign_is_refused_where_it_decides(given: dict[str, Any]) -> None:
    assert refusal({**given, "gravity": UP}).startswith("gravity points out of the support, so everything falls off it")
    tilted = {"gravity": [0.0, 7.0, -7.0], "support.normal": [0.0, 1.0, 0.5]}
    assert refusal({**given, **tilted}).startswith("gravity points out of the support")
    validate({**BODY, **given})
    validate({**BODY, "gravity": UP})


def test_an_extent_is_ordered_and_carries_what_is_placed_on_it() -> None:
    extent = [-5.0, 5.0, -2.0, 2.0]
    for wrong in ([5.0, -5.0, -2.0, 2.0], [-5.0, 5.0, 2.0, 2.0]):
        assert refusal({"support.extent": wrong}).endswith("but each least must be below its greatest")
    blind = {"source": "none", "body.contact_points": BOX, "support.motion": "odom", "support.extent": extent}
    validate({**BODY, **blind, "place.position": [5.0, -2.0, 0.8]})
    assert refusal({**blind, "place.position": [0.0, 2.1, 0.8]}).startswith("place.position is outside support.extent")
    validate({**BODY, **blind, "source": "odom", "place.position": [0.0, 2.1, 0.8]})


@pytest.mark.parametrize("source", ["imu", "none"])
def test_a_body_watched_where_it_was_placed_needs_a_support_across_z(source: str) -> None:
    blind = {**BLIND, "source": source, "place.position": STANDS}
    for normal in ([0.0, 0.1, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 2e-6, 1.0]):
        assert refusal({**blind, "support.normal": normal, "gravity": [0.0, 0.0, 0.0]}) == (
            f"support.normal is not along z, and source is {source}: the place of a body is not turned onto an "
            "inclined support, so give source: odom, or choose the support's frame with z along the normal"
        )
        validate({**BODY, **blind, "source": "odom", "support.normal": normal, "gravity": [0.0, 0.0, 0.0]})
    for normal in ([0.0, 0.0, 3.0], [0.0, 1e-6, 3.0]):
        validate({**BODY, **blind, "support.normal": normal})


@pytest.mark.parametrize("source", ["imu", "none"])
def test_a_body_watched_where_it_was_placed_stands_on_its_support(source: str) -> None:
    blind = {**BLIND, "source": source, "support.height": 0.3}
    # A hundredth of its size, the diagonal of 1 m x 1 m, is 0.0141 m.
    for z in (1.1, 1.114, 1.086):
        validate({**BODY, **blind, "place.position": [0.0, 0.0, z]})
    assert refusal({**blind, "place.position": [0.0, 0.0, 1.125]}) == (
        "at place.position the body floats 0.025 m above its support: correct place.position, or where its support is"
    )
    many = {"bodies": ["a", "b"], **blind, "place.position": [0.0, 0.0, 1.1], "b.place.position": STANDS}
    assert refusal(many).startswith("at b.place.position the body of b sinks 0.3 m into its support")
    far = {**blind, "place.position": [0.0, 0.0, 1.125]}
    validate({**BODY, **far, "contact.tolerance": 0.03})
    validate({**BODY, **far, "source": "odom"})


def test_a_cylinder_watched_where_it_was_placed_touches_both_edges() -> None:
    high = sqrt(0.3**2 - 0.2**2)
    drum = {"source": "none", "onset.watch": True, "body.radius": 0.3, "support.edges": EDGES}
    validate({**BODY, **drum, "place.position": [4.0, 0.0, high]})
    # Its axis runs through the mass centre, which the yaw takes along.
    turned = {"body.center_of_mass": [0.1, 0.0, 0.0], "place.yaw": 0.5 * pi, "place.position": [0.0, -0.1, high]}
    validate({**BODY, **drum, **turned})
    assert "floats" in refusal({**drum, **turned, "place.yaw": -0.5 * pi})
    above = hypot(0.2, high + 0.1) - 0.3
    assert refusal({**drum, "place.position": [0.0, 0.0, high + 0.1]}).startswith(
        f"at place.position the body floats {above:.3g} m above its edges"
    )
    for z in (high - 0.1, -high):
        assert "m into its edges" in refusal({**drum, "place.position": [0.0, 0.0, z]})
    leaning = [0.0, -0.2, 0.0, 0.0, 0.2, 0.3]
    up = sqrt(0.3**2 - 0.25**2) / 0.5
    validate({**BODY, **drum, "support.edges": leaning, "place.position": [0.0, -0.3 * up, 0.15 + 0.4 * up]})


def test_levels_rise_in_their_order() -> None:
    assert refusal({"bodies": ["a"], "a.onset.warn": 1.2}) == (
        "a.onset.warn is 1.2, above onset.error, which is 1: the level is WARN before it is ERROR"
    )
    validate({**BODY, "onset.warn": 1.0})


def test_a_harmonic_window_is_the_longer_one_whether_the_support_moves_or_not() -> None:
    assert "must be longer than support.window" in refusal({"support.window": 5.0, "support.harmonic_window": 5.0})
    validate({**BODY, "support.extrapolation": "harmonic"})


def test_a_moving_support_and_a_watch_reach_the_scene() -> None:
    given = {
        "support.motion": "imu",
        "support.imu_position": [1.0, 2.0, 3.0],
        "support.window": 0.1,
        "support.timeout": 0.4,
        "support.extrapolation": "harmonic",
        "support.harmonic_window": 30.0,
        "support.extent": [-1.0, 1.0, -2.0, 2.0],
        "onset.watch": True,
        "onset.warn": 0.5,
        "onset.error": 0.9,
        "onset.hysteresis": 0.2,
        "onset.hold": 3.0,
        "onset.horizon": 10.0,
    }
    (scene,) = scenes_of(validate({**BODY, **given})).values()
    deck = MovingDeck("imu", (1.0, 2.0, 3.0), 0.1, "harmonic", 30.0, 0.4, (-1.0, 1.0, -2.0, 2.0))
    assert scene.deck == deck
    assert scene.watching == Watching(0.5, 0.9, 0.2, 3.0, 10.0)


def test_the_defaults_of_a_moving_support_and_of_a_watch_are_those_of_their_types() -> None:
    (scene,) = scenes_of(validate({**BODY, "support.motion": "odom", "onset.watch": True})).values()
    assert (scene.deck, scene.watching) == (MovingDeck(), Watching())
