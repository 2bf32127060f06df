"""The runs of a comparison, spread over processes."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.measures.metrics import measure
from scenarios.measures.result import result
from scenarios.simulation.compiling import compile_for
from scenarios.simulation.loop import simulate
from scenarios.simulation.schedule import count_periods
from scenarios.studies.check.perturbed import perturbed
from scenarios.studies.check.quantities import Measures, measures
from scenarios.work.processes import run_all


@dataclass(frozen=True)
class Job:
    """One run to make.

    Attributes:
        source: a scenario's library name or path.
        plant, seed, changes: of the run.
        copy: 0 for the run itself, else the number of a perturbed copy.
    """

    source: str
    plant: str
    seed: int
    changes: tuple[str, ...] = ()
    copy: int = 0

    def open(self) -> Experiment:
        """The experiment that the job runs.

        Raises:
            InputError: the scenario, or a change, cannot be used.
        """
        return open_experiment(self.source, (*self.changes, f'plant.name="{self.plant}"'))


@dataclass(frozen=True)
class Done:
    """What is compared of a finished job, and the seconds that it took."""

    measures: Measures
    seconds: float


def execute(jobs: Sequence[Job], workers: int, on_progress: Callable[[int, int], None]) -> dict[Job, Done]:
    """Make the runs, the longest first so that no worker is left with one at the end.

    Raises:
        InputError: a job cannot be opened or its starts cannot be drawn, known before anything runs.
    """
    queue = sorted(jobs, key=_cost, reverse=True)
    for job in {job.plant: job for job in queue}.values():
        compile_for(job.open())
    done = {}
    for count, (job, finished) in enumerate(zip(queue, run_all(_run, queue, workers), strict=True), start=1):
        done[job] = finished
        on_progress(count, len(queue))
    return done


def _cost(job: Job) -> float:
    experiment = job.open()
    experiment.initial_points(job.seed)
    stages = 4 if job.plant == "single_integrator" else 1
    return stages * (experiment.n + 50) * count_periods(experiment)


def _run(job: Job) -> Done:
    start = time.perf_counter()
    experiment = perturbed(job.open(), job.copy)
    trajectory = simulate(experiment, job.seed)
    summary = result(experiment, job.seed, trajectory, measure(experiment, trajectory))
    return Done(measures(summary), time.perf_counter() - start)
