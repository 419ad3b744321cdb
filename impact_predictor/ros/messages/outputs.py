"""What the predictor says about one body: nav_msgs/Odometry, std_msgs/UInt8 and diagnostic_msgs/DiagnosticArray."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib.util import find_spec
from typing import TYPE_CHECKING, Final, NamedTuple

from ...mechanics.types import Flag, Mode
from ...prediction.checks import with_motion
from ...prediction.types import Foot, Landing, Leftover, Prediction, Score, Status
from ...stamps import NANOSECONDS
from ..cdr import LITTLE_ENDIAN_HEADER, OK, WARN, StatusBytes, diagnostic_array, diagnostic_status, pairs_of
from .fields import FOOT, LANDING, MARGINS, PREDICTION, SCORE, TOUCHDOWN, UNCERTAINTY
from .inputs import ODOMETRY, encode_odometry
from .kinds import PACKAGE, text

if TYPE_CHECKING:
    from ...prediction.watch.watch import Report

NODE: Final = "impact_predictor"
"""The name of the node, which begins those of its units."""

UINT8: Final = "std_msgs/msg/UInt8"
DIAGNOSTIC_ARRAY: Final = "diagnostic_msgs/msg/DiagnosticArray"
MARKER_ARRAY: Final = "visualization_msgs/msg/MarkerArray"


def encode_post_impact(prediction: Prediction) -> bytes | None:
    """A nav_msgs/Odometry of the body right after the predicted touchdown, or None where there is none.

    Stamped with the touchdown; frames and covariances are those of the sample, but that of the twist is carried through
    the impact where the scene asks for it. Over a moving support, too, it is in the frame of the sample.
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
    stamp = sample.stamp + round(touchdown.lead_time * NANOSECONDS)
    after = with_motion(sample, stamp, sample.frame_id, position, orientation, linear, angular)
    if uncertainty is not None:
        after = after._replace(twist_covariance=uncertainty.twist_covariance)
    return encode_odometry(after)


# Padded to four bytes, as DDS does, so that a bag holds what a topic carried.
_MODES: Final = tuple(LITTLE_ENDIAN_HEADER + bytes((mode, 0, 0, 0)) for mode in sorted(Mode))


def encode_mode(prediction: Prediction) -> bytes:
    """A std_msgs/UInt8 with the number of the mode; NO_IMPACT where no touchdown lies within the horizon."""
    touchdown = prediction.touchdown
    return _MODES[Mode.NO_IMPACT if touchdown is None else touchdown.mode]


_FAILURES: Final = int(
    Flag.ENERGY_GAINED | Flag.LAST_RESORT | Flag.NO_SOLUTION | Flag.INVALID_INPUT | Flag.NOT_CONVERGED
)
"""Flags of an answer that somebody should look at; the others tell of what happens, or how sure that is."""


def encode_prediction(prediction: Prediction) -> bytes:
    """A diagnostic_msgs/DiagnosticArray with everything about the answer to one sample, stamped like the sample.

    The tables of `fields` have its keys: PREDICTION, with a touchdown TOUCHDOWN, UNCERTAINTY and MARGINS where the
    scene asks for them, and FOOT in a status for each foot of a walking machine. The level is WARN where the law
    failed.
    """
    sample, touchdown = prediction.sample, prediction.touchdown
    pairs: list[bytes] = []
    PREDICTION.add_to(pairs, prediction)
    if touchdown is None:
        accepted = prediction.status is Status.ACCEPTED
        level = OK if accepted else WARN
        message = "no touchdown within the horizon" if accepted else f"sample refused: {text(prediction.status)}"
    else:
        # As integers: what & makes of two flags is a flag again, which takes longer.
        level = WARN if int(touchdown.flags) & _FAILURES else OK
        message = f"{text(touchdown.mode)} in {touchdown.lead_time * 1e3:.1f} ms"
        TOUCHDOWN.add_to(pairs, touchdown)
        if touchdown.uncertainty is not None:
            UNCERTAINTY.add_to(pairs, touchdown.uncertainty)
        if touchdown.planar is not None:
            MARGINS.add_to(pairs, touchdown.planar.margins)
    first = diagnostic_status(level, "impact_predictor/prediction", message, sample.child_frame_id, pairs)
    return diagnostic_array(sample.stamp, frame_of(prediction), [first, *map(_foot_status, prediction.feet)])


def frame_of(prediction: Prediction) -> str:
    """The frame of what is told of an answer: over a moving support its own, else that of the sample."""
    return (prediction.relative or prediction.sample).frame_id


def _foot_status(foot: Foot) -> StatusBytes:
    """A foot, whose name is the hardware, too; the level is WARN where its force sensor does not agree."""
    message = "stands" if foot.stands else "swings"
    if not foot.stands and foot.lead_time is not None:
        message += f", lands in {foot.lead_time * 1e3:.1f} ms"
    level = OK
    if foot.confirmed is False:
        level, message = WARN, f"{message}, but its force sensor does not agree"
    pairs: list[bytes] = []
    FOOT.add_to(pairs, foot)
    return diagnostic_status(level, f"{NODE}/foot/{foot.name}", message, foot.name, pairs)


def encode_score(prediction: Prediction) -> bytes | None:
    """A diagnostic_msgs/DiagnosticArray of the touchdown that the sample settled, or None where it settled none.

    Stamped, like its post-impact state, with the predicted touchdown. The tables SCORE and LANDING of `fields` have its
    keys. The level is WARN where the force sensor of a foot that has landed does not agree.
    """
    score = prediction.score
    if score is None:
        return None
    pairs: list[bytes] = []
    SCORE.add_to(pairs, score)
    message, level = _score_message(score), OK
    landing = score.landing
    if landing is not None:
        LANDING.add_to(pairs, landing)
        message = f"{_landing_message(landing)}: {message}"
        level = WARN if landing.confirmed is False else OK
    sample = prediction.sample
    status = diagnostic_status(level, "impact_predictor/score", message, sample.child_frame_id, pairs)
    return diagnostic_array(score.stamp, frame_of(prediction), [status])


def _score_message(score: Score) -> str:
    announced = f"{text(score.touchdown.mode)} predicted {score.touchdown.lead_time * 1e3:.1f} ms ahead"
    in_plane = _comparison(score.relative_error, score.leftover)
    if score.leftover_6d is Leftover.MOVING_CONTACTS:
        return f"{announced}, {in_plane}"
    whole = _comparison(None if score.spatial is None else score.spatial.error, score.leftover_6d)
    return f"{announced}; by the whole twist {whole}; in the impact plane {in_plane}"


def _comparison(error: float | None, leftover: Leftover) -> str:
    said = "nothing to compare" if error is None else f"error {error:.3f}"
    return f"{said}, not scored: {text(leftover)}" if leftover else said


def _landing_message(landing: Landing) -> str:
    """Which foot has landed, and how well that was foretold."""
    name = f"{landing.foot} {landing.point or ''}".rstrip()
    if not landing.history:
        return f"{name} has landed, which was not announced"
    return f"{name} has landed, time error {landing.history[-1][1] * 1e3:.1f} ms"


def encode_reports(reports: Iterable[Report], nanoseconds: int, node: str = NODE, deck: Report | None = None) -> bytes:
    """A diagnostic_msgs/DiagnosticArray with one status for each unit that a node watches and one for the deck, stamped
    in ns.
    """
    return diagnostic_array(nanoseconds, "", report_statuses(reports, deck, node))


def report_statuses(reports: Iterable[Report], deck: Report | None, node: str = NODE) -> list[StatusBytes]:
    """The statuses of the units under watch, and of the deck that carries them: level, what was exceeded, and values;
    the hardware is the body.
    """
    named = [(f"unit/{one.body}" if one.body else "unit", one) for one in reports]
    named += [] if deck is None else [("deck", deck)]
    return [
        diagnostic_status(one.level, f"{node}/{name}", one.message, one.body, pairs_of(one.values))
        for name, one in named
    ]


class Output(NamedTuple):
    """What is published on one topic: the type of its messages, their bytes, or None for an answer without one, and the
    field of a prediction without which there is none.
    """

    type_name: str
    encode: Callable[[Prediction], bytes | None]
    needs: str


OUTPUTS: Final[dict[str, Output]] = {
    "post_impact": Output(ODOMETRY, encode_post_impact, "touchdown"),
    "mode": Output(UINT8, encode_mode, "sample"),
    "prediction": Output(DIAGNOSTIC_ARRAY, encode_prediction, "sample"),
    "score": Output(DIAGNOSTIC_ARRAY, encode_score, "score"),
}
"""Every output, as strings, by the last part of its topic, in the order in which they are published."""


def is_typed(messages: str) -> bool:
    """Whether the parameter `messages` asks for typed ones: auto does where their package can be imported."""
    # A folder of that name, as in a clone, is no package and has no origin.
    found = find_spec(PACKAGE) if messages == "auto" else None
    return messages == "typed" or (found is not None and found.origin is not None)


def outputs_of(messages: str) -> Mapping[str, Output]:
    """The outputs, as the parameter `messages` asks for them."""
    if not is_typed(messages):
        return OUTPUTS
    from .typed import PREDICTION_MESSAGE, SCORE_MESSAGE, encode_typed_prediction, encode_typed_score

    return OUTPUTS | {
        "prediction": Output(PREDICTION_MESSAGE.type_name, encode_typed_prediction, "sample"),
        "score": Output(SCORE_MESSAGE.type_name, encode_typed_score, "score"),
    }
