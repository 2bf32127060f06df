"""Commands that make scenario files: one to begin with, and one that is designed."""

from __future__ import annotations

import re
from pathlib import Path

import click

from scenarios.cli import options
from scenarios.errors import InputError


@click.command()
@click.argument("name")
@click.option("--law", is_flag=True, help="With a law of one's own, in a second file.")
def new(name: str, law: bool) -> None:
    """Write NAME.toml, a commented scenario of four robots to change, which runs as it is."""
    from scenarios.definition.files import starter
    from scenarios.definition.files.library import LIBRARY
    from scenarios.storage.files import write_whole

    name = name.removesuffix(".toml")
    if re.fullmatch(r"[A-Za-z0-9][\w-]*", name, re.ASCII) is None:
        raise InputError(f"new: expected a name of letters, digits, - and _, got {name[:40]!r}")
    law_file = f"{name.replace('-', '_')}_law.py" if law else None
    content = {Path(f"{name}.toml"): starter.scenario(name, law_file).encode()}
    if law_file is not None:
        content[Path(law_file)] = (LIBRARY / "bounded_angle_law.py").read_bytes()
    for path in content:
        if path.exists():
            raise InputError(f"new: {path} exists; take another name")
    for path, text in content.items():
        write_whole(path, text)
        click.echo(path)
    click.echo(f"run it: formation run {name}.toml")


@click.command("design")
@click.argument("target")
@click.option("--leaders", default="free", show_default=True, metavar="A,B", help="Two numbers, given, or free.")
@click.option("--edges", default="all", show_default=True, metavar="WHICH", help="all, given, or a CSV file of pairs.")
@click.option("--within", type=click.FloatRange(min=0.0, min_open=True), metavar="M", help="Sensing range, m.")
@click.option(
    "--sight", type=click.FloatRange(min=0.0, min_open=True), metavar="M", help="Radius that hides others, m."
)
@click.option(
    "--objective", default="both", show_default=True, type=click.Choice(["both", "settling", "noise"]),
    help="What the best graph has the least of.",
)  # fmt: skip
@options.seed("Seed of random starts.")
@options.changes
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Write the scenario to this file.")
@click.option("--force", is_flag=True, help="Replace the file of --out.")
def design(
    target: str,
    leaders: str,
    edges: str,
    within: float | None,
    sight: float | None,
    objective: str,
    seed: int,
    changes: tuple[str, ...],
    out: Path | None,
    force: bool,
) -> None:
    """Choose whom each robot of TARGET senses: a scenario (a name or a file), or a CSV file of places.

    Prints the candidates side by side, and writes a scenario with the best of them.
    """
    from scenarios.studies import design as designing
    from scenarios.terminal import new_console

    if out is not None and out.exists() and not force:
        raise InputError(f"--out {out}: exists, --force replaces it")
    console = new_console()
    found = designing.answer(designing.ask(target, changes, leaders, edges, within, sight, seed), objective)
    designing.print_answer(console, found)
    if out is not None:
        designing.write_scenario(found, out)
        console.print(f"scenario: {out}", markup=False)
