"""Small answers of replays, as `as_json` gives them, that tests of their page share."""

from __future__ import annotations

from typing import Any

from impact_predictor.report.summary import spread_of, to_json

MS = 1_000_000


def touchdown(at: float, **given: Any) -> dict[str, Any]:
    """A touchdown `at` ms that is compared: 0.5 m/s predicted along the support, 0.4 measured."""
    usual = {
        "body": "cube",
        "stamp": round(at * MS),
        "announced_lead_time": 0.05,
        "lead_time": 0.004,
        "mode": "PIVOT",
        "predicted_twist": [0.5, 0.1, -2.0],
        "measured_twist": [0.4, 0.1, -1.0],
        "before_twist": [1.0, -0.5, -4.0],
        "half_distance": 0.1,
        "relative_error": 0.1,
        "out_of_plane": 0.0,
        "scored": True,
        "flags": [],
        "old": [0],
        "new": [1],
    }
    return {**usual, **given}


def landing(at: float, foot: str, time_error: float | None, **given: Any) -> dict[str, Any]:
    """The landing of a foot `at` ms, told with a time error in s."""
    feet = {
        "foot": foot,
        "point": None,
        "late": None,
        "confirmed": None,
        "time_error": time_error,
        "landing_speed": 0.1,
        "landing_mode": "STOP",
        "impulse": [3.0, 4.0],
        "velocity_change": [0.0, 0.0, 0.0],
    }
    usual = {"body": "base", "scored": False, "relative_error": None, "flags": ["DRIVEN"], "mode": "NO_IMPACT"}
    return touchdown(at, **{**usual, **feet, **given})


def true(at: float | None, mode: str | None, told: float | None, told_mode: str | None, **given: Any) -> dict[str, Any]:
    """A true touchdown `at` ms that was told for `told` ms; a false alarm without `at`, missed without `told`."""
    usual = {
        "body": "cube",
        "stamp": None if at is None else round(at * MS),
        "mode": mode,
        "first_seen": None if told is None else round((told - 60.0) * MS),
        "predicted_stamp": None if told is None else round(told * MS),
        "predicted_mode": told_mode,
        "velocity_error": None if at is None or told is None else 0.02,
        "shown": True,
    }
    return {**usual, **given}


def answer(bag: str = "run.mcap", **given: Any) -> dict[str, Any]:
    """What is said of a bag of ten samples in a second, of which one was refused."""
    usual = {
        "bag": bag,
        "samples": 10,
        "us_per_sample": 100.0,
        "touchdowns": [],
        "statuses": {"ACCEPTED": 9, "NOT_FINITE": 1},
        "geometry_statuses": {"ACCEPTED": 1},
        "begin": 0,
        "end": 1000 * MS,
        "cost_us": to_json(spread_of([10.0, 20.0, 20.0, 30.0, 300.0])),
        "relative_errors_ahead": ahead({0.0: [0.1, 0.3], 0.01: []}),
    }
    return {**usual, **given}


def ahead(errors: dict[float, list[float]]) -> list[dict[str, Any]]:
    """Errors ahead of touchdowns, in spans of 10 ms."""
    return [{"from": begin, "to": begin + 0.01} | to_json(spread_of(values)) for begin, values in errors.items()]


def gait() -> dict[str, Any]:
    """Two feet that stand in turns."""
    stances = [[0, 0, 400 * MS], [1, 300 * MS, 900 * MS], [0, 700 * MS, 1000 * MS]]
    return {"feet": ["left", "right"], "stances": stances, "true_stances": stances}


WALK = answer(
    "walk.bag",
    touchdowns=[
        landing(300, "right", 0.002, others_impulse=[5.0, 12.0]),
        landing(700, "left", -0.004),
        landing(900, "right", None),
    ],
    gaits={"": gait()},
)
TRUE = answer(
    "simulated.mcap",
    touchdowns=[touchdown(100), touchdown(500, mode="STOP", relative_error=0.3)],
    true_touchdowns=[
        true(100, "PIVOT", 101, "PIVOT"),
        true(500, "SLIDE", 500, "STOP"),
        true(700, "PIVOT", None, None, velocity_error=None),
        true(None, None, 800, "STOP"),
        true(900, "PIVOT", 900, "STOP", shown=False, velocity_error=None),
    ],
    truth={
        "touchdowns": 3,
        "missed": 1,
        "false": 1,
        "unresolved": 1,
        "median_time_error": 0.0005,
    },
    time_errors_ahead=ahead({0.02: [0.001, 0.003]}),
)
TOSSES = answer(
    "tosses.mcap",
    touchdowns=[
        touchdown(100),
        touchdown(300, mode="STOP", relative_error=0.2, measured_twist=[0.5, 0.1, -2.0]),
        touchdown(400, scored=False, relative_error=None, measured_twist=None, flags=["TOO_SLOW"]),
    ],
)
UNREADABLE = {"bag": "broken.mcap", "error": "broken.mcap cannot be read: it is empty"}
