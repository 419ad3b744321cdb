"""What the predictor says about one body: nav_msgs/Odometry, std_msgs/UInt8 and diagnostic_msgs/DiagnosticArray."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache
from typing import Final, NamedTuple

from ...mechanics.types import Flag, Mode
from ...prediction.types import Leftover, Prediction, Sample, Score, Status, Touchdown
from ...stamps import NANOSECONDS
from ..cdr import LITTLE_ENDIAN_HEADER, OK, WARN, DiagnosticForm, diagnostic_array
from .inputs import ODOMETRY, encode_odometry

UINT8: Final = "std_msgs/msg/UInt8"
DIAGNOSTIC_ARRAY: Final = "diagnostic_msgs/msg/DiagnosticArray"
MARKER_ARRAY: Final = "visualization_msgs/msg/MarkerArray"


def encode_post_impact(prediction: Prediction) -> bytes | None:
    """A nav_msgs/Odometry of the body right after the predicted touchdown, or None where there is none.

    Stamped with the touchdown; frames and covariances are those of the sample, but that of the twist is carried through
    the impact where the scene asks for it. So what is predicted in the frame of a moving support is told in that of the
    sample.
    """
    touchdown = prediction.touchdown
    if touchdown is None:
        return None
    sample, uncertainty = prediction.sample, touchdown.uncertainty
    state = touchdown.position, touchdown.orientation, touchdown.linear, touchdown.angular
    if prediction.support is not None:
        from ...prediction.deck.frame import post_impact  # only where the support moves

        state = post_impact(prediction)
    position, orientation, linear, angular = state
    return encode_odometry(
        Sample(
            sample.stamp + round(touchdown.lead_time * NANOSECONDS),
            sample.frame_id,
            sample.child_frame_id,
            position,
            orientation,
            linear,
            angular,
            sample.pose_covariance,
            sample.twist_covariance if uncertainty is None else uncertainty.twist_covariance,
        )
    )


# Padded to four bytes, as DDS does, so that a bag holds what a topic carried.
_MODES: Final = tuple(LITTLE_ENDIAN_HEADER + bytes((mode, 0, 0, 0)) for mode in sorted(Mode))


def encode_mode(prediction: Prediction) -> bytes:
    """A std_msgs/UInt8 with the number of the mode; NO_IMPACT where no touchdown lies within the horizon."""
    touchdown = prediction.touchdown
    return _MODES[Mode.NO_IMPACT if touchdown is None else touchdown.mode]


_DOUBTFUL_ON_FEET: Final = Flag.JAMMED | Flag.ENERGY_GAINED | Flag.LAST_RESORT | Flag.NO_SOLUTION | Flag.INVALID_INPUT
"""Feet that land together are how a machine trots; any other body has its reasons to strike twice at once."""
_DOUBTFUL_FLAGS: Final = _DOUBTFUL_ON_FEET | Flag.BOTH_STRUCK
_DOUBTFUL_LEFTOVERS: Final = Leftover.OUT_OF_PLANE | Leftover.ONE_CORNER_FIRST | Leftover.TOO_SLOW

_MODE_NAMES: Final = tuple(mode.name for mode in sorted(Mode))
_STATUS_NAMES: Final = tuple(status.name for status in sorted(Status))


@lru_cache(maxsize=256, typed=True)
def _names(flags: Flag | Leftover) -> str:
    return "|".join(flag.name or "" for flag in type(flags) if flag & flags) or "NONE"


_NO_TOUCHDOWN: Final = DiagnosticForm("impact_predictor/prediction", "status", "stamp", "mode")
_TOUCHDOWN_KEYS: Final = (
    *("status", "stamp", "mode", "law", "unique", "flags", "leftover", "segments", "old", "new", "lead_time"),
    *("before.vx", "before.vy", "before.omega", "after.vx", "after.vy", "after.omega", "energy_lost"),
    *("impulse.old.normal", "impulse.old.tangent", "impulse.new.normal", "impulse.new.tangent"),
    *("axis.x", "axis.y", "axis.z", "half_distance", "off_axis", "lateral", "closing_spread", "offset"),
)


@cache
def _touchdown_form(uncertainty: bool, margins: bool) -> DiagnosticForm:
    keys: tuple[str, ...] = _TOUCHDOWN_KEYS
    if uncertainty or margins:
        from ..confidence import MARGIN_KEYS, UNCERTAINTY_KEYS

        keys += (UNCERTAINTY_KEYS if uncertainty else ()) + (MARGIN_KEYS if margins else ())
    return DiagnosticForm("impact_predictor/prediction", *keys)


def encode_prediction(prediction: Prediction) -> bytes:
    """A diagnostic_msgs/DiagnosticArray with everything about the answer to one sample, stamped like the sample.

    Its keys are the fields of `Touchdown` and have their units; `stamp` is the sample's in ns; contact indices are
    separated by spaces, flags by "|", segments by spaces; every number reads back as the same double. Where the scene
    asks for them, keys of `confidence` follow. Without a touchdown only `status`, `stamp` and `mode` are there. The
    level is WARN where the answer deserves less trust. A status for each foot of a walking machine follows.
    """
    sample = prediction.sample
    touchdown = prediction.touchdown
    status = _STATUS_NAMES[prediction.status]
    if touchdown is None:
        form = _NO_TOUCHDOWN
        accepted = prediction.status is Status.ACCEPTED
        level = OK if accepted else WARN
        message = "no touchdown within the horizon" if accepted else f"sample refused: {status}"
        values = [status, str(sample.stamp), Mode.NO_IMPACT.name]
    else:
        form = _touchdown_form(touchdown.uncertainty is not None, touchdown.planar is not None)
        level = WARN if _is_doubtful(touchdown, _DOUBTFUL_ON_FEET if prediction.feet else _DOUBTFUL_FLAGS) else OK
        message = f"{_MODE_NAMES[touchdown.mode]} in {touchdown.lead_time * 1e3:.1f} ms"
        values = [status, str(sample.stamp), *_touchdown_values(touchdown)]
        if touchdown.uncertainty is not None or touchdown.planar is not None:
            from ..confidence import margin_values, uncertainty_values  # only where the scene asks for it

            values += uncertainty_values(touchdown) + margin_values(touchdown)
    if prediction.feet:
        from .feet import statuses_of  # only where the scene has them

        first = form.status(level, message, sample.child_frame_id, values)
        return diagnostic_array(sample.stamp, sample.frame_id, [first, *statuses_of(prediction.feet)])
    return form.fill(sample.stamp, sample.frame_id, level, message, sample.child_frame_id, values)


def _is_doubtful(touchdown: Touchdown, flags: Flag) -> bool:
    return bool(not touchdown.unique or touchdown.flags & flags or touchdown.leftover & _DOUBTFUL_LEFTOVERS)


def _touchdown_values(touchdown: Touchdown) -> list[str]:
    numbers = [
        touchdown.lead_time,
        *touchdown.before,
        *touchdown.after,
        touchdown.energy_lost,
        *touchdown.impulses[0],
        *touchdown.impulses[1],
        *touchdown.axis,
        touchdown.half_distance,
        touchdown.off_axis,
        touchdown.lateral,
        touchdown.closing_spread,
        touchdown.offset,
    ]
    return [
        _MODE_NAMES[touchdown.mode],
        touchdown.law,
        "true" if touchdown.unique else "false",
        _names(touchdown.flags),
        _names(touchdown.leftover),
        " ".join(touchdown.segments),
        " ".join(map(str, touchdown.old)),
        " ".join(map(str, touchdown.new)),
        *map(_text, numbers),
    ]


_SCORE_KEYS: Final = (
    *("stamp", "mode", "scored", "leftover", "flags", "law", "old", "new", "announced", "lead_time", "half_distance"),
    *("off_axis", "lateral", "closing_spread", "offset"),
    *("before.vx", "before.vy", "before.omega", "predicted.vx", "predicted.vy", "predicted.omega"),
)
_MEASURED_KEYS: Final = ("measured.vx", "measured.vy", "measured.omega")


@cache
def _score_form(*more_keys: str) -> DiagnosticForm:
    return DiagnosticForm("impact_predictor/score", *_SCORE_KEYS, *more_keys)


def encode_score(prediction: Prediction) -> bytes | None:
    """A diagnostic_msgs/DiagnosticArray of the touchdown that the sample settled, or None where it settled none.

    Stamped, like its post-impact state, with the predicted touchdown. Keys and units as in `encode_prediction`;
    `announced` is the time in s before the touchdown of the first prediction with its contacts; the measured twist and
    the relative error are left out where there is none. More keys tell of a foot that has landed. The level is WARN
    where it is not scored, or where the force sensor of a foot that has landed does not agree.
    """
    score = prediction.score
    if score is None:
        return None
    touchdown, landing = score.touchdown, score.landing
    history, is_trusted, message = score.history, score.scored, _score_message(score)
    more: dict[str, str] = {}
    if score.measured is not None:
        more = dict(zip(_MEASURED_KEYS, map(_text, score.measured), strict=True))
    if score.relative_error is not None:
        more["relative_error"] = _text(score.relative_error)
    if landing is not None:
        from .feet import landing_in_words, landing_values  # only where the scene has feet

        more |= landing_values(landing)
        history, is_trusted = landing.history, landing.confirmed is not False
        message = f"{landing_in_words(landing)}: {message}"
    numbers = (
        history[0][0] if history else touchdown.lead_time,
        touchdown.lead_time,
        touchdown.half_distance,
        touchdown.off_axis,
        touchdown.lateral,
        touchdown.closing_spread,
        touchdown.offset,
        *touchdown.before,
        *touchdown.after,
    )
    values = [
        str(score.stamp),
        _MODE_NAMES[touchdown.mode],
        "true" if score.scored else "false",
        _names(score.leftover),
        _names(touchdown.flags),
        touchdown.law,
        " ".join(map(str, touchdown.old)),
        " ".join(map(str, touchdown.new)),
        *map(_text, numbers),
        *more.values(),
    ]
    level = OK if is_trusted else WARN
    sample = prediction.sample
    return _score_form(*more).fill(score.stamp, sample.frame_id, level, message, sample.child_frame_id, values)


def _text(number: float) -> str:
    return repr(float(number))


def _score_message(score: Score) -> str:
    announced = f"{_MODE_NAMES[score.touchdown.mode]} predicted {score.touchdown.lead_time * 1e3:.1f} ms ahead"
    error = "nothing to compare" if score.relative_error is None else f"error {score.relative_error:.3f}"
    return f"{announced}, {error}" + ("" if score.scored else f", not scored: {_names(score.leftover)}")


class Output(NamedTuple):
    """What is published on one topic: the type of its messages, and their bytes or None for an answer without one."""

    type_name: str
    encode: Callable[[Prediction], bytes | None]


OUTPUTS: Final[dict[str, Output]] = {
    "post_impact": Output(ODOMETRY, encode_post_impact),
    "mode": Output(UINT8, encode_mode),
    "prediction": Output(DIAGNOSTIC_ARRAY, encode_prediction),
    "score": Output(DIAGNOSTIC_ARRAY, encode_score),
}
"""Every output of the predictor by the last part of its topic, in the order in which they are published."""
