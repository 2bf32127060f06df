"""``formation check --update``: make baselines anew, with the spread of each run over perturbed copies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from scenarios.definition.experiment import open_experiment
from scenarios.studies.check import baseline as baselines
from scenarios.studies.check.baseline import Baseline, LeftOut, Run
from scenarios.studies.check.compare import Comparison, compare
from scenarios.studies.check.execute import Done, Job, execute
from scenarios.studies.check.machine import fingerprint
from scenarios.studies.check.perturbed import COPIES
from scenarios.studies.check.quantities import distance, is_angle, tolerance

REPRODUCIBLE = 2.5e-4
"""Radians: a run whose angles need a larger tolerance is left out. A thousandth of a radian has to be seen."""


@dataclass(frozen=True)
class Update:
    """A baseline that was made anew.

    Attributes:
        scenario: its name.
        path: of the file.
        baseline: its new content.
        changed: each run that was there before, beside what it was before.
        added, removed: number of runs that were not there before, or are not there any more.
    """

    scenario: str
    path: Path
    baseline: Baseline
    changed: tuple[Comparison, ...]
    added: int
    removed: int


def update(source: str, folder: Path, workers: int, on_progress: Callable[[int, int], None]) -> Update:
    """Make the baseline of one scenario anew; the cases of an existing one are kept.

    Raises:
        InputError: the scenario or the existing baseline cannot be used, or the new one cannot be written.
    """
    experiment = open_experiment(source)
    name, path = experiment.file.name, baselines.path_of(source, folder)
    old = baselines.read(path) if path.exists() else None
    cases = old.cases if old is not None else baselines.default_cases(experiment)
    jobs = [Job(source, case.plant, seed, case.changes) for case in cases for seed in case.seeds]
    copies = {job: [Job(job.source, job.plant, job.seed, job.changes, c) for c in range(1, COPIES + 1)] for job in jobs}
    done = execute([*jobs, *(copy for group in copies.values() for copy in group)], workers, on_progress)
    runs, left_out = [], []
    for job in jobs:
        period = job.open().scenario.plant.control_period_s
        run = _with_tolerances(job, done[job], [done[copy] for copy in copies[job]], period)
        if isinstance(run, Run):
            runs.append(run)
        else:
            left_out.append(run)
    new = Baseline(
        schema_version=baselines.SCHEMA_VERSION,
        scenario=baselines.reference(source, folder),
        scenario_sha256=experiment.file.sha256,
        machine=fingerprint(),
        cases=cases,
        runs=tuple(runs),
        left_out=tuple(left_out),
    )
    baselines.write(path, new)
    before = {} if old is None else {run.key: run for run in old.runs}
    changed = tuple(
        Comparison(name, source, before[run.key], compare(before[run.key], done[job].measures, exact=True), 0.0)
        for job in jobs
        for run in runs
        if run.key == (job.plant, job.seed, job.changes) and run.key in before
    )
    removed = len(before.keys() - {run.key for run in runs})
    return Update(name, path, new, changed, len(runs) - len(changed), removed)


def _with_tolerances(job: Job, done: Done, copies: list[Done], control_period: float) -> Run | LeftOut:
    """The run with how far another machine may be off; why it is left out where that is too far."""
    found, others = done.measures, [copy.measures for copy in copies]

    def left_out(reason: str) -> LeftOut:
        return LeftOut(plant=job.plant, seed=job.seed, changes=job.changes, reason=reason)

    for name, text in found.texts.items():
        differing = next((other.texts[name] for other in others if other.texts[name] != text), None)
        if differing is not None:
            return left_out(f"{name} is {text!r}, and {differing!r} from a start that differs by rounding")
    numbers = {}
    for name, value in found.numbers.items():
        spread = max(distance(name, value, other.numbers.get(name)) for other in others)
        allowed = tolerance(name, spread, control_period)
        if (is_angle(name) and allowed > REPRODUCIBLE) or allowed == float("inf"):
            return left_out(f"{name} differs by {spread:.1e} from starts that differ by rounding")
        numbers[name] = (value, allowed)
    return Run(plant=job.plant, seed=job.seed, changes=job.changes, numbers=numbers, texts=found.texts)
