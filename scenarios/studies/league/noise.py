"""Noise without distances: what bearings and one ratio make of it, beside eq. (u) with the same sensors.

Near its places the ratio law is a cascade like eq. (u), with the rates s / (abs(e_ki) + abs(e_kj)): one formula gives
the covariance of both. "5 %" may be of the ratio or of each of its two distances, which is the square root of two
times as much; and as this law's rates rise with its speed and fall with size, both belong to every figure.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from formation import TargetFormation, agents, decay_rates
from formation.analysis.cascade import Cascade
from formation.analysis.noise import covariance, noise_power
from formation.plane import as_complex
from scenarios.definition.experiment import Experiment

Real = NDArray[np.float64]

BEARING = float(np.radians(1.0))
"""Standard deviation of a bearing, radians."""

SHARE = 0.05
"""Of the ratio, or of each of its two distances."""

PERIOD = 0.033
"""Seconds between draws."""


FIRST = {"ratio": (6.5, 5.0, 8.3, 8.2), "angle": (7.2, 6.6, 11.5, 11.6)}
"""Millimetres, of followers 3 to 6: what a first computation by other code gave for the paper's shape."""

WITHIN = 0.02
"""Relative difference from those that its own noise explains."""


MANY = 8
"""Followers that a row has room for."""

COLUMNS = ("law", "5 % of", "size (m)", "s (m/s)", "rms (mm), followers 3, 4, ...", "")


@dataclass(frozen=True)
class Reading:
    """One way to read "a degree and 5 %".

    Attributes:
        law: ``ratio`` or ``angle``.
        each: whether both distances are disturbed, instead of their ratio alone; eq. (u) then has its first distance
            as it is, and its second as the ratio gives it.
        size: metres between agents 1 and 2.
        speed: s of the ratio law, m/s; eq. (u) has none.
    """

    law: str
    each: bool
    size: float
    speed: float = 0.0


def readings(*sizes: float) -> list[Reading]:
    """Those of the page, for both laws."""
    ratio = [Reading("ratio", each, size, speed) for size in sizes for speed in (0.5, 1.0) for each in (False, True)]
    return [*ratio, *(Reading("angle", each, size) for size in sizes for each in (False, True))]


def loop(formation: TargetFormation, reading: Reading) -> tuple[Cascade, Real]:
    """The linear loop, and the (n, 2) places, metres, of its agents."""
    places = formation.positions
    places = places * (reading.size / float(np.linalg.norm(places[1] - places[0])))
    cascade = Cascade.of(formation)
    rates = decay_rates(formation)
    if reading.law == "ratio":
        rates = reading.speed / _lengths(formation, places)[1:].reshape(-1, 2).sum(axis=1)
    return Cascade(cascade.graph, cascade.weights, np.concatenate([[0.0], rates])), places


def rms(formation: TargetFormation, reading: Reading) -> Real:
    """(n,) root mean square distance of each agent from its mean place, metres."""
    cascade, places = loop(formation, reading)
    power = noise_power(cascade, places, 0.0, BEARING)
    disturbed = np.zeros(len(power), dtype=bool)
    disturbed[2::2] = True
    if reading.each:
        disturbed[1::2] = True
    power = power + np.where(disturbed, (SHARE * _lengths(formation, places)) ** 2, 0.0)
    return np.sqrt(np.diagonal(covariance(cascade, PERIOD, power)).real)


def _lengths(formation: TargetFormation, places: Real) -> Real:
    observer, observed = formation.graph.edges.T
    return np.abs(as_complex(places[observed] - places[observer]))


def table(experiment: Experiment, papers: bool) -> list[tuple[str, ...]]:
    """Rows of :data:`COLUMNS`, at the sizes of the scenario's start and of its target.

    Args:
        experiment: eq. (u) on the scenario's own graph.
        papers: whether the target is the paper's, and the last column says which rows are the first computation's.
    """
    start, star = experiment.initial_points(0), experiment.target.positions
    sizes = {round(float(np.linalg.norm(p[1] - p[0])), 6) for p in (start, star)}
    rows: list[tuple[str, ...]] = []
    for reading in readings(*sorted(sizes)):
        found = 1e3 * rms(experiment.target, reading)[agents.FIRST_ORDINARY :]
        first = papers and bool(np.abs(found / FIRST[reading.law] - 1.0).max() < WITHIN)
        rows.append(
            (
                reading.law,
                "each distance" if reading.each else "the ratio",
                f"{reading.size:.2f}",
                f"{reading.speed:g}" if reading.speed else "-",
                " ".join(f"{each:.1f}" for each in found[:MANY]),
                "as first" if first else "",
            )
        )
    return rows
