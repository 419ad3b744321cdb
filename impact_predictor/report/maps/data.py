"""A map of modes as data: CSV, and the shares of the modes."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from ...errors import InputError
from ...mechanics.impact import states_of
from ...mechanics.types import Mode
from ..table import plain_table
from .modes import ModeMap, middles, shares
from .words import MEANINGS, hatched


def write_csv(path: Path, modes: ModeMap) -> None:
    """Write a line for each cell: its parameters, and the fields of a ModeMap.

    Raises:
        InputError: the file cannot be written.
    """
    rows, columns = modes.mode.shape
    x = middles(modes.x, columns).tolist()
    names = [mode.name for mode in Mode]
    header = (
        *(modes.x.name, modes.y.name, "mode", "segments", "unique", "jammed", "path_unique", "total_unique"),
        *("omega_ratio", "energy_lost"),
    )
    truths = (modes.unique, modes.jammed, modes.path_unique, modes.total_unique)
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(header)
            for row, y in enumerate(middles(modes.y, rows).tolist()):
                writer.writerows(
                    zip(
                        x,
                        [y] * columns,
                        [names[mode] for mode in modes.mode[row]],
                        [" ".join(states_of(code)) for code in modes.segments[row].tolist()],
                        *(field[row].astype(int).tolist() for field in truths),
                        modes.omega_ratio[row].tolist(),
                        modes.energy_lost[row].tolist(),
                        strict=True,
                    )
                )
    except OSError as error:
        raise InputError(f"{path} cannot be written: {error.strerror or error}") from error


def summary_of(modes: ModeMap) -> dict[str, Any]:
    """What a map shows, in the names and units of the command line: shares are parts of its area."""
    return {
        "body": modes.subject,
        "law": modes.law,
        "x": modes.x._asdict(),
        "y": modes.y._asdict(),
        "fixed": modes.fixed,
        "resolution": modes.mode.shape[0],
        "shares": {mode.name: share for mode, share in shares(modes).items()},
        "jammed": float(np.mean(modes.jammed)),
        "path_not_unique": float(np.mean(~modes.path_unique)),
        "total_not_unique": float(np.mean(~modes.total_unique)),
    }


def table_of(modes: ModeMap) -> Table:
    """The modes of a map, and how much of it each takes."""
    table = plain_table()
    table.add_column("mode", no_wrap=True)
    table.add_column("% of the map", justify="right", no_wrap=True)
    table.add_column("")
    for mode, share in shares(modes).items():
        table.add_row(mode.name, f"{100.0 * share:.1f}", MEANINGS[mode])
    for region, meaning in hatched(modes):
        if region.any():
            table.add_row("", f"{100.0 * np.mean(region):.1f}", meaning)
    return table
