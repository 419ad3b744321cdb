"""A word on standard error while numba compiles, which it does once on each machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

import click

NOTE: Final = "note: compiling the impact laws, once for this machine (about 15 s)"


@contextmanager
def compiling_is_said() -> Iterator[None]:
    """Say so when numba compiles meanwhile, instead of taking what it compiled before."""
    try:
        from numba.core import event
    except ImportError:
        yield
        return

    class Say(event.Listener):
        said = False

        def on_start(self, event: Any) -> None:
            if not self.said:
                self.said = True
                click.echo(NOTE, err=True)

        def on_end(self, event: Any) -> None:
            """Nothing is said then."""

    with event.install_listener("numba:compile", Say()):
        yield
