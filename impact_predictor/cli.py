"""The command `impact-predictor`."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from errno import EPIPE
from typing import Any, Final

import click

from . import __version__
from .commands.bench import bench
from .commands.calibrate import calibrate
from .commands.demo import demo
from .commands.explain import explain
from .commands.identify import identify
from .commands.lashings import lashings
from .commands.map import map_
from .commands.options import examples
from .commands.replay import replay
from .commands.report import report
from .commands.simulate import simulate
from .commands.solve import solve
from .errors import InputError, missing

WRONG_INPUT: Final = 2
"""Exit status after a wrong option, file or parameter."""

INTERRUPTED: Final = 130
"""Exit status after Ctrl-C, as shells have it."""


class Program(click.Group):
    """A group of commands that says what went wrong in one line, whichever of its commands it was."""

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Run a command and end the process with its exit status."""
        try:
            status = self._run(args, prog_name, complete_var, standalone_mode=False, **extra)
            sys.stdout.flush()
        except InputError as error:
            click.echo(f"error: {error}", err=True)
            status = WRONG_INPUT
        except click.ClickException as error:
            click.echo(f"error: {_sentence(error)}", err=True)
            status = error.exit_code
        except click.Abort:
            status = INTERRUPTED
        except OSError as error:
            # Files that cannot be written are an InputError; a reader of a pipe that has gone is click's matter.
            if error.errno == EPIPE or error.filename is not None:
                raise
            click.echo(f"error: the output cannot be written: {error.strerror or error}", err=True)
            # What is left of it cannot be written at the end of the process either.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            status = WRONG_INPUT
        sys.exit(status)

    def _run(self, *arguments: Any, **extra: Any) -> Any:
        try:
            return super().main(*arguments, **extra)
        except ModuleNotFoundError as error:
            raise missing(error.name or "") or error from error


def _sentence(error: click.ClickException) -> str:
    said = error.format_message().rstrip(".")
    option = error.param if isinstance(error, click.BadParameter) else None
    if option is not None and option.nargs > 1:
        said += f", and {option.opts[0]} takes {option.metavar}"
    context = error.ctx if isinstance(error, click.UsageError) else None
    return said if context is None else f"{said}; see `{context.command_path} --help`"


@click.group(
    cls=Program,
    no_args_is_help=False,
    epilog=examples(
        "impact-predictor demo",
        "impact-predictor solve plate --length 1 --height 0.4 --mass 10 --friction 0.2 --omega -1",
        "impact-predictor map plate",
        "impact-predictor simulate rod --a 0.1 --a 0.075 --a 0.05 --plot rods.png",
        "impact-predictor replay examples/cube_tosses --params config/cube_tosses.yaml -o predictions.mcap",
    ),
)
@click.version_option(__version__, prog_name="impact-predictor", message="%(prog)s %(version)s")
def main() -> None:
    """Predict the next touchdown of a body, and what the impact does to it."""


for _command in (demo, solve, map_, simulate, replay, identify, calibrate, lashings, explain, report, bench):
    main.add_command(_command)
