"""Copies of a run from starts that differ in the twelfth digit: how much of that is left at the end?"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scenarios.definition.experiment import Experiment
from scenarios.definition.starts import Real, Starts

PERTURBATION = 1e-12
"""Relative; some ten thousand roundings of a double, more than a run's own add up to."""

COPIES = 4
"""Perturbed copies of each run from which its spread is measured."""


@dataclass(frozen=True, eq=False)
class PerturbedStarts(Starts):
    """Starts of which every coordinate and heading is off by up to :data:`PERTURBATION`, relative.

    Attributes:
        copy: which of the copies.
    """

    copy: int = 0

    def draw(self, rng: np.random.Generator) -> tuple[Real, Real]:
        nudge = np.random.default_rng(self.copy)  # its own, so that the run draws what it always draws
        points, headings = super().draw(rng)
        return _nudged(points, nudge), _nudged(headings, nudge)


def _nudged(values: Real, rng: np.random.Generator) -> Real:
    return values * (1.0 + PERTURBATION * rng.uniform(-1.0, 1.0, values.shape))


def perturbed(experiment: Experiment, copy: int) -> Experiment:
    """The experiment from perturbed starts; copy 0 is the experiment itself."""
    if copy == 0:
        return experiment
    starts = experiment.starts
    return replace(
        experiment, starts=PerturbedStarts(starts.path, starts.points, starts.headings, starts.random, copy=copy)
    )
