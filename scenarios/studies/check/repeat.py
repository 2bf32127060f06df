"""``formation check``: run what baselines say, compare, and leave the worst misses as run folders."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from scenarios.definition.load import load
from scenarios.one_run import run_to_folder
from scenarios.studies.check import baseline as baselines
from scenarios.studies.check.baseline import Baseline
from scenarios.studies.check.compare import Comparison, compare, worst_first
from scenarios.studies.check.execute import Job, execute
from scenarios.studies.check.machine import fingerprint, same_bits

MOST_FOLDERS = 5
"""Run folders that are written for misses: those of the worst."""


@dataclass(frozen=True)
class Opened:
    """A baseline with the scenario that it belongs to.

    Attributes:
        name: of the scenario.
        source: the library name or path that opens it.
        baseline: the file's content.
        exact: whether this machine has to give the same bits.
    """

    name: str
    source: str
    baseline: Baseline
    exact: bool

    @property
    def jobs(self) -> list[Job]:
        return [Job(self.source, run.plant, run.seed, run.changes) for run in self.baseline.runs]


@dataclass(frozen=True)
class Check:
    """The outcome of a whole comparison.

    Attributes:
        comparisons: in the order of the baselines.
        notes: what a reader of a miss should know: other versions, another machine, a changed scenario.
    """

    comparisons: tuple[Comparison, ...]
    notes: tuple[str, ...]

    @property
    def missed(self) -> list[Comparison]:
        """The runs that missed, the one with the worst angle first."""
        return list(dict.fromkeys(comparison for comparison, _ in worst_first(self.comparisons)))

    @property
    def summary(self) -> str:
        runs = f"{len(self.comparisons)} run{'s' if len(self.comparisons) != 1 else ''}"
        return f"{runs}, {len(self.missed)} missed" if self.missed else f"{runs}, all as before"


def open_baselines(scenarios: Sequence[str], folder: Path, portable: bool) -> list[Opened]:
    """The baselines of these scenarios, of all that the folder holds where none are named.

    Args:
        scenarios: library names or paths.
        folder: of the baselines.
        portable: allow what another machine may differ by, whatever this machine is.

    Raises:
        InputError: a baseline is missing, damaged or of another schema, or its scenario cannot be read.
    """
    here = fingerprint()
    names = [load(scenario).name for scenario in scenarios]  # a misspelt scenario is named before its baseline
    paths = [baselines.path_of(s, folder) for s in scenarios] or baselines.baselines_in(folder)
    files = [baselines.read(path) for path in paths]
    sources = list(scenarios) or [baselines.scenario_of(file, folder) for file in files]
    names = names or [load(source).name for source in sources]
    return [
        Opened(name, source, file, exact=not portable and same_bits(file.machine, here))
        for name, source, file in zip(names, sources, files, strict=True)
    ]


def check(opened: Sequence[Opened], workers: int, on_progress: Callable[[int, int], None]) -> Check:
    """Make every run and compare it.

    Raises:
        InputError: a scenario or a change cannot be used, known before anything runs.
    """
    done = execute([job for entry in opened for job in entry.jobs], workers, on_progress)
    comparisons = [
        Comparison(entry.name, entry.source, run, compare(run, done[job].measures, entry.exact), done[job].seconds)
        for entry in opened
        for run, job in zip(entry.baseline.runs, entry.jobs, strict=True)
    ]
    return Check(tuple(comparisons), tuple(_notes(opened)))


def _notes(opened: Sequence[Opened]) -> list[str]:
    here = fingerprint()
    notes = []
    exact = [entry for entry in opened if entry.exact]
    if exact:
        notes.append("this machine made the baselines: runs have to be bit-identical; --portable allows the spread")
    others = {
        f"{key} {entry.baseline.machine.get(key, 'not recorded')}, here {value}"
        for entry in opened
        if not entry.exact
        for key, value in here.items()
        if entry.baseline.machine.get(key) != value
    }
    if others:
        notes.append(f"baselines of another machine, the measured spread is allowed: {'; '.join(sorted(others))}")
    changed = [entry.name for entry in opened if load(entry.source).sha256 != entry.baseline.scenario_sha256]
    if changed:
        notes.append(f"scenarios changed since their baselines: {', '.join(changed)}")
    return notes


def write_folders(missed: Sequence[Comparison], out: Path) -> dict[Comparison, Path]:
    """Run the worst misses again, into run folders that ``formation replay`` opens.

    Raises:
        InputError: a folder cannot be written.
    """
    folders = {}
    for comparison in missed[:MOST_FOLDERS]:
        run = comparison.run
        parts = (comparison.scenario, run.plant, *(re.sub(r"[^\w.=-]", "", c)[:60] for c in run.changes))
        folder = out / f"{'-'.join(parts)}-seed{run.seed}"
        experiment = Job(comparison.source, run.plant, run.seed, run.changes).open()
        run_to_folder(experiment, run.seed, folder, Console(quiet=True))
        folders[comparison] = folder
    return folders
