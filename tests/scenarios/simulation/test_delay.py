"""Sensing delay: what the robots know of their own motion decides what they stand."""

from collections.abc import Callable

import numpy as np
import pytest

from formation.analysis.margins import most_periods
from scenarios.definition.experiment import Experiment
from scenarios.measures.metrics import measure, settling_time
from scenarios.simulation.loop import simulate

Varied = Callable[..., Experiment]
SEEDS = range(5)


def late(varied: Varied, plant: str, periods: int, knows: str, duration: float = 60.0) -> Experiment:
    keys = (
        f"plant.name={plant}",
        "safety.filter=none",
        f"sensor.delay_periods={periods}",
        f"sensor.own_motion={knows}",
    )
    return varied(*keys, duration=duration)


def settled(experiment: Experiment) -> list[bool]:
    run = simulate(experiment, list(SEEDS))
    sums = np.abs(experiment.angles.errors(run.points, experiment.target_angles)).sum(axis=-1)
    return [settling_time(run.t, each, experiment.goal) is not None for each in sums.T]


@pytest.mark.parametrize("plant", ["unicycle", "saturated"])
@pytest.mark.parametrize("periods", [15, 60])
def test_robots_that_undo_their_own_motion_settle_behind_two_seconds_of_delay(
    varied: Varied, plant: str, periods: int
) -> None:
    assert all(settled(late(varied, plant, periods, "measured")))


@pytest.mark.parametrize(("plant", "periods"), [("unicycle", 5), ("saturated", 30)])
def test_robots_that_know_nothing_of_their_own_motion_do_not(varied: Varied, plant: str, periods: int) -> None:
    assert not any(settled(late(varied, plant, periods, "unknown")))


def test_robots_that_undo_their_turn_alone_have_the_laws_own_margin(varied: Varied) -> None:
    """The envelope of the error, fitted late, decays at 0.9 and grows at 1.1 of it."""
    margin = most_periods([-1.0, -0.5, -0.64], 0.033)
    assert margin == 47
    for share, decays in ((0.9, True), (1.1, False)):
        run = simulate(late(varied, "unicycle", round(share * margin), "turn", duration=90.0), 0)
        end = np.array([[0.5, 0.0], [0.0, -0.5], [-1.0, 0.0], [1.0, 0.0]])
        error = np.linalg.norm(run.points[:, 2:] - end, axis=-1).max(axis=1)
        envelope = [error[begin : begin + 200].max() for begin in range(1200, 2700, 200)]
        slope = np.polyfit(range(len(envelope)), np.log(envelope), 1)[0]
        assert bool(slope < 0.0) is decays


def test_walls_and_others_at_rest_are_seen_where_they_are_through_any_delay(varied: Varied) -> None:
    """With its own motion undone, a lone mover's run differs from the undelayed one by nothing at all."""
    ends = {1: (0.0, 0.5), 2: (-0.5, 0.0), 4: (0.0, -0.5), 5: (-1.0, 0.0), 6: (1.0, 0.0)}
    starts = [f"agents.{k}.start={list(place)}" for k, place in ends.items()]
    runs = [
        simulate(varied("plant.name=saturated", *starts, f"sensor.delay_periods={d}", duration=5.0), 1) for d in (0, 20)
    ]
    moved = [run.points[:, 2] for run in runs]
    np.testing.assert_allclose(moved[0], moved[1], atol=1e-9)


@pytest.mark.slow
def test_with_the_filters_rule_the_robots_settle_apart_behind_half_a_second(varied: Varied) -> None:
    keys = ("sensor.delay_periods=15", "safety.safe_distance_m=0.2045", "safety.sensing_range_m=0.3545")
    run = measure(
        experiment := varied(*keys, "safety.gain_per_s=1.01", duration=40.0), trajectory := simulate(experiment, 0)
    )
    assert run.settling_time is not None
    assert run.verdict.accepted
    assert not (trajectory.contact >= 0).any()
