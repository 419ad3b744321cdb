from impact_predictor.bags.read import BagMessage
from impact_predictor.ros.player import SHORTENED_GAP, timed

SECOND = 1_000_000_000


def messages(*seconds):
    return [BagMessage("/odom", round(second * SECOND), b"") for second in seconds]


def pauses(runs, *seconds):
    return [pause for pause, _ in timed(messages(*seconds), runs)]


def test_messages_keep_their_pauses_and_idle_gaps_are_shortened():
    assert pauses(0, 10.0, 10.25, 10.5, 30.0, 30.25) == [0.0, 0.25, 0.25, SHORTENED_GAP, 0.25]


def test_an_excerpt_ends_where_the_last_of_its_runs_ends():
    assert [message.log_time // SECOND for _, message in timed(messages(1.0, 1.0, 20.0, 40.0), 2)] == [1, 1, 20]


def test_log_times_that_go_back_make_no_negative_pause():
    assert pauses(0, 2.0, 1.0, 1.25) == [0.0, 0.0, 0.25]
