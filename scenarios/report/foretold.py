"""What is known of an experiment before it runs, for programs: what ``formation show --json`` prints."""

from __future__ import annotations

from typing import Any

import numpy as np

from formation import agents, decay_rates, end_similarity, needs
from scenarios.definition.experiment import Experiment
from scenarios.measures.late_rates import expected_late_rates
from scenarios.measures.predictions.forecast import forecast
from scenarios.measures.predictions.remarks import remarks
from scenarios.report.cells import chosen
from scenarios.simulation.compiled.ability import unable

SCHEMA_VERSION = 1


def foretold(experiment: Experiment, seed: int) -> dict[str, Any]:
    """Graph, angles, rates and ends, units in the names; None where nothing is predicted.

    Of more phases than a table tells of, those that it tells of.
    """
    start = experiment.initial_points(seed)
    return {
        "schema_version": SCHEMA_VERSION,
        "scenario": experiment.file.name,
        "title": experiment.scenario.title,
        "scenario_sha256": experiment.file.sha256,
        "plant": experiment.plant,
        "safety": experiment.safety,
        "law": experiment.scenario.law.name,
        "graph": needs(experiment.law).graph,
        "goal_rad": experiment.goal,
        "agents": _agents(experiment, start),
        "phases": _phases(experiment, start) if experiment.predicted else None,
        "angles": [
            {"name": name, "target_deg": value}
            for name, value in zip(experiment.angle_names, np.degrees(experiment.target_angles).tolist(), strict=True)
        ],
        "remarks": list(remarks(experiment, seed)),
        "sweep_is_compiled": unable(experiment) is None,
    }


def _agents(experiment: Experiment, start: Any) -> list[dict[str, Any]]:
    described: list[dict[str, Any]] = [
        {
            "id": experiment.number(row),
            "senses": [experiment.number(i) for k, i in experiment.graph.edges if k == row],
            "start_m": start[row].tolist(),
        }
        for row in range(experiment.n)
    ]
    if experiment.formation is experiment.aim.target:  # the paper's graph
        target = experiment.target
        late = expected_late_rates(experiment, start)
        for follower, row in enumerate(target.graph.followers.tolist()):
            described[row] |= {
                "follower_angle_deg": float(np.degrees(target.follower_angles[follower])),
                "rate_per_s": float(decay_rates(target)[follower]),
                "late_rate_per_s": None if late is None else late[follower],
            }
    return described


def _phases(experiment: Experiment, start: Any) -> list[dict[str, Any]]:
    shown = chosen(len(experiment.phases))
    predicted = forecast(experiment, start, shown)
    ends = np.cumsum([phase.duration for phase in experiment.phases])
    described = []
    for index in shown:
        phase, ahead = experiment.phases[index], predicted[index]
        similarity = end_similarity(experiment.of_phase(index).formation, *ahead.end[: agents.FIRST_ORDINARY])
        described.append(
            {
                "name": phase.name,
                "until_s": float(ends[index]),
                "velocity_m_s": [float(part) for part in phase.velocity],
                "displacement_m": None if phase.delta is None else [float(part) for part in phase.delta],
                "scale": float(similarity.scale),
                "turn_deg": float(np.degrees(similarity.angle)),
                "end_m": ahead.end.tolist(),
                "angle_error_sum_rad": ahead.error_sum,
                "arrival_s": ahead.arrival,
            }
        )
    return described
