"""Bags on the workers of a Dask cluster, their outcomes in the order of the bags."""

from __future__ import annotations

import asyncio
import logging
import signal
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent import futures
from contextlib import contextmanager
from multiprocessing import resource_tracker
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from ..errors import InputError, need
from .job import BagOutcome, Job, failed, replay_bag

if TYPE_CHECKING:
    from distributed import Client, Future

PATIENCE: Final = "10s"
"""How long a scheduler has to answer."""

_LOST: Final = "the scheduler of Dask is lost; see what it says, and replay the other bags"
_CANCELLED: Final = (asyncio.CancelledError, futures.CancelledError)
"""What becomes of everything that is with a scheduler when it is lost."""

_LOCAL: Final = {
    # What is tried again after the death of a worker is for `Fleet` to say.
    "distributed.scheduler.allowed-failures": 0,
    # A worker that died comes back, however long that takes on a busy machine.
    "distributed.deploy.lost-worker-timeout": "1h",
    # No dashboard, and nothing else for a browser.
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    # No record of what each second was spent on, nor of what was sent: they grow with the bags.
    "distributed.worker.profile.enabled": False,
    "distributed.admin.log-length": 100,
    "distributed.admin.low-level-log-length": 100,
}

_QUEUED: Final = 2
"""Bags that a worker has at a time: one that it replays, and one so that it never waits."""

_AHEAD: Final = 32
"""Bags for each worker that may be done before their turn: they wait with the workers."""

_POLL: Final = 0.2
"""Seconds after which the bar is told again."""


@contextmanager
def connected(workers: int, scheduler: str | None = None) -> Iterator[Client]:
    """A client of the cluster of a scheduler, or without one of so many processes of this machine.

    Raises:
        InputError: Dask is missing, or the scheduler does not answer or has no workers.
    """
    need("distributed")
    from dask import config
    from distributed import Client, LocalCluster

    if scheduler is None:
        # What a worker leaves that is ended within a bag goes with the folder.
        with TemporaryDirectory(prefix="impact_predictor_", ignore_cleanup_errors=True) as folder, config.set(_LOCAL):
            with _uninterrupted():
                cluster = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    local_directory=folder,
                    env={"TMPDIR": folder},
                    # Without it Dask would take its usual port.
                    scheduler_kwargs={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
                    # What it would say is said of the bag.
                    silence_logs=logging.CRITICAL,
                )
            with cluster, Client(cluster) as client:
                yield client
        return
    # What it would say is said in a sentence.
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        client = Client(scheduler, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(
            f"no scheduler of Dask answers at {scheduler}; start one with `dask scheduler`, or leave out --scheduler"
        ) from error
    with client:
        if not client.nthreads():
            raise InputError(f"the scheduler at {scheduler} has no workers; start one with `dask worker {scheduler}`")
        yield client


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Processes that are started meanwhile never see Ctrl-C, which is for this one: it ends them."""
    # It would unblock the signal when it is started later.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _interrupts() -> Iterator[Callable[[], None]]:
    """Gives a function that raises the KeyboardInterrupt of a Ctrl-C that came since; a second Ctrl-C raises at once.

    Python drops an interrupt that it would raise in a finalizer, and each future of Dask has one.
    """
    came = False

    def note(*_: object) -> None:
        nonlocal came
        came = True
        signal.signal(signal.SIGINT, before)

    def check() -> None:
        if came:
            raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGINT)
    # What a shell started in the background goes on.
    if before is not signal.SIG_IGN:
        signal.signal(signal.SIGINT, note)
    try:
        yield check
    finally:
        signal.signal(signal.SIGINT, before)


class Fleet:
    """The bags of a job on the workers of a client.

    A bag whose worker dies is tried once more when no other bag is on any worker, so that the bag is found that kills
    it, and none is blamed that was only near it.
    """

    def __init__(self, client: Client, job: Job, bags: Sequence[str], outputs: Sequence[Path | None]) -> None:
        """Nothing is sent before the outcomes are asked for."""
        self._client, self._job, self._bags, self._outputs = client, job, bags, outputs
        self._workers = sum(client.nthreads().values())
        self._futures: dict[int, Future] = {}
        self._sent = self._told = 0
        self._suspects: deque[int] = deque()
        self._tried: set[int] = set()

    def outcomes(self, tell: Callable[[int], None]) -> Iterator[BagOutcome]:
        """What became of each bag, in their order; `tell` is told now and then how many are done.

        Raises:
            InputError: the scheduler is lost.
            KeyboardInterrupt: Ctrl-C, between two outcomes.
        """
        with _interrupts() as check:
            for index in range(len(self._bags)):
                while (outcome := self._outcome(index)) is None:
                    running = self._send()
                    tell(self._told + sum(future.done() for future in self._futures.values()))
                    self._wait(running)
                    check()
                del self._futures[index]
                self._told += 1
                # While the outcome is told the workers go on.
                self._send()
                yield outcome
                check()

    def _send(self) -> list[Future]:
        """Send bags to the workers, and give those that they have."""
        for index, future in [*self._futures.items()]:
            if index not in self._tried and _killed(future):
                self._suspect(index)
        running = [index for index, future in self._futures.items() if not future.done()]
        if self._suspects:
            if not running:
                running.append(self._submit(self._suspects.popleft()))
        elif not self._tried.intersection(running):
            end = min(len(self._bags), self._told + _AHEAD * self._workers)
            while self._sent < end and len(running) < _QUEUED * self._workers:
                running.append(self._submit(self._sent))
                self._sent += 1
        return [self._futures[index] for index in running]

    def _submit(self, index: int) -> int:
        bag, output = self._bags[index], self._outputs[index]
        self._futures[index] = self._client.submit(replay_bag, self._job, bag, output, pure=False)
        return index

    def _wait(self, running: Sequence[Future]) -> None:
        from distributed import wait

        try:
            wait(running, timeout=_POLL, return_when="FIRST_COMPLETED")
        except asyncio.TimeoutError:
            pass
        except _CANCELLED as error:
            raise InputError(_LOST) from error

    def _suspect(self, index: int) -> None:
        """Try a bag once more, alone."""
        self._tried.add(index)
        self._suspects.append(index)
        del self._futures[index]

    def _outcome(self, index: int) -> BagOutcome | None:
        """What became of a bag; None where that is not known yet."""
        from distributed import KilledWorker
        from distributed.comm import CommClosedError

        bag, future = self._bags[index], self._futures.get(index)
        if future is None or not future.done():
            return None
        try:
            outcome: BagOutcome = future.result()
        except KilledWorker:
            # What is done and not told yet is lost with its worker too.
            if index not in self._tried:
                self._suspect(index)
                return None
            died = f"{bag} could not be replayed: its worker died, and the second one too"
            return failed(bag, f"{died}; it may need more memory than a worker has: replay it alone, without --workers")
        except (*_CANCELLED, CommClosedError) as error:
            raise InputError(_LOST) from error
        except Exception as error:  # whatever it is, it is the fault of this bag alone
            said = f"{type(error).__name__}: {error}".splitlines()[0].rstrip(": ")
            return failed(bag, f"{bag} could not be replayed ({said}); replay it alone to see where it fails")
        return outcome


def _killed(future: Future) -> bool:
    from distributed import KilledWorker

    return future.status == "error" and isinstance(future.exception(), KilledWorker)
