"""Who takes part: each law on the graph that it needs, built from the scenario's target, and a few second variants."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from formation import LAWS, Framework, Law, SensingGraph, TargetFormation, needs
from formation.analysis.flow import SMALLEST_STEP
from formation.graph.conditions import CONDITIONS
from formation.graph.designs import DESIGNS, design
from formation.measurements import ANGLE, RATIO
from robots import Instruments
from scenarios.definition.experiment import Experiment
from scenarios.definition.formations import TRIANGLE, Aim
from scenarios.errors import InputError, did_you_mean

HORIZON = 120.0
"""Seconds until which a law has to be right."""


@dataclass(frozen=True)
class Entry:
    """One row of the league.

    Attributes:
        law: its name.
        graph: what its graph is built by, where it is not its own condition.
        parameters: of the law.
        horizon: seconds.
        note: what tells it from another row of the same law.
    """

    law: str
    graph: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)
    horizon: float = HORIZON
    note: str = ""

    @property
    def smallest_step(self) -> float:
        """Seconds; longer for laws that jump, or know no bound, where agents meet."""
        return COARSE if self.law in JUMPING else SMALLEST_STEP

    @property
    def name(self) -> str:
        """How tables name it."""
        return f"{self.law} ({self.note})" if self.note else self.law


JUMPING = frozenset({"bearing", "bearing-undirected", "ratio", "bisector", "persistent", "cosine", "triangle-angles"})
COARSE = 0.02
"""Seconds, below the robots' control period; the laws whose steps need not be smaller."""

SLOW = {"bearing": 300.0, "ratio": 300.0}
"""Horizons, seconds, of laws that need another one."""

VARIANTS = (
    Entry("cosine", "triangulated Laman", note="Laman"),
    Entry("triangular", "triangulated Laman", note="Laman"),
    Entry("bisector", parameters={"wrapped": 1.0}, note="wrapped"),
    Entry("laplacian", "two-rooted", note="cycles, D designed"),
    Entry("laplacian", "two-rooted", parameters={"designed": 0.0}, note="cycles, D = 1"),
)


def chosen(names: tuple[str, ...] = ()) -> list[Entry]:
    """All rows, or those of the laws named: each law as it is, then its variants.

    Raises:
        InputError: no law has that name.
    """
    for name in names:
        if name not in LAWS:
            raise InputError(f"--law: no such law {name!r}, {did_you_mean(name, LAWS)}")
    rows = []
    for name in names or LAWS:
        if name != "laplacian":  # on a graph without cycles it is the angle law with other gains
            rows.append(Entry(name, horizon=SLOW.get(name, HORIZON)))
        rows += [variant for variant in VARIANTS if variant.law == name]
    return rows


@dataclass(frozen=True, eq=False)
class Player:
    """A row, ready to run.

    Attributes:
        entry: the row.
        law: the law.
        formation: the target with the law's graph.
    """

    entry: Entry
    law: Law
    formation: Framework


def player(entry: Entry, formation: Framework) -> Player:
    """The row's law on its own kind of graph.

    Args:
        entry: the row.
        formation: the target, with the graph that the scenario gives.

    Raises:
        ValueError: no such graph can be built from the target, or the law cannot be made on it.
    """
    make: Any = LAWS[entry.law]
    if make.graph == TRIANGLE and formation.graph.n > 3:
        formation = TargetFormation(SensingGraph(np.array([[0, 1]])), formation.positions[:3])
    if entry.graph:
        designed = Framework(DESIGNS[entry.graph](formation), formation.positions)
        CONDITIONS[make.graph](designed)
    else:
        designed = design(make.graph, formation)
    return Player(entry, make(designed, **entry.parameters), designed)


def on_robots(experiment: Experiment, one: Player) -> Experiment:
    """The experiment with a row's law, graph and instruments in place of its own."""
    kinds, graph = needs(one.law).measures, one.formation.graph
    corners = graph.corners if {ANGLE, RATIO} & set(kinds) else ()
    instruments = Instruments(graph.edges, corners, kinds, experiment.instruments.imperfections)
    target = one.formation if isinstance(one.formation, TargetFormation) else None
    aim = Aim(one.formation, target, experiment.angles, experiment.target_angles)
    return replace(experiment, aim=aim, law=one.law, instruments=instruments)
