"""Search for an input that the program does not take: messages, parameters and bags that were changed at random.

    python tools/fuzz.py --seconds 600
    python tools/fuzz.py --seconds 600 --engine atheris        (guided by coverage; pip install atheris)
    python tools/fuzz.py --replay out/fuzz/FILE

Whatever comes in, a message must be answered or refused by a named status, a parameter or a file be taken or refused
in one sentence, every number that goes out be finite, and all of it take a bounded time and no memory for good. An
input that shows otherwise is saved; the exit status is 1 then. Both engines make bytes, which `fuzz_choices` reads as
choices.
"""

from __future__ import annotations

import argparse
import signal
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from random import Random
from types import FrameType
from typing import Final

from fuzz_choices import Choices

LONGEST: Final = 20.0
"""Seconds of processor time for one input; most take some milliseconds."""
MOST_GROWTH: Final = 64.0
"""MB of memory by which a run may grow after the first fifth of its time: Python's own scatter is below half of it."""
SIZES: Final = (64, 256, 1024, 4096)
TELL_EVERY: Final = 30.0


class Hang(Exception):
    """An input takes too long."""


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=None, help="of the engine random; by default a new one")
    parser.add_argument("--only", choices=("messages", "parameters", "bags"), help="one kind of input alone")
    parser.add_argument("--engine", choices=("random", "atheris"), default="random")
    parser.add_argument("--save", type=Path, default=Path("out/fuzz"), help="the folder of failing inputs")
    parser.add_argument("--replay", type=Path, nargs="+", metavar="FILE", help="run saved inputs again")
    arguments = parser.parse_args()
    signal.signal(signal.SIGPROF, _too_long)
    if arguments.replay:
        for path in arguments.replay:
            _timed(path.read_bytes())
        return 0
    if arguments.engine == "atheris":
        return _by_coverage(arguments.seconds, arguments.only, arguments.save)
    seed = Random().randrange(2**32) if arguments.seed is None else arguments.seed
    return _at_random(arguments.seconds, seed, arguments.only, arguments.save)


def kinds() -> dict[str, Callable[[Choices], str]]:
    """What takes the inputs of each kind; the first byte of an input says which."""
    from fuzz_bags import fuzz_bags
    from fuzz_messages import fuzz_messages
    from fuzz_parameters import fuzz_parameters

    return {"messages": fuzz_messages, "parameters": fuzz_parameters, "bags": fuzz_bags}


KINDS: Final = ("messages", "messages", "messages", "parameters", "bags")


def take(data: bytes) -> str:
    """Run one input; what it was about."""
    choices = Choices(data)
    kind = choices.of(KINDS)
    return f"{kind}: {kinds()[kind](choices)}"


def prepare() -> None:
    """Make what all inputs are made of, so that it does not count for the first of them."""
    from fuzz_bags import bags
    from fuzz_messages import courses

    kinds()
    courses()
    bags()


def _timed(data: bytes) -> str:
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        return take(data)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def _too_long(_: int, frame: FrameType | None) -> None:
    raise Hang(f"more than {LONGEST:.0f} s")


def _at_random(seconds: float, seed: int, only: str | None, folder: Path) -> int:
    print(f"seed {seed}", flush=True)
    prepare()
    began = shown = time.monotonic()
    done: Counter[str] = Counter()
    failures: dict[str, Path] = {}
    first_memory = 0.0
    number = 0
    slowest = (0.0, "")
    while (now := time.monotonic()) - began < seconds:
        source = Random(f"{seed}/{number}")
        kind = source.randrange(len(KINDS)) if only is None else KINDS.index(only)
        data = bytes([kind]) + source.randbytes(source.choice(SIZES))
        number += 1
        try:
            about = _timed(data)
            done[about] += 1
            slowest = max(slowest, (time.monotonic() - now, about))
        except Exception as error:
            where = _place(error)
            if where not in failures:
                failures[where] = _save(folder, data)
                print(f"\n{failures[where]}: {where}", flush=True)
                traceback.print_exception(error, limit=-6)
            done["failed"] += 1
        if not first_memory and now - began > 0.2 * seconds:
            first_memory = _memory()
        if now - shown > TELL_EVERY:
            shown = now
            print(f"{now - began:.0f} s: {number} inputs, {_memory():.0f} MB", flush=True)
    growth = _memory() - first_memory
    for about, count in sorted(done.items()):
        print(f"{count:8d} {about}")
    print(
        f"{number} inputs in {seconds:.0f} s, seed {seed}; {len(failures)} failures; "
        f"the slowest took {slowest[0]:.2f} s ({slowest[1]}); memory {_memory():.0f} MB, "
        f"{growth:+.1f} MB after the first fifth"
    )
    if growth > MOST_GROWTH:
        print(f"the memory grows by more than {MOST_GROWTH:.0f} MB")
    return int(bool(failures) or growth > MOST_GROWTH)


def _by_coverage(seconds: float, only: str | None, folder: Path) -> int:
    """Let atheris make the inputs; it ends the process at the first failure, whose input it saves."""
    import atheris  # type: ignore[import-untyped]

    with atheris.instrument_imports(include=["impact_predictor"]):
        prepare()
    prefix = b"" if only is None else bytes([KINDS.index(only)])

    def one(data: bytes) -> None:
        _timed(prefix + data)

    folder.mkdir(parents=True, exist_ok=True)
    options = [f"-max_total_time={seconds:.0f}", f"-artifact_prefix={folder}/", f"-timeout={10.0 * LONGEST:.0f}"]
    atheris.Setup([sys.argv[0], *options, "-max_len=4096", "-len_control=0"], one)
    atheris.Fuzz()
    return 0


def _place(error: Exception) -> str:
    """The exception and where it was raised, by which failures are told apart."""
    frames = traceback.extract_tb(error.__traceback__)
    last = frames[-1]
    about = str(error).partition(":")[0] if type(error).__name__ == "Flaw" else ""
    return f"{type(error).__name__} in {Path(last.filename).name}:{last.lineno} {about}".rstrip()


def _save(folder: Path, data: bytes) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / sha256(data).hexdigest()[:12]
    path.write_bytes(data)
    return path


def _memory() -> float:
    """The resident memory of this process, in MB."""
    fields = Path("/proc/self/statm").read_text(encoding="ascii").split()
    return int(fields[1]) * 4096 / 1e6


if __name__ == "__main__":
    sys.exit(main())
