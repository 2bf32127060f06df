"""The command ``formation check``: its order of events, so that nothing that was computed is lost."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from rich.console import Console

from scenarios.definition.files.library import library
from scenarios.errors import InputError
from scenarios.storage.files import prove_writable, write_text
from scenarios.studies.check import baseline
from scenarios.studies.check.repeat import check, open_baselines, write_folders
from scenarios.studies.check.reports import as_json, junit, markdown
from scenarios.studies.check.tables import print_check, print_folders, print_update
from scenarios.studies.check.update import update
from scenarios.terminal import progress_bar
from scenarios.work.processes import available_workers

STEP_SUMMARY = "GITHUB_STEP_SUMMARY"
"""The environment variable with the file that GitHub shows under a job."""


def check_command(
    scenarios: tuple[str, ...],
    folder: Path | None,
    portable: bool,
    junit_path: Path | None,
    markdown_path: Path | None,
    out: Path,
    workers: int | None,
    console: Console,
    tell: Callable[[str], None] | None = None,
) -> bool:
    """Compare, print, write reports and run folders; ``tell`` gets the comparison as JSON.

    Returns:
        Whether every run is as its baseline says.

    Raises:
        InputError: a baseline, scenario or report cannot be used. Reports are tried before anything runs; what fails
            later fails after the tables are printed and everything else is written.
    """
    opened = open_baselines(scenarios, folder or baseline.FOLDER, portable)
    if not opened:
        raise InputError(f"--baselines {folder or baseline.FOLDER}: holds no baseline, `--update` makes them")
    reports = [(path, option) for path, option in ((junit_path, "--junit"), (markdown_path, "--markdown")) if path]
    for path, option in reports:
        prove_writable(path, option)
    with progress_bar(console, "check") as advance:
        outcome = check(opened, workers or available_workers(), advance)
    print_check(console, outcome)
    failures = []
    folders = {}
    try:
        folders = write_folders(outcome.missed, out)
    except InputError as error:
        failures.append(error)
    print_folders(console, outcome, folders)
    if tell is not None:
        tell(as_json(outcome, folders))
    for path, option in reports:
        text = junit(outcome, folders) if option == "--junit" else markdown(outcome, folders)
        try:
            write_text(path, text, option)
        except InputError as error:
            failures.append(error)
    if summary := os.environ.get(STEP_SUMMARY):
        try:
            with open(summary, "a", encoding="utf-8") as file:
                file.write(markdown(outcome, folders))
        except OSError as error:
            failures.append(InputError(f"{STEP_SUMMARY} {summary}: cannot be written: {error.strerror}"))
    if failures:
        raise failures[0]
    return not outcome.missed


def update_command(scenarios: tuple[str, ...], folder: Path | None, workers: int | None, console: Console) -> None:
    """Make baselines anew, one scenario after another, each written as soon as it is made.

    Raises:
        InputError: a baseline or scenario cannot be used, or a baseline cannot be written.
    """
    place = folder or baseline.FOLDER
    sources = list(scenarios) or (library() if folder is None else _all_in(place))
    for source in sources:
        with progress_bar(console, source) as advance:
            made = update(source, place, workers or available_workers(), advance)
        print_update(console, made)


def _all_in(folder: Path) -> list[str]:
    return [baseline.scenario_of(baseline.read(path), folder) for path in baseline.baselines_in(folder)]
