"""What of a scenario the testbed can run, and the refusal of the rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robots import GTERNAL, ROBOTARIUM_FLOOR
from robots.model import CONTROL_PERIOD
from robots.robotarium import MOST_ROBOTS
from robots.testbed import separation
from scenarios.definition.events.event import RESHAPE, STOP
from scenarios.definition.experiment import Experiment
from scenarios.definition.schema import Scenario
from scenarios.errors import InputError

Real = NDArray[np.float64]

ROOM_TO_ARRIVE = 0.35
"""Metres between two axles; where robots start closer, the drive to the start of ``rps`` 2.1 may not end."""


_OF_DELAYS = ("own_motion", "gyro_noise_deg_s", "encoder_noise_m_s")  # without a delay they change nothing


def start_poses(experiment: Experiment, seed: int) -> Real:
    """(n, 3) poses of the axles' centres at the start of the run with that seed, metres and radians.

    Raises:
        InputError: the testbed cannot run the scenario; the message names the field.
    """
    path, scenario = experiment.file.path, experiment.scenario
    for field, value, expected in _required(scenario):
        if value != expected:
            raise InputError(f"{path}: {field}: a script for the testbed needs {expected!r}, got {value!r}")
    for agent in scenario.agents:
        if agent.robot is not None:
            raise InputError(f"{path}: agents[id {agent.id}].robot: the testbed's robots are all equal, expected none")
    _check_events(experiment)
    _check_displacements(experiment)
    for axis, side, floor in (
        ("x_m", scenario.arena.x_m, ROBOTARIUM_FLOOR.x),
        ("y_m", scenario.arena.y_m, ROBOTARIUM_FLOOR.y),
    ):
        if side[0] < floor[0] or side[1] > floor[1]:
            raise InputError(f"{path}: arena.{axis}: expected a part of the testbed's {list(floor)}, got {list(side)}")
    if experiment.n > MOST_ROBOTS:
        raise InputError(f"{path}: agents: the testbed has {MOST_ROBOTS} robots, got {experiment.n}")
    points, headings = experiment.starts.draw(np.random.default_rng(seed))
    poses = experiment.nid.poses(points, headings)
    if (outside := np.flatnonzero(~ROBOTARIUM_FLOOR.contains(poses[:, :2]))).size:
        x, y = poses[outside[0], :2]
        raise InputError(
            f"{path}: agents[id {experiment.number(outside[0])}].start: with the heading of seed {seed} its axle is at "
            f"({x:.3f}, {y:.3f}) m, expected a place on the testbed's floor"
        )
    return poses


def _check_events(experiment: Experiment) -> None:
    """Robots that stop and shapes that change; all else is the world's doing, or a sensor's."""
    path, scenario = experiment.file.path, experiment.scenario
    for event in experiment.events:
        if event.kind not in (STOP, RESHAPE):
            raise InputError(
                f"{path}: events[{event.number}].kind: a script for the testbed can bring about "
                f'"{STOP}" and "{RESHAPE}", got "{event.kind}"'
            )
    if experiment.shapes and (scenario.law.activation == "sequential" or scenario.law.feedforward):
        key = "feedforward" if scenario.law.feedforward else "activation"
        raise InputError(f"{path}: law.{key}: not in a script for the testbed whose shape changes")
    if experiment.shapes and scenario.law.name != "angle":
        raise InputError(f'{path}: law.name: a script for the testbed changes shapes of "angle" alone')


def _check_displacements(experiment: Experiment) -> None:
    """Other laws than the paper's have the target's own scale and turn in a script."""
    if experiment.scenario.law.name == "angle":
        return
    own = tuple((experiment.formation.positions[1] - experiment.formation.positions[0]).tolist())
    for number, phase in enumerate(experiment.phases, start=1):
        if phase.reference is not None:
            raise InputError(f'{experiment.file.path}: reference: a script for the testbed has it for "angle" alone')
        if phase.delta not in (None, own):
            raise InputError(
                f"{experiment.file.path}: phases[{number}].displacement_m: a script for the testbed steers it "
                f'with law.name = "angle" alone, expected {list(own)}'
            )


def crowded(experiment: Experiment, poses: Real) -> str | None:
    """A remark on the closest pair of start poses (n, 3), where the testbed may fail to bring robots there."""
    near = separation(poses[None, :, :2])
    if not near.distance[0] < ROOM_TO_ARRIVE:
        return None
    a, b = experiment.numbered(near.pairs[0])
    return (
        f"agents {a} and {b} start {near.distance[0]:.2f} m apart; below {ROOM_TO_ARRIVE} m the Robotarium's own drive "
        "to the start often gets stuck: try another --seed or --set agents.N.start"
    )


def _required(scenario: Scenario) -> list[tuple[str, object, object]]:
    """Field, value and the one value that a script can carry."""
    sensors = type(scenario.sensor).model_fields.items()
    return [
        ("robot.wheel_speed_limit_rad_s", scenario.robot.wheel_speed_limit_rad_s, GTERNAL.drive.wheel_speed_limit),
        ("plant.control_period_s", scenario.plant.control_period_s, CONTROL_PERIOD),
        *(
            (f"sensor.{name}", getattr(scenario.sensor, name), field.default)
            for name, field in sensors
            if name not in _OF_DELAYS
        ),
    ]
