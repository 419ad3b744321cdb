"""Bags on the workers of a cluster: in which order they are told, and whose fault the death of a worker is."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result

from impact_predictor.cli import main
from impact_predictor.errors import InputError
from impact_predictor.fleet import cluster
from impact_predictor.fleet.cluster import Fleet
from impact_predictor.fleet.job import BagOutcome, Job, replay_bag

distributed = pytest.importorskip("distributed", reason="needs the extra fleet (make test-extras)")

pytestmark = pytest.mark.extras

ROOT = Path(__file__).parents[2]
SCENE = "config/cube_tosses.yaml"
JOB = Job({}, {})


class Worker:
    """A cluster of two workers that finishes the newest bag first, one each time that it is waited for."""

    def __init__(self, deadly: set[str], limit: int = 10) -> None:
        self.deadly, self.limit = deadly, limit
        self.running: list[Promise] = []
        self.tried: list[str] = []
        self.most = 0

    def nthreads(self) -> dict[str, int]:
        return {"a": 1, "b": 1}

    def submit(self, work: Callable[..., BagOutcome], job: Job, bag: str, output: Path | None, pure: bool) -> Promise:
        assert work is replay_bag
        assert not pure  # a bag is replayed even if one of its name was before
        self.tried.append(bag)
        self.running.append(Promise(bag))
        self.most = max(self.most, len(self.running))
        return self.running[-1]

    def wait(self, running: list[Promise], **_: Any) -> None:
        assert set(running) == set(self.running)
        dead = any(promise.bag in self.deadly for promise in running)
        done = running if dead else running[-1:]
        for promise in done:
            # The death of a worker takes with it what was near it.
            promise.status = "error" if dead else "finished"
            self.running.remove(promise)


class Promise:
    def __init__(self, bag: str) -> None:
        self.bag, self.status = bag, "pending"

    def done(self) -> bool:
        return self.status != "pending"

    def exception(self) -> Exception:
        return distributed.KilledWorker(self.bag, None, 0)

    def result(self) -> BagOutcome:
        if self.status == "error":
            raise self.exception()
        return BagOutcome(self.bag, None, {"bag": self.bag})


def told(worker: Worker, bags: list[str], monkeypatch: pytest.MonkeyPatch) -> list[BagOutcome]:
    monkeypatch.setattr(distributed, "wait", worker.wait)
    return list(Fleet(worker, JOB, bags, [None] * len(bags)).outcomes(lambda done: None))


def test_outcomes_come_in_the_order_of_the_bags_whatever_the_workers_do(monkeypatch: pytest.MonkeyPatch) -> None:
    bags = [f"{number}.mcap" for number in range(200)]
    worker = Worker(set())
    assert [one.bag for one in told(worker, bags, monkeypatch)] == bags
    assert worker.tried == bags
    assert worker.most == 4  # each of the two has one to replay and one to go on with


def test_only_the_bag_that_kills_its_worker_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    bags = [f"{number}.mcap" for number in range(12)]
    worker = Worker({"3.mcap", "4.mcap", "11.mcap"})
    outcomes = told(worker, bags, monkeypatch)
    assert [one.bag for one in outcomes] == bags
    assert {one.bag for one in outcomes if one.error} == worker.deadly
    assert "3.mcap could not be replayed: its worker died" in outcomes[3].error
    assert max(worker.tried.count(bag) for bag in bags) == 2


def test_ctrl_c_ends_the_run_though_it_comes_in_a_finalizer_which_drops_it(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(promise: Promise) -> None:
        if promise.bag == "1.mcap":
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(Promise, "__del__", interrupt, raising=False)
    with pytest.raises(KeyboardInterrupt):
        told(Worker(set()), ["0.mcap", "1.mcap", "2.mcap"], monkeypatch)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_bag_that_fails_is_told_in_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Promise, "exception", lambda self: KeyError("stamp\nof the line below"))
    outcomes = told(Worker({"1.mcap"}), ["0.mcap", "1.mcap"], monkeypatch)
    assert "1.mcap could not be replayed (KeyError: " in outcomes[1].error
    assert "\n" not in outcomes[1].error


def test_a_scheduler_that_is_lost_or_does_not_answer_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    for error in (distributed.client.FutureCancelledError("0", "lost"), distributed.comm.CommClosedError("lost")):
        with monkeypatch.context() as patch, pytest.raises(InputError, match="scheduler of Dask is lost"):
            patch.setattr(Promise, "exception", lambda self, error=error: error)
            told(Worker({"0.mcap"}), ["0.mcap"], patch)

    def lost(*_: object, **__: object) -> None:
        raise asyncio.CancelledError("lost")

    monkeypatch.setattr(Worker, "wait", lost)
    with pytest.raises(InputError, match="scheduler of Dask is lost"):
        told(Worker(set()), ["0.mcap"], monkeypatch)
    monkeypatch.setattr(cluster, "PATIENCE", "0.2s")
    for address in ("tcp://127.0.0.1:9", "nonsense://x"):
        with pytest.raises(InputError, match="no scheduler of Dask answers at"), cluster.connected(2, address):
            pass


def replayed(output: Path, bags: list[str], *options: str) -> Result:
    """The bags into the folder `output` and a table beside it."""
    files = ["-o", str(output), "--table", f"{output}.parquet", "--json"]
    return CliRunner().invoke(main, ["replay", *bags, "--params", str(ROOT / SCENE), *files, *options])


def written(output: Path) -> dict[str, bytes]:
    files = [*output.iterdir(), Path(f"{output}.parquet")]
    return {path.name.replace(output.name, "table"): path.read_bytes() for path in files}


@pytest.mark.slow  # starts a scheduler and two workers
def test_two_workers_give_the_bytes_of_one_and_a_damaged_bag_stops_no_other(tmp_path: Path, bags: list[str]) -> None:
    (tmp_path / "no_bag.mcap").write_bytes(b"no bag")
    given = [bags[0], str(tmp_path / "no_bag.mcap"), *bags[1:]]
    one, two = (replayed(tmp_path / f"of_{workers}", given, "--workers", workers) for workers in ("1", "2"))
    assert (one.exit_code, two.exit_code) == (2, 2)
    assert one.stderr == two.stderr
    assert set(written(tmp_path / "of_1")) == {*(Path(bag).name for bag in bags), "table.parquet"}
    assert written(tmp_path / "of_1") == written(tmp_path / "of_2")


@pytest.mark.slow  # a real scheduler over TCP, with a worker in this process
def test_the_workers_of_a_scheduler_give_the_same_bytes(
    tmp_path: Path, bags: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(Path(bags[0]).parent)
    bags = [Path(bag).name for bag in bags]
    options = {"processes": False, "threads_per_worker": 1, "protocol": "tcp://", "dashboard_address": None}
    with distributed.LocalCluster(n_workers=0, **options) as cluster:
        address = cluster.scheduler_address
        none = replayed(tmp_path / "none", bags, "--scheduler", address)
        assert (none.exit_code, none.stderr) == (
            2,
            f"error: the scheduler at {address} has no workers; start one with `dask worker {address}`\n",
        )
        cluster.scale(1)
        with distributed.Client(cluster) as client:
            client.wait_for_workers(1, timeout=20)
        assert replayed(tmp_path / "there", bags, "--scheduler", address).exit_code == 0
    assert replayed(tmp_path / "here", bags).exit_code == 0
    assert written(tmp_path / "there") == written(tmp_path / "here")


@pytest.mark.slow  # starts a scheduler and two workers
def test_ctrl_c_keeps_what_is_done_and_leaves_no_process_behind(tmp_path: Path, bags: list[str]) -> None:
    many = tmp_path / "many"
    many.mkdir()
    for number in range(400):
        (many / f"{number}.mcap").hardlink_to(bags[0])
    table, output = tmp_path / "table.parquet", tmp_path / "out"
    files = ["--table", str(table), "-o", str(output)]
    command = [sys.executable, "-m", "impact_predictor", "replay", str(many), "--params", SCENE, *files]
    # As a terminal does, the signal goes to all processes of the group.
    process = subprocess.Popen(
        [*command, "--workers", "2"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    # The line of the second bag comes when the first one is in the table.
    for _ in range(2):
        process.stdout.readline()
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "note: stopped after" in said
    assert "Traceback" not in said
    assert table.exists()
    # What a worker was writing stays only if it holds messages, and is named.
    assert all(str(place) in said for place in output.glob("*.partial"))
    end = time.monotonic() + 5.0
    while _is_there(process.pid) and time.monotonic() < end:
        time.sleep(0.05)
    assert not _is_there(process.pid)


def _is_there(group: int) -> bool:
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True
