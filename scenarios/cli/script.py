"""The command that runs scripts written for the Robotarium."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from scenarios.cli import options
from scenarios.cli.exits import DONE, INTERRUPTED, MISSED

if TYPE_CHECKING:
    from robots.rps.hook import Version
    from robots.rps.session import Start

LONGEST = 3600.0
"""Simulated seconds, after which a script without an end is stopped: more than 20 times the longest example."""


@click.command()
@click.argument("file", metavar="FILE.py", type=click.Path(path_type=Path))
@click.argument("arguments", nargs=-1, metavar="[-- ARGS]")
@click.option("--plant", default="pymunk", show_default=True, metavar="P", help="unicycle, saturated or pymunk.")
@options.seed("Seed of numpy's and Python's global generators when the script begins.")
@click.option("--measured", is_flag=True, help="With robots as logs and firmware show them.")
@click.option("--drive-to-start", "driven", is_flag=True, help="Begin at the chargers, as on the testbed.")
@click.option("--near-start", "near", is_flag=True, help="Begin anywhere within the testbed's tolerance of the start.")
@click.option(
    "--duration",
    type=click.FloatRange(min=0.0, min_open=True),
    default=LONGEST,
    metavar="S",
    help="Stop it after S simulated seconds.  [default: 3600]",
)
@click.option("--rps", "version", type=click.Choice(["1", "2"]), help="Generation.  [default: what its names say]")
@options.out("Run folder.  [default: runs/FILE-PLANT-seedN]")
@click.option("--recording/--no-recording", "recorded", default=True, help="Whether to write recording.rrd.")
@click.option("--live", is_flag=True, help="Watch the run in a viewer, one that is open or a new one.")
@click.option("--show", "on_screen", is_flag=True, help="Show the script's own figures while it runs.")
def script(
    file: Path,
    arguments: tuple[str, ...],
    plant: str,
    seed: int,
    measured: bool,
    driven: bool,
    near: bool,
    duration: float,
    version: str | None,
    out: Path | None,
    recorded: bool,
    live: bool,
    on_screen: bool,
) -> None:
    """Run FILE.py, a script for the Robotarium, unchanged, and write its run folder.

    It needs nothing of the public simulator: `import rps` gets ours, of its generation 1 or 2. Exit code 1 where it
    raises, or where the testbed would reject it.
    """
    from scenarios.errors import InputError
    from scenarios.scripts.one_script import Settings, run_script
    from scenarios.simulation.script.script_file import read
    from scenarios.terminal import new_console

    if driven and near:
        raise InputError("--near-start: not together with --drive-to-start")
    start: Start = "driven" if driven else "near" if near else "exact"
    settings = Settings(plant, seed, start, duration, recorded, live, on_screen, measured)
    generations: dict[str | None, Version | None] = {None: None, "1": 1, "2": 2}
    ending, accepted = run_script(read(file, generations[version]), arguments, settings, out, new_console())
    code = INTERRUPTED if ending.outcome == "interrupted" else ending.code or (DONE if accepted else MISSED)
    if code != DONE:
        raise SystemExit(MISSED if code not in (INTERRUPTED, MISSED) else code)
