"""The typed messages of `~/prediction` and `~/score`, made of the tables of `fields`."""

from __future__ import annotations

from operator import itemgetter
from typing import Any, Final

from ...mechanics.types import ContactState, Flag, Mode
from ...prediction.types import Bound, Covariance, Leftover, Prediction, Status
from ...stamps import NANOSECONDS
from .fields import FOOT, LANDING, MARGINS, PREDICTION, SCORE, TOUCHDOWN, UNCERTAINTY
from .kinds import CHOICE, HEADER, INDEX, NUMBER, POINT, POSE, STAMP, TEXT, TRUTH, TWIST_WITH_COVARIANCE, VECTOR, field
from .message import Message, MessageSection, fields_of
from .outputs import frame_of


def _header(prediction: Prediction) -> tuple[int, str]:
    return prediction.sample.stamp, frame_of(prediction)


def stamp_of(prediction: Prediction) -> int | None:
    """When the touchdown is expected, in ns."""
    touchdown = prediction.touchdown
    return None if touchdown is None else prediction.sample.stamp + round(touchdown.lead_time * NANOSECONDS)


def _deviation(prediction: Prediction) -> float | None:
    """That of the foot which lands first, of a machine for which a touchdown is ahead."""
    landing = [(foot.lead_time, foot) for foot in prediction.feet if foot.lead_time is not None]
    return min(landing, key=itemgetter(0))[1].landing_deviation if landing and prediction.touchdown else None


def _pose(prediction: Prediction) -> tuple[Any, ...] | None:
    touchdown = prediction.touchdown
    if touchdown is None:
        return None
    return touchdown.position, touchdown.orientation, (prediction.relative or prediction.sample).pose_covariance


def _twist(prediction: Prediction) -> tuple[Any, ...] | None:
    touchdown = prediction.touchdown
    if touchdown is None:
        return None
    told = prediction.sample if touchdown.uncertainty is None else touchdown.uncertainty
    return touchdown.linear, touchdown.angular, told.twist_covariance


CONTACT: Final = Message(
    "Contact",
    "What an impact does at a contact point. Axes are those of header.frame_id.",
    MessageSection(
        "",
        0,
        {
            "position": field("position", POINT, "m", "of the point at the touchdown"),
            "normal": field("normal", VECTOR, "1", "unit normal out of the support there"),
            "impulse": field("impulse", VECTOR, "N s", "on the body"),
            "velocity": field("velocity", VECTOR, "m/s", "of the point right after, relative to the support"),
            "lift_probability": field("lift_probability", NUMBER, "1", "that it leaves, with uncertainty.samples"),
            "point": field("point", INDEX, "", "its index in the contact geometry"),
            "is_new": field("is_new", TRUTH, "", "whether it strikes; else it stood"),
            "state": field("state", CHOICE, "", "what it does right after: STATE_*"),
        },
    ),
    constants={"STATE": ContactState},
)

FOOT_STATE: Final = Message(
    "FootState",
    "A foot of a walking machine as one sample shows it. Axes are those of header.frame_id of the Prediction.",
    MessageSection(
        "",
        0,
        fields_of(FOOT, "name", "stands", "confirmed", "bound", "since")
        | {"position": field("position", POINT, "m", "of its lowest point")}
        | fields_of(FOOT, "gap", "approach"),
    ),
    MessageSection(
        "Its landing",
        0,
        fields_of(
            FOOT, "lead_time", "landing_deviation", "landing_speed", "lands", "strikes", "late", "place", "impulse"
        ),
    ),
)

_OF_PLANE: Final = "half_distance", "off_axis", "lateral", "closing_spread", "offset"
"""Of the impact plane, in a prediction as in a score."""

_MOVES: Final = "mass centre, relative to the support, along the axes of header.frame_id"

PREDICTION_MESSAGE: Final = Message(
    "Prediction",
    "The answer to one sample: the touchdown ahead, if there is one within the horizon, and the impact it makes.\n\n"
    "With mode MODE_NO_IMPACT there is none: its numbers are NaN, its stamp and choices 0. Otherwise, too, a number\n"
    "that nobody knows is NaN. Over a moving support header.frame_id is that of the support, in which all is told.\n"
    "A status is one of STATUS_*, and so are mode, covariance and bound; flags and leftover are sums of such numbers.",
    MessageSection(
        "The sample",
        0,
        {
            "header": field("header", HEADER, "", "stamp of the sample: the key of all that is told of it", _header),
            "body": field("body", TEXT, "", "child_frame_id of the sample", "sample.child_frame_id"),
        }
        | fields_of(PREDICTION, "status", "mode"),
    ),
    MessageSection(
        "The touchdown", 0, {"touchdown": field("touchdown", STAMP, "", "when; the stamp of ~/post_impact", stamp_of)}
    ),
    MessageSection("", 1, fields_of(TOUCHDOWN, "lead_time")),
    MessageSection(
        "",
        0,
        {
            "lead_time_deviation": field(
                "lead_time_deviation", NUMBER, "s", "standard deviation of lead_time, where feet land", _deviation
            ),
            "pose": field("pose", POSE, "", "of the body's frame then, with the covariance of the sample", _pose),
            "twist": field(
                "twist",
                TWIST_WITH_COVARIANCE,
                "m/s, rad/s",
                "right after the impact as in nav_msgs/Odometry: of the body's frame along its own axes; covariance of "
                "the sample, with uncertainty.samples of what follows from it",
                _twist,
            ),
        },
    ),
    MessageSection(
        "",
        1,
        {
            "before": TOUCHDOWN.fields["before_6d"]._replace(meaning=f"right before the impact: {_MOVES}"),
            "after": TOUCHDOWN.fields["after_6d"]._replace(meaning=f"right after the impact: {_MOVES}"),
        }
        | fields_of(TOUCHDOWN, "energy_lost", "flags", "leftover", "unique"),
    ),
    MessageSection(
        "The impact plane",
        1,
        fields_of(TOUCHDOWN, "axis", planar_before="before", planar_after="after", planar_impulse="impulse")
        | fields_of(TOUCHDOWN, *_OF_PLANE),
    ),
    MessageSection(
        "How sure it is, with uncertainty.samples",
        2,
        fields_of(
            UNCERTAINTY,
            "covariance",
            mode_probabilities="probability",
            planar_mean="mean",
            planar_deviation="deviation",
        ),
    ),
    MessageSection(
        "How far it is from another mode, with margins: true",
        3,
        {f"margin_{key.removeprefix('margin.')}": one for key, one in MARGINS.fields.items()},
    ),
    MessageSection("A walking machine", 1, fields_of(TOUCHDOWN, "bound", "trunk", drives_impulse="impulse.drives")),
    MessageSection(
        "Contacts; the law in the plane knows but the old and the new one, and leaves contacts empty",
        1,
        fields_of(TOUCHDOWN, "law", "kind", "segments", old_points="old", new_points="new")
        | {"contacts": field("contacts", CONTACT.elements, "", "the points that take part")},
    ),
    MessageSection("", 0, {"feet": field("feet", FOOT_STATE.elements, "", "of a walking machine")}),
    MessageSection("", 1, fields_of(TOUCHDOWN, "joints", "joint_jumps")),
    constants={
        "STATUS": Status,
        "MODE": Mode,
        "FLAG": Flag,
        "LEFTOVER": Leftover,
        "COVARIANCE": Covariance,
        "BOUND": Bound,
    },
)

SCORE_MESSAGE: Final = Message(
    "Score",
    "A touchdown that has happened, predicted against measured. Constants are those of Prediction.\n\n"
    "A number that nobody knows is NaN.",
    MessageSection(
        "Which touchdown",
        0,
        {
            "header": field("header", HEADER, "", "stamp of the sample that settled it", _header),
            "body": field("body", TEXT, "", "child_frame_id of the sample", "sample.child_frame_id"),
        },
    ),
    MessageSection(
        "",
        1,
        fields_of(SCORE, touchdown="stamp")
        | {"sample": field("sample", STAMP, "", "header.stamp of the Prediction that is scored, 0 without one")}
        | fields_of(SCORE, "mode", "flags", "scored", "leftover", "leftover_6d", "announced", "lead_time"),
    ),
    MessageSection(
        "The whole twist",
        1,
        fields_of(
            SCORE,
            "time_error",
            before="before_6d",
            predicted="predicted_6d",
            measured="measured_6d",
            relative_error="relative_error_6d",
            simple_errors="simple_errors_6d",
            old_lift="lift.old",
            new_lift="lift.new",
        ),
    ),
    MessageSection(
        "The impact plane",
        1,
        fields_of(
            SCORE,
            planar_before="before",
            planar_predicted="predicted",
            planar_measured="measured",
            planar_relative_error="relative_error",
        )
        | fields_of(SCORE, *_OF_PLANE),
    ),
    MessageSection(
        "Of a foot that has landed",
        2,
        fields_of(
            LANDING,
            "late",
            "confirmed",
            "speed",
            "bound",
            landing_time_error="time_error",
            landing_impulse="impulse",
            foot="foot",
            foot_point="point",
        ),
    ),
    MessageSection("Contacts", 1, fields_of(SCORE, "law", "kind", old_points="old", new_points="new")),
)


def encode_typed_prediction(prediction: Prediction) -> bytes:
    """An impact_predictor_msgs/Prediction: what `encode_prediction` tells, and where."""
    touchdown = prediction.touchdown
    if touchdown is None:
        return PREDICTION_MESSAGE.encode(prediction, None, None, None)
    margins = None if touchdown.planar is None else touchdown.planar.margins
    return PREDICTION_MESSAGE.encode(prediction, touchdown, touchdown.uncertainty, margins)


def encode_typed_score(prediction: Prediction) -> bytes | None:
    """An impact_predictor_msgs/Score of the touchdown that the sample settled, or None where it settled none."""
    score = prediction.score
    return None if score is None else SCORE_MESSAGE.encode(prediction, score, score.landing)
