"""The same bag and scene give the same bytes, on every run, in every process, with and without numba.

That other Pythons give them too is checked by tools/test_install.py, which has several.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from recordings import first_messages, write_mcap

from impact_predictor.bags.replay import replay
from impact_predictor.parameters.file import read_parameters
from impact_predictor.parameters.validation import validate
from impact_predictor.prediction.scene import Scene

TOSSES = Path(__file__).parents[1] / "config/cube_tosses.yaml"
REMAP = {"odom": "/cube/odom", "contact_geometry": "/cube/contact_geometry"}
REPLAY = f"""
import sys
from pathlib import Path
if sys.argv[1] == "without":
    sys.modules["numba"] = None  # as where it is not installed
sys.path.append({str(Path(__file__).parent)!r})
from test_determinism import replayed
replayed(Path(sys.argv[2]), Path(sys.argv[3]), 16)
assert bool(sys.modules.get("numba")) == (sys.argv[1] == "with")
"""


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first toss."""
    return write_mcap(tmp_path_factory.mktemp("toss") / "toss.mcap", first_messages(110))


def replayed(bag: Path, output: Path, samples: int = 0) -> bytes:
    """What a replay writes; with samples, which numba computes where it is there."""
    values = read_parameters(TOSSES) | {"uncertainty.samples": samples, "uncertainty.friction": 0.02}
    result = replay(bag, Scene.from_parameters(validate(values)), REMAP, output)
    assert result.settled
    return output.read_bytes()


def test_three_runs_give_the_same_bytes(bag: Path, tmp_path: Path) -> None:
    first, second, third = (replayed(bag, tmp_path / f"{number}.mcap") for number in range(3))
    assert first == second == third


@pytest.mark.slow
def test_the_bytes_are_the_same_with_and_without_numba_and_whatever_the_order_of_sets(
    bag: Path, tmp_path: Path
) -> None:
    pytest.importorskip("numba")
    # Processes of their own: numba cannot be taken out of this one, nor the seed of its hashes be changed.
    paths = [str(Path(__file__).parents[1]), str(Path(__file__).parent / "bags")]
    for seed, numba in (("1", "without"), ("2", "with")):
        environment = os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(paths)}
        command = sys.executable, "-c", REPLAY, numba, str(bag), str(tmp_path / f"{numba}.mcap")
        subprocess.run(command, env=environment, check=True)
    assert (tmp_path / "with.mcap").read_bytes() == (tmp_path / "without.mcap").read_bytes()
