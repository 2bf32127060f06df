"""The late rates that are predicted are those that are measured, whatever steers the first follower, on every plant."""

import numpy as np
import pytest

from scenarios.definition.experiment import open_experiment
from scenarios.measures.late_rates import expected_late_rates, measured_late_rates, predicted_late_rates
from scenarios.measures.predictions.theory import motion
from scenarios.simulation.loop import simulate

SHORT = ("phases.1.displacement_m=[0.35,0.0]", "phases.2.displacement_m=[0.3,0.0]")


def worst(predicted: list[float | None] | None, measured: list[float | None]) -> float:
    """The largest relative difference; both must have found the same followers' rates."""
    assert predicted is not None
    assert [p is None for p in predicted] == [m is None for m in measured]
    pairs = [(p, m) for p, m in zip(predicted, measured, strict=True) if p is not None and m is not None]
    assert pairs
    return max(abs(p / m - 1.0) for p, m in pairs)


@pytest.mark.parametrize(
    ("scenario", "changes"), [("scale-only", SHORT), ("orientation-only", ()), ("fastest", ())], ids=lambda x: str(x)
)
@pytest.mark.parametrize("plant", ["single_integrator", "unicycle"])
def test_late_rates_are_predicted_with_the_first_followers_own_dynamics(
    scenario: str, changes: tuple[str, ...], plant: str
) -> None:
    experiment = open_experiment(scenario, (*changes, f"plant.name={plant}", "safety.filter=none"))
    run = simulate(experiment, 0)
    measured = measured_late_rates(experiment, run)
    assert worst(predicted_late_rates(experiment, run), measured) < 0.001
    assert worst(expected_late_rates(experiment, experiment.initial_points(0)), measured) < 0.001


def test_a_short_distance_is_reached_slowly_and_all_followers_with_it() -> None:
    """Twice 0.3 m squared is 0.18 per second, a held command's 0.1813; the followers' own rates begin at 0.5."""
    experiment = open_experiment("scale-only", (*SHORT, "plant.name=unicycle"))
    expected = expected_late_rates(experiment, experiment.initial_points(0))
    assert expected is not None
    np.testing.assert_allclose(np.array(expected, dtype=float), 0.1813, rtol=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("plant", ["single_integrator", "saturated"])
def test_the_late_rates_of_fifty_robots_are_predicted_from_where_their_windows_begin(plant: str) -> None:
    experiment = open_experiment("random-50", (f"plant.name={plant}", "safety.filter=none"))
    run = simulate(experiment, 0)
    assert worst(predicted_late_rates(experiment, run), measured_late_rates(experiment, run)) < 0.001


def test_other_laws_have_no_predicted_rates() -> None:
    experiment = open_experiment("law-distance", duration=1.0)
    assert predicted_late_rates(experiment, simulate(experiment, 0)) is None
    assert expected_late_rates(experiment, experiment.initial_points(0)) is None


def test_a_run_too_short_for_a_fit_has_rates_neither_measured_nor_predicted() -> None:
    experiment = open_experiment("shape", ("plant.name=saturated",), duration=0.3)
    run = simulate(experiment, 0)
    assert measured_late_rates(experiment, run) == predicted_late_rates(experiment, run) == [None] * 4


@pytest.mark.parametrize("scenario", ["shape", "maneuver", "scale-only", "orientation-only", "fastest"])
def test_the_exact_motion_is_within_a_micrometre_of_the_simulated_points_at_every_instant(scenario: str) -> None:
    experiment = open_experiment(scenario, ("plant.name=single_integrator",))
    run = simulate(experiment, 0)
    for index in range(len(experiment.phases)):
        rows = np.flatnonzero(run.phase == index)
        rows = rows if index == 0 else np.insert(rows, 0, rows[0] - 1)
        exact = motion(experiment, run.points[rows[0]], index)
        np.testing.assert_allclose(exact, run.points[rows], atol=1e-6)
