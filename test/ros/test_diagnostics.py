from math import hypot

import pytest
from test_feet_messages import SCORE
from test_score import only_score
from test_spatial_score import HALF, TOSS, falling, gone_on, samples_of, told_after

from impact_predictor.mechanics.types import Flag, Mode, Twist
from impact_predictor.native import form
from impact_predictor.prediction.checks import REMEDIES
from impact_predictor.prediction.types import Leftover, Score, SpatialTwist, Status, Touchdown
from impact_predictor.ros.cdr import ERROR, OK, WARN, decode_diagnostic_array, diagnostic_array
from impact_predictor.ros.diagnostics import Diagnostics
from impact_predictor.ros.inputs import STALE_AFTER, InputReport, Misfit, Refusal
from impact_predictor.ros.latency import RECORDED

SECOND = 1_000_000_000
BAD = Refusal("odom", Status.NOT_FINITE)


@pytest.fixture
def diagnostics():
    return Diagnostics("impact_predictor", 0.0)


def accept(diagnostics, now, stamp=None, latency=0, update=50e-6, total=80e-6):
    return diagnostics.accepted(now, "odom", round(now * SECOND) if stamp is None else stamp, latency, update, total)


def report(diagnostics, now=0.0):
    (status,) = decode_diagnostic_array(diagnostic_array(0, "", [diagnostics.report(now)]))
    return status


def scored(error, is_scored=True):
    twist = Twist(0.0, 0.0, 0.0)
    zero = (0.0, 0.0, 0.0)
    touchdown = Touchdown(
        *(0.0, Mode.STOP, twist, twist, ((0.0, 0.0), (0.0, 0.0)), (), 0.0, Flag.NONE, True, "path", (), (0,)),
        *(zero, zero, (0.0, 0.0, 0.0, 1.0), zero, zero, 0.0, 0.0, 0.0, 0.0, 0.0, Leftover.NONE),
        *(SpatialTwist(zero, zero), SpatialTwist(zero, zero)),
    )
    return Score(0, touchdown, twist, error, is_scored, Leftover.NONE, ())


def test_before_the_first_sample_it_warns_and_says_whether_anybody_publishes(diagnostics):
    diagnostics.second_over(1.0)
    assert report(diagnostics).level == WARN
    assert report(diagnostics).message == "no sample yet: nobody publishes on odom"
    diagnostics.inputs.publishers["odom"] = 1
    diagnostics.second_over(2.0)
    assert report(diagnostics).message == "no sample yet"


ACCEPT, REFUSE, OVER = "accept", "refuse", "second over"
FIRST = (ACCEPT, 0.1, OK, True)


@pytest.mark.parametrize(
    "events",
    [
        # The first sample makes it ok at once, and later ones are no change.
        [FIRST, (ACCEPT, 0.2, OK, False)],
        # The first refused message is a warning at once, and the next is no change.
        [FIRST, (REFUSE, 0.2, WARN, True), (REFUSE, 0.3, WARN, False)],
        # A warning stays until a whole second went without a refused message.
        [FIRST, (REFUSE, 0.9, WARN, True), (OVER, 1.0, WARN, False), (ACCEPT, 1.1, WARN, False), (OVER, 2.0, OK, True)],
        # A second of nothing but refused messages is an error until a sample is accepted.
        [FIRST, (OVER, 1.0, OK, False), (REFUSE, 1.5, WARN, True), (OVER, 2.0, ERROR, True), (ACCEPT, 2.1, WARN, True)],
        # An input that stops is a warning.
        [FIRST, (OVER, 0.1 + STALE_AFTER, OK, False), (OVER, 2.0, WARN, True), (ACCEPT, 2.1, OK, True)],
    ],
    ids=["first sample", "first refusal", "lasting warning", "nothing but refusals", "silence"],
)
def test_the_level_follows_what_happens_and_a_change_is_told_at_once(diagnostics, events):
    for what, now, level, changed in events:
        if what == REFUSE:
            assert diagnostics.refused(now, BAD) == changed
        else:
            assert (accept(diagnostics, now) if what == ACCEPT else diagnostics.second_over(now)) == changed
        assert diagnostics.level == level


def test_an_error_names_the_reason_and_a_silence_its_length(diagnostics):
    accept(diagnostics, 0.5)
    diagnostics.second_over(2.0)
    assert report(diagnostics).message == "no sample for 1.5 s"
    diagnostics.refused(2.5, BAD)
    diagnostics.second_over(3.0)
    assert "nothing but refused messages (1); odom NOT_FINITE: a field is NaN" in report(diagnostics).message


def test_a_second_in_which_samples_were_dropped_is_a_warning_that_says_how_many_and_what_an_answer_takes(diagnostics):
    accept(diagnostics, 0.1, total=3e-3)
    diagnostics.dropped += 7
    assert diagnostics.second_over(1.0)
    assert diagnostics.level == WARN
    assert report(diagnostics).message.startswith("7 samples dropped in the last second")
    assert "of 3 ms each" in report(diagnostics).message
    accept(diagnostics, 1.05)
    assert diagnostics.second_over(2.0)
    assert report(diagnostics).values["samples.dropped"] == "7"
    assert diagnostics.level == OK


def test_samples_that_wait_for_the_geometry_are_a_warning_however_long_it_takes(diagnostics):
    for second in range(3):
        diagnostics.refused(second + 0.5, Refusal("odom", Status.NO_GEOMETRY))
        diagnostics.second_over(second + 1.0)
        assert diagnostics.level == WARN
    assert "publish them on contact_geometry or give body.contact_points" in report(diagnostics).message


def test_an_endpoint_that_qos_keeps_away_is_a_warning_that_names_it(diagnostics):
    diagnostics.inputs.misfits = [Misfit("QoS", "/odom", "/odom from driver: best effort")]
    accept(diagnostics, 0.1)
    diagnostics.second_over(1.0)
    assert diagnostics.level == WARN
    assert "/odom from driver: best effort" in report(diagnostics).message


def test_every_status_that_occurred_has_a_counter_for_its_input(diagnostics):
    for _ in range(3):
        diagnostics.refused(0.1, BAD)
    diagnostics.refused(0.2, Refusal("contact_geometry", Status.TOO_FEW_POINTS))
    diagnostics.second_over(1.0)
    diagnostics.refused(1.1, BAD)
    values = report(diagnostics).values
    counters = {key: value for key, value in values.items() if key.startswith("refused.")}
    assert counters == {"refused.contact_geometry.TOO_FEW_POINTS": "1", "refused.odom.NOT_FINITE": "4"}


def test_only_the_first_message_refused_for_a_reason_in_a_second_is_news(diagnostics):
    news = []
    for now in (0.1, 0.2, 1.1):
        if now > 1.0:
            diagnostics.second_over(1.0)
        diagnostics.refused(now, BAD)
        news.append(diagnostics.is_news(BAD))
    assert news == [True, False, True]


def test_every_status_but_accepted_says_where_to_look():
    assert REMEDIES.keys() == set(Status) - {Status.ACCEPTED}


def test_rate_gap_and_cost_are_those_of_the_second_that_is_over(diagnostics):
    for now, update in ((0.1, 40e-6), (0.2, 50e-6), (0.5, 900e-6), (0.6, 45e-6)):
        accept(diagnostics, now, update=update, total=2.0 * update)
    diagnostics.second_over(2.0)
    values = report(diagnostics, 2.0).values
    assert values["runs"] == form()
    assert values["samples.accepted"] == "4"
    assert values["samples.rate"] == "2.0"
    assert values["samples.largest_gap"] == "0.3000"
    assert values["samples.seconds_since_last"] == "1.400"
    assert values["cost_us.update.median"] == "47.5"
    assert values["cost_us.update.max"] == "900.0"
    assert values["cost_us.total.median"] == "95.0"
    diagnostics.second_over(3.0)
    assert "cost_us.update.median" not in report(diagnostics).values


@pytest.mark.parametrize(
    ("latency", "is_simulated", "level", "message"),
    [
        (0.002, False, OK, "predicting"),
        (-0.002, False, OK, "predicting"),
        (0.2, False, OK, "predicting"),
        (-3.0, False, WARN, "stamps on odom are 3.0 s ahead of this machine's clock, and predictions reach 0.25 s"),
        (-3600.0, False, WARN, "stamps on odom are 3,600.0 s ahead of this machine's clock"),
        (3.0, False, WARN, "stamps on odom are 3.0 s behind this machine's clock"),
        (RECORDED + 1.0, True, WARN, "stamps on odom are 61.0 s behind the simulated clock"),
        (-3.0, True, WARN, "stamps on odom are 3.0 s ahead of the simulated clock"),
    ],
)
def test_samples_older_than_predictions_reach_or_from_the_future_are_a_warning(latency, is_simulated, level, message):
    diagnostics = Diagnostics("impact_predictor", 0.0, horizon=lambda _: 0.25)
    diagnostics.latency.is_simulated = is_simulated
    accept(diagnostics, 0.9, latency=round(latency * SECOND))
    diagnostics.second_over(1.0)
    assert report(diagnostics).level == level
    assert report(diagnostics).message.startswith(message)
    assert float(report(diagnostics).values["samples.latency"]) == latency


def test_a_recording_that_is_played_is_no_warning_but_its_day_is_told():
    diagnostics = Diagnostics("impact_predictor", 0.0, horizon=lambda _: 0.25)
    accept(diagnostics, 0.9, stamp=1_500_000_000 * SECOND, latency=200_000_000 * SECOND)
    diagnostics.second_over(1.0)
    recorded = "stamps are of 2017-07-14 02:40 UTC, as those of a recording; if none is played set both clocks by one"
    assert (diagnostics.level, diagnostics.message) == (OK, f"predicting; {recorded}")
    assert "samples.latency" not in report(diagnostics).values


def test_a_clock_that_is_set_right_is_no_warning_any_more_and_silence_has_no_latency():
    diagnostics = Diagnostics("impact_predictor", 0.0, horizon=lambda _: 0.25)
    for now, latency, level in ((0.9, -3.0, WARN), (1.9, 0.001, OK)):
        accept(diagnostics, now, latency=round(latency * SECOND))
        diagnostics.second_over(now + 0.1)
        assert diagnostics.level == level
    diagnostics.second_over(2.5)
    assert "samples.latency" not in report(diagnostics).values


def test_touchdowns_are_counted_and_the_error_is_the_median_of_the_scored(diagnostics):
    for error, is_scored in ((0.05, True), (0.5, False), (0.07, True), (0.09, True)):
        diagnostics.settled("cube", scored(error, is_scored))
    values = report(diagnostics).values
    assert values["touchdowns"] == "4"
    assert values["touchdowns.scored"] == "3"
    assert values["touchdowns.median_relative_error"] == "0.0700"


def test_touchdowns_scored_by_the_whole_twist_have_a_count_and_a_median_beside_those_of_the_plane(diagnostics):
    toss = falling()
    for faster in (0.1, 0.3, 0.2):
        diagnostics.settled("cube", only_score(TOSS, samples_of(toss, gone_on(toss, told_after(toss), (faster, 0, 0)))))
    diagnostics.settled("cube", scored(0.05, is_scored=False))
    values = report(diagnostics).values
    assert (values["touchdowns"], values["touchdowns.scored_6d"], values["touchdowns.scored"]) == ("4", "3", "0")
    error = 0.2 / hypot(*toss.velocity, *(HALF * toss.spin))
    assert float(values["touchdowns.median_relative_error_6d"]) == pytest.approx(error, rel=1e-3)
    assert "touchdowns.median_relative_error" not in values


def test_of_landings_of_driven_feet_it_is_told_why_no_twist_of_them_is_scored(diagnostics):
    for _ in range(2):
        diagnostics.settled("dog", SCORE)
    values = report(diagnostics).values
    assert (values["touchdowns"], values["touchdowns.scored_6d"], values["touchdowns.scored"]) == ("2", "0", "0")
    assert values["touchdowns.not_scored"].startswith("2 landings of driven feet: ")
    cube = Diagnostics("impact_predictor", 0.0)
    cube.settled("cube", scored(0.05))
    assert "touchdowns.not_scored" not in report(cube).values


def test_of_several_inputs_the_one_that_is_missing_or_silent_is_named():
    diagnostics = Diagnostics("impact_predictor", 0.0, ["support/odom", "crate/odom"])
    diagnostics.inputs.publishers["support/odom"] = 1
    diagnostics.taken(0.1, "support/odom")
    diagnostics.second_over(0.2)
    assert report(diagnostics).message == "no sample yet on crate/odom: nobody publishes there"
    assert diagnostics.accepted(0.3, "crate/odom", 0, 0, 50e-6, 80e-6)
    assert diagnostics.level == OK
    diagnostics.taken(1.2, "support/odom")
    diagnostics.second_over(2.0)
    assert report(diagnostics).message == "no sample on crate/odom for 1.7 s"


def test_gaps_are_those_of_one_input_and_the_same_reason_on_several_is_news_once(diagnostics):
    for now, name in ((0.1, "a/odom"), (0.2, "b/odom"), (0.4, "a/odom"), (0.5, "b/odom")):
        diagnostics.accepted(now, name, round(now * SECOND), 0, 50e-6, 80e-6)
    diagnostics.second_over(1.0)
    assert report(diagnostics).values["samples.largest_gap"] == "0.3000"
    reasons = [Refusal(f"{body}/odom", Status.SUPPORT_STALE) for body in "ab"]
    assert [diagnostics.is_news(reason) for reason in reasons] == [True, False]


def test_what_was_refused_stays_an_error_with_its_reason_when_nothing_comes_any_more():
    diagnostics = Diagnostics("impact_predictor", 0.0, ["joint_states", "odom"])
    for now in (0.2, 0.4):
        diagnostics.taken(now, "joint_states")
        diagnostics.refused(now, BAD)
    for second in range(1, 10):
        diagnostics.second_over(float(second))
        assert diagnostics.level == ERROR
        assert "odom NOT_FINITE: a field is NaN" in diagnostics.message
    assert diagnostics.message.startswith("nothing but refused messages (2), the last 8.6 s ago; odom NOT_FINITE")
    assert diagnostics.message.endswith("; no sample on joint_states for 8.6 s")


def test_inputs_that_stop_are_all_named_and_are_an_error_once_nothing_was_predicted_for_long():
    diagnostics = Diagnostics("impact_predictor", 0.0, ["joint_states", "odom"])
    diagnostics.taken(0.1, "joint_states")
    accept(diagnostics, 0.2)
    levels = []
    for second in range(1, 8):
        diagnostics.second_over(float(second))
        levels.append(diagnostics.level)
    assert levels == [OK, *[WARN] * 4, ERROR, ERROR]
    assert diagnostics.message == "no sample on joint_states and odom for 6.9 s"


def test_an_input_that_stops_is_a_warning_as_long_as_predictions_go_on():
    diagnostics = Diagnostics("impact_predictor", 0.0, ["contact_wrench", "odom"])
    diagnostics.taken(0.1, "contact_wrench")
    for second in range(1, 10):
        accept(diagnostics, second - 0.1)
        diagnostics.second_over(float(second))
    assert (diagnostics.level, diagnostics.message) == (WARN, "no sample on contact_wrench for 8.9 s")


@pytest.mark.parametrize(("publishers", "level"), [(0, WARN), (1, ERROR)])
def test_what_never_came_is_an_error_where_somebody_publishes_and_a_warning_where_nobody_has_begun(publishers, level):
    diagnostics = Diagnostics("impact_predictor", 0.0, ["joint_states", "odom"])
    for name in diagnostics.inputs.publishers:
        diagnostics.inputs.publishers[name] = publishers
    for second in range(1, 10):
        diagnostics.second_over(float(second))
    nobody = "" if publishers else ": nobody publishes there"
    assert (diagnostics.level, diagnostics.message) == (level, f"no sample yet on joint_states and odom{nobody}")


@pytest.mark.parametrize(
    ("status", "blamed"),
    [
        ((Status.NO_GEOMETRY, "odom"), (Status.WRONG_JOINTS, "joint_states")),
        ((Status.NO_SUPPORT, "crate/odom"), (Status.GRAVITY_WRONG, "support/odom")),
        ((Status.SUPPORT_JUMPED, "crate/odom"), (Status.SUPPORT_JUMPED, "support/odom")),
    ],
)
def test_of_several_reasons_that_which_the_others_follow_from_is_told_however_often_they_come(status, blamed):
    diagnostics = Diagnostics("impact_predictor", 0.0, [status[1], blamed[1]])
    for one, name in (status, status, blamed):
        diagnostics.refused(0.5, Refusal(name, one))
    diagnostics.second_over(1.0)
    assert diagnostics.message.startswith(f"nothing but refused messages (3); {blamed[1]} {blamed[0].name}: ")
    assert diagnostics.level == ERROR


def test_types_and_qos_that_do_not_match_are_named_and_counted(diagnostics):
    said = "driver publishes sensor_msgs/msg/JointState on /odom, where nav_msgs/msg/Odometry is wanted"
    diagnostics.inputs.misfits = [Misfit("type", "/odom", said), Misfit("QoS", "/mode", "is best effort")]
    diagnostics.second_over(1.0)
    assert diagnostics.message == f"type does not match (1): {said}; no sample yet: nobody publishes on odom"
    assert [report(diagnostics).values[f"incompatible_{kind}"] for kind in ("qos", "type")] == ["1", "1"]


TOPICS = {name: f"/dog/{name}" for name in ("joint_states", "odom")}


def silences(inputs, topics, now=6.0):
    """What is said once of inputs, and not again a second later."""
    said = inputs.fallen_silent(now, topics)
    assert inputs.fallen_silent(now + 1.0, topics) == []
    return said


def test_where_all_messages_are_refused_the_log_says_so_with_their_number_and_the_last_reason():
    inputs = InputReport([*TOPICS], 0.0)
    for _ in range(1000):
        inputs.refused(2.0, Refusal("odom", Status.BAD_QUATERNION), "")
    inputs.refused(3.0, Refusal("odom", Status.WRONG_FRAME), "frame_id is 'map', but 'odom' is wanted")
    inputs.accepted(4.0, "joint_states")
    (said,) = silences(inputs, TOPICS)
    assert said == (
        "nothing but refused messages has come on /dog/odom for 5 s (1,001): "
        "WRONG_FRAME: frame_id is 'map', but 'odom' is wanted"
    )


def test_where_nothing_comes_the_log_says_once_for_all_such_inputs_whether_it_is_qos_a_type_or_nobody():
    inputs = InputReport([*TOPICS], 0.0)
    nobody = "nothing has come on /dog/joint_states and /dog/odom for 5 s: nobody publishes there"
    assert silences(inputs, TOPICS) == [nobody]
    inputs = InputReport([*TOPICS], 0.0)
    inputs.publishers["odom"] = 1
    inputs.misfits = [Misfit("type", "/dog/odom", "driver publishes strings")]
    assert silences(inputs, TOPICS) == [
        "nothing has come on /dog/joint_states for 5 s: nobody publishes there",
        "nothing has come on /dog/odom for 5 s: driver publishes strings",
    ]


@pytest.mark.parametrize("is_accepted", [False, True], ids=["refused too", "trusted now and then"])
def test_of_bodies_that_are_refused_for_the_sake_of_their_support_the_log_says_one_sentence(is_accepted):
    names = ["support/odom", *[f"crate{k}/odom" for k in range(30)]]
    inputs, topics = InputReport(names, 0.0), {name: f"/{name}" for name in names}
    for name in names:
        inputs.refused(3.0, Refusal(name, Status.SUPPORT_JUMPED), "")
    if is_accepted:
        inputs.accepted(3.0, "support/odom")
    where = "/crate0/odom, /crate1/odom, /crate10/odom, /crate11/odom and 26 more for 5 s (30) because of /support/odom"
    (said,) = silences(inputs, topics)
    assert said.startswith(
        f"nothing but refused messages has come on {where if is_accepted else '/support/odom for 5 s (1)'}: "
        "SUPPORT_JUMPED: the support's pose or twist does not follow"
    )
