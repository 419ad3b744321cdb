"""The pytest plugin in pytest itself: what is collected, how it fails, and that it costs nothing unasked."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

# Loaded before any run within this process, or each of them would load numpy and rosbags anew.
import impact_predictor.testing.collection  # noqa: F401
from impact_predictor.cli import main

pytest_plugins = "pytester"

ROOT = Path(__file__).parents[2]
# It is loaded already within this process, so its assertions are not rewritten.
PLUGIN = ["-p", "impact_predictor.testing.plugin", "-p", "no:cacheprovider"]
PLUGIN += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
BAG = ("--impact-bag", "run.mcap", "--impact-params", "scene.yaml")
TESTS = (
    *("samples", "number of touchdowns", "median error", "missed touchdowns", "false alarms", "modes"),
    *("median error against the truth", "median error of time", "touchdown 1 at 0.33 s", "touchdown 2 at 0.37 s"),
    *("touchdown 3 at 0.37 s", "touchdown 4 at 0.63 s", "touchdown 5 at 0.65 s"),
)
"""Tests of the bag; three touchdowns end flights that last a few samples, or strike with another point than was
predicted, and are not scored."""
SKIPPED = 3
PASSED = len(TESTS) - SKIPPED

Run = Callable[..., pytest.RunResult]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two impacts of a plate on the floor, a little livelier than its scene says."""
    path = tmp_path_factory.mktemp("plate") / "run.mcap"
    options = ["--friction", "0.4", "--restitution", "0.15", "--duration", "0.7", "-o", str(path)]
    assert CliRunner().invoke(main, ["simulate", "plate", *options]).exit_code == 0
    return path


@pytest.fixture
def run(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch, recorded: Path) -> Run:
    """Runs pytest with this plugin alone, beside a bag, its scene and one ordinary test."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setenv("PYTHONPATH", str(ROOT), prepend=os.pathsep)
    shutil.copy(recorded, pytester.path / "run.mcap")
    shutil.copy(ROOT / "config/rocking_plate.yaml", pytester.path / "scene.yaml")
    pytester.makepyfile(test_other="def test_other(): pass")
    return lambda *options: pytester.runpytest_inprocess(*PLUGIN, *options)


def test_without_a_bag_nothing_is_collected_and_nothing_that_reads_bags_is_loaded(
    run: Run, pytester: pytest.Pytester
) -> None:
    pytester.makeconftest(
        """
        import sys

        def pytest_unconfigure():
            heavy = {"numpy", "rosbags", "rich", "click", "scipy", "ruamel", "impact_predictor.mechanics"}
            ours = [name for name in sys.modules if name.startswith("impact_predictor.")]
            print("loaded:", *sorted(heavy & sys.modules.keys()), *sorted(ours))
        """
    )
    result = pytester.runpytest_subprocess(*PLUGIN)
    result.assert_outcomes(passed=1)
    names = (f"impact_predictor.{name}" for name in ("errors", "native", "testing", "testing.plugin"))
    assert " ".join(["loaded:", *names]) in result.outlines


def test_a_bag_becomes_tests_of_the_run_and_of_each_touchdown_beside_those_of_paths_that_are_named(run: Run) -> None:
    result = run(*BAG)
    result.assert_outcomes(passed=PASSED, skipped=SKIPPED)
    listed = run(*BAG, "--collect-only", "-q").outlines
    assert [line for line in listed if "::" in line] == [f"run.mcap::{name}" for name in TESTS]
    # It is tested alone, or with the paths that are named.
    run(*BAG, "test_other.py").assert_outcomes(passed=PASSED + 1, skipped=SKIPPED)


def test_tests_are_chosen_by_keywords_and_by_their_ids(run: Run) -> None:
    run(*BAG, "-k", "touchdown and 0.63").assert_outcomes(passed=1, deselected=len(TESTS) - 1)
    run(*BAG, "run.mcap::touchdown 4 at 0.63 s").assert_outcomes(passed=1)
    settings = ("-o", "impact_bag=run.mcap", "-o", "impact_params=scene.yaml")
    run(*settings, "run.mcap::touchdown 4 at 0.63 s").assert_outcomes(passed=1)


def test_the_first_failure_ends_a_run_that_asks_for_it_and_is_said_in_one_line(run: Run) -> None:
    result = run(*BAG, "--impact-error", "0.001", "-x", "-rfE")
    result.assert_outcomes(failed=1, passed=8)
    result.stdout.fnmatch_lines(
        [
            "*run.mcap: touchdown 1 at 0.33 s*",
            "the error is 2.0 %, more than 0.1 % (impact_error)",
            "FLIGHT was predicted 0.4 ms ahead, first 249.4 ms ahead",
            "*vx m/s*vy m/s*omega rad/s",
            "before *",
            "predicted *",
            "measured *",
            "FAILED run.mcap::touchdown 1 at 0.33 s - Failed: the error is 2.0 %*",
        ]
    )
    result.stdout.no_fnmatch_line("*Traceback*")


def test_the_junit_report_names_the_bag_the_touchdown_and_what_was_measured(
    run: Run, pytester: pytest.Pytester
) -> None:
    run(*BAG, "--junitxml=report.xml", "--impact-error", "0.001", "-k", "touchdown and 0.63")
    case = ElementTree.parse(pytester.path / "report.xml").getroot().find(".//testcase")
    assert case is not None
    assert (case.get("classname"), case.get("name")) == ("run.mcap", "touchdown 4 at 0.63 s")
    measured = case.find(".//property[@name='relative_error']")
    assert measured is not None
    # A plate of another restitution than the scene's: the last digit is that of the message.
    assert float(measured.get("value", "")) == pytest.approx(0.022, abs=0.0005)
    failure = case.find("failure")
    assert failure is not None
    assert failure.get("message", "").startswith("Failed: the error is 2.2 %, more than 0.1 %")


@pytest.mark.slow
def test_two_workers_share_the_tests(run: Run, pytester: pytest.Pytester) -> None:
    result = pytester.runpytest_subprocess(*PLUGIN, "-p", "xdist", "-n", "2", *BAG)
    result.assert_outcomes(passed=PASSED, skipped=SKIPPED)


def test_settings_of_the_ini_file_count_from_its_folder_and_options_come_before_them(
    run: Run, pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytester.makeini(
        """
        [pytest]
        impact_bag = bags/*.mcap
        impact_params = scene.yaml
        impact_remap = odom:=/odom
        impact_median_error = 0.001
        """
    )
    (pytester.path / "bags").mkdir()
    for name in ("bags/first.mcap", "bags/second.mcap"):
        shutil.copy(pytester.path / "run.mcap", pytester.path / name)
    folder = pytester.mkdir("elsewhere")
    monkeypatch.chdir(folder)
    # Together with all other tests: of this folder there are none.
    run().assert_outcomes(passed=2 * PASSED - 4, failed=4, skipped=2 * SKIPPED)
    run("--impact-median-error", "0.5").assert_outcomes(passed=2 * PASSED, skipped=2 * SKIPPED)
    # A path that is named is tested alone.
    run("../test_other.py").assert_outcomes(passed=1)
    run("../bags/second.mcap", "-k", "samples").assert_outcomes(passed=1, deselected=len(TESTS) - 1)


def test_bags_may_be_folders_patterns_and_outside_of_the_project(
    run: Run, pytester: pytest.Pytester, tmp_path_factory: pytest.TempPathFactory
) -> None:
    outside = tmp_path_factory.mktemp("outside")
    shutil.copytree(ROOT / "examples/cube_tosses", outside / "tosses", ignore=shutil.ignore_patterns("*.mcap"))
    shutil.copy(pytester.path / "run.mcap", outside / "tosses/cube_tosses.mcap")
    (outside / "tosses/metadata.yaml").unlink()
    result = run(
        *("--impact-bag", str(outside / "*"), "--impact-bag", "run.mcap", "--impact-bag", "./run.mcap"),
        *("--impact-params", "scene.yaml", "-k", "samples", "-v"),
    )
    result.assert_outcomes(passed=2, deselected=2 * (len(TESTS) - 1))
    result.stdout.fnmatch_lines(["../*/tosses::samples PASSED*", "run.mcap::samples PASSED*"])


def test_bags_of_one_name_have_their_own_baselines_and_fail_only_when_something_has_changed(
    run: Run, pytester: pytest.Pytester
) -> None:
    bags = [pytester.mkdir(day) / "run.mcap" for day in ("monday", "tuesday")]
    for bag in bags:
        shutil.copy(pytester.path / "run.mcap", bag)
    for name, of in (("old.json", bags), ("monday.json", bags[:1])):
        told = CliRunner().invoke(main, ["replay", *map(str, of), "--params", "scene.yaml", "--json"])
        assert told.exit_code == 0
        (pytester.path / name).write_text(told.stdout)
    options = ("--impact-bag", "*day/run.mcap", "--impact-params", "scene.yaml", "-k", "baseline", "--impact-baseline")
    run(*options, "old.json").assert_outcomes(passed=2, deselected=2 * len(TESTS))
    scene = pytester.path / "scene.yaml"
    scene.write_text(scene.read_text().replace("restitution: 0.1", "restitution: 0.3"))
    changed = run(*options, "old.json")
    changed.assert_outcomes(failed=2, deselected=2 * len(TESTS))
    changed.stdout.fnmatch_lines(
        ["Against *old* 2 of 5 touchdowns are as they were: 2 worse, 1 other*", "0.334 s*worse*"]
    )
    refused = run(*options, "monday.json")
    refused.stderr.fnmatch_lines(["ERROR: the baseline *monday.json is the run of one bag, but 2 bags are given; *"])


def test_the_help_lists_the_options_with_their_defaults(run: Run) -> None:
    text = " ".join(run("--help").stdout.str().split())
    assert "--impact-bag=BAG" in text
    assert "greatest median of the relative errors of a run (default: 0.2)" in text


def test_what_is_wrong_with_one_bag_fails_that_bag_alone(run: Run, pytester: pytest.Pytester) -> None:
    (pytester.path / "broken.mcap").write_bytes(b"no bag")
    result = run(*BAG, "--impact-bag", "broken.mcap")
    result.assert_outcomes(passed=PASSED, skipped=SKIPPED, failed=1)
    result.stdout.fnmatch_lines(["*broken.mcap: samples*", "*broken.mcap *"])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--impact-bag", "run.mcap"), "give --impact-params FILE"),
        (("--impact-bag", "none.mcap", "--impact-params", "scene.yaml"), "there is no bag none.mcap in *"),
        (("--impact-bag", "no*.mcap", "--impact-params", "scene.yaml"), "no bag fits the pattern no*.mcap in *"),
        (("--impact-bag", "run.mcap", "--impact-params", "none.yaml"), "*none.yaml*"),
        ((*BAG, "--impact-remap", "odom"), "the remapping 'odom' is not of the form from:=to*"),
        ((*BAG, "--impact-missed", "few"), "impact_missed is 'few'; give a whole number*"),
    ],
)
def test_wrong_settings_are_said_in_one_line_before_anything_runs(
    run: Run, options: tuple[str, ...], said: str
) -> None:
    result = run(*options)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    (line,) = [line for line in result.errlines if line]
    assert line.startswith("ERROR: ")
    result.stderr.fnmatch_lines([f"*{said}*"])


def test_the_fixture_replays_a_bag_once_and_sees_paths_from_the_folder_of_the_test(
    run: Run, pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytester.makepyfile(
        test_run="""
        import pytest
        from impact_predictor.errors import InputError

        @pytest.fixture(scope="module")
        def result(impact_replay):
            return impact_replay("run.mcap", "scene.yaml")

        def test_touchdowns(result, impact_replay):
            assert [settled.body for settled in result.settled] == ["plate"] * 5
            assert result.truth.missed == 0
            assert impact_replay("./run.mcap", "scene.yaml") is result
            assert impact_replay("run.mcap") is result

        def test_topics_by_remapping(result, impact_replay):
            other = impact_replay("run.mcap", "scene.yaml", {"odom": "/odom"})
            assert other is not result
            assert other.settled[0].score == result.settled[0].score

        def test_a_bag_that_is_not_there(impact_replay):
            with pytest.raises(InputError, match="none.mcap does not exist"):
                impact_replay("none.mcap", "scene.yaml")
        """
    )
    monkeypatch.chdir(pytester.mkdir("elsewhere"))
    run("../test_run.py", "--impact-params", "../scene.yaml").assert_outcomes(passed=3)
    result = run("../test_run.py")
    result.assert_outcomes(failed=1, passed=2)
    result.stdout.fnmatch_lines(["*no parameter file for run.mcap: give it after the bag, or with --impact-params*"])
