"""The fuzzer in tools/: that it sees what it looks for, and that a few inputs of each kind are taken."""

import math
import sys
from pathlib import Path
from random import Random

import pytest

from impact_predictor.bags.replay import replay
from impact_predictor.errors import InputError
from impact_predictor.parameters.file import read_parameters, read_values
from impact_predictor.prediction.scene import scenes_of
from impact_predictor.prediction.types import Sample
from impact_predictor.ros.messages import ODOMETRY, encode_odometry

ROOT = Path(__file__).parents[1]


@pytest.fixture(autouse=True)
def tools(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "tools"))


def sources(count):
    from fuzz_choices import Choices

    return [Choices(Random(seed).randbytes(512)) for seed in range(count)]


def test_the_same_bytes_are_the_same_choices_and_none_are_tame():
    from fuzz_choices import Choices

    first, second, none = Choices(b"abc" * 20), Choices(b"abc" * 20), Choices(b"")
    assert [first.number(1.0) for _ in range(9)] == pytest.approx([second.number(1.0) for _ in range(9)], nan_ok=True)
    assert first.damaged(b"message") == second.damaged(b"message")
    assert [none.below(7), none.once_in(3), none.of("abc")] == [0, False, "a"]


def test_an_answer_that_is_not_finite_is_a_flaw():
    from fuzz_messages import Flaw, check_answer

    zero, none = (0.0, 0.0, 0.0), (0.0,) * 36
    good = Sample(0, "world", "cube", zero, (0.0, 0.0, 0.0, 1.0), zero, zero, none, none)
    check_answer("post_impact", ODOMETRY, encode_odometry(good))
    with pytest.raises(Flaw, match="is not finite"):
        check_answer("post_impact", ODOMETRY, encode_odometry(good._replace(linear=(math.nan, 0.0, 0.0))))
    with pytest.raises(Flaw, match="is no nav_msgs"):
        check_answer("post_impact", ODOMETRY, b"\0\1\0\0")


def test_changed_messages_of_a_cube_are_answered_or_refused():
    from fuzz_messages import feed, made_course, sequence

    course = made_course("cube_tosses", read_parameters(ROOT / "config/cube_tosses.yaml"))
    for choices in sources(4):
        sent = sequence(choices, course)
        feed(course, sent)
    assert len(sent) > 1


def test_changed_parameter_files_are_taken_or_refused_in_one_sentence():
    from fuzz_parameters import shipped, take_file

    for choices in sources(40):
        take_file(choices, choices.of(shipped())[1])


def test_changed_bags_are_replayed_or_refused_in_one_sentence():
    from fuzz_bags import NAMES, fuzz_bags

    assert {fuzz_bags(choices).partition(",")[0] for choices in sources(20)} == set(NAMES)


def test_a_damaged_definition_is_told_in_one_sentence_without_the_page_that_it_is(tmp_path):
    from fuzz_bags import bags

    bag = tmp_path / "old.bag"
    bag.write_bytes(dict(bags())["old.bag"]["old.bag"].replace(b"float64[36] covariance", b"float64[36  covariance"))
    with pytest.raises(InputError) as error:
        replay(bag, scenes_of(read_values(ROOT / "config/cube_tosses.yaml")))
    assert "damaged definition" in str(error.value)
    assert str(error.value).isprintable()
    assert len(str(error.value)) < 200 + len(str(bag))


def test_the_modules_of_the_fuzzer_are_found_beside_it():
    import fuzz

    assert set(fuzz.KINDS) == set(fuzz.kinds())
    assert Path(sys.modules["fuzz_bags"].__file__).parent == ROOT / "tools"
