"""The command ``formation``: its families of commands, and what becomes of an error."""

from __future__ import annotations

import gc
import io
import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

import click

from scenarios.cli import design, draw, export, look, many, run, script, study, testbed
from scenarios.cli.exits import BAD_INPUT, INTERRUPTED, MISSED
from scenarios.errors import InputError, did_you_mean, plain

FAMILIES: tuple[tuple[click.Command, ...], ...] = (
    (look.list_command, look.show, look.keys),
    (run.run, run.replay),
    (draw.plot, draw.animate, draw.table),
    (many.sweep_command, many.check),
    (study.laws, study.audit, study.reproduce),
    (design.new, design.design),
    (export.export,),
    (script.script,),
    (testbed.identify, testbed.adopt, testbed.ladder_command, testbed.calibrate, testbed.testbed_page),
)
"""All commands, a family a file."""

THREADS = ("OPENBLAS_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS")
"""Variables that tell numpy's OpenBLAS how many threads it may have, the first of them before the others."""

WHOLE = 1000
"""Characters of a sentence, at most."""


class Commands(click.Group):
    """The commands, with the nearest name for a misspelt one."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and not args[0].startswith("-") and args[0] not in self.commands:
            raise InputError(f"command: no command named {args[0]!r}, {did_you_mean(args[0], self.commands)}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The first sentence of each command as a whole, which click itself cuts off at the end of the line."""
        with formatter.section("Commands"):
            known = sorted(self.commands.items())
            formatter.write_dl([(name, command.get_short_help_str(WHOLE)) for name, command in known])


@click.group(
    cls=Commands,
    commands=[command for family in FAMILIES for command in family],
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(package_name="angle-formation")
@click.pass_context
def cli(ctx: click.Context) -> None:
    """Angle-constrained formation control of differential-drive robots."""
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


def main() -> None:
    """Run the command line: errors on one line on stderr, never a traceback for bad input."""
    gc.set_threshold(50_000, 20, 50)  # loading packages makes objects and frees none: searching them costs 0.2 s a run
    _think_in_one_thread()
    _show_what_the_terminal_can()
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # not that its folder is a temporary one
    try:
        with _written_whole():
            cli.main(standalone_mode=False)
    except InputError as error:
        _fail(str(error))
    except click.ClickException as error:
        _fail(error.format_message())
    except click.Abort:
        sys.exit(INTERRUPTED)


def _think_in_one_thread() -> None:
    """Unless the user says how many threads numpy may have: matrices here are small, and idle threads wait at work.

    It is known before numpy is loaded, and to the processes that this one starts.
    """
    if not any(name in os.environ for name in THREADS):
        os.environ[THREADS[0]] = "1"


def _show_what_the_terminal_can() -> None:
    """Where it has only some characters, ASCII say, others become question marks."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


@contextmanager
def _written_whole() -> Iterator[None]:
    """Make sure that all that the block prints is written, however it ends.

    Raises:
        InputError: it cannot be: the disk is full.
        SystemExit: nobody reads it any more.
    """
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
    except OSError as error:
        if error.filename is not None:  # not of a stream, which has no name
            raise
        # What is left in the buffer would fail again, and be reported, when the interpreter ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            sys.exit(MISSED)
        raise InputError(f"the output cannot be written: {error.strerror}") from error


def _fail(message: str) -> None:
    click.echo(f"formation: {plain(' '.join(message.split()))}", err=True)
    sys.exit(BAD_INPUT)
