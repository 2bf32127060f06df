"""The comparison of laws, on the runner."""

import numpy as np
import pytest

from scenarios.definition.experiment import open_experiment
from scenarios.measures.metrics import measure
from scenarios.simulation.loop import simulate
from scenarios.studies import laws
from scenarios.studies.laws import LAWS, RANDOM_START, compare, markdown, share_reaching


@pytest.mark.slow
def test_only_the_angle_law_reaches_the_shape_from_every_start_and_needs_no_compass() -> None:
    shares = {share.law.name: share for share in compare(50)}
    assert shares["angle"].exact == shares["angle"].biased == 1.0
    for needs_compass in ("displacement", "bearing"):
        assert shares[needs_compass].exact == 1.0
        assert shares[needs_compass].biased < 0.1
    assert shares["distance"].exact == shares["distance"].biased < 0.5
    table = markdown(list(shares.values()), 50)
    assert all(f"| {law.name} |" in table for law in LAWS)


def test_the_mirrored_equilibrium_has_right_distances_and_wrong_angles() -> None:
    experiment = open_experiment("law-distance", ("plant.name=single_integrator",), duration=120.0)
    trajectory = simulate(experiment, 0)
    k, i = experiment.graph.edges.T
    length = lambda p: np.linalg.norm(p[k] - p[i], axis=1)  # noqa: E731
    np.testing.assert_allclose(length(trajectory.points[-1]), length(experiment.target.positions), atol=1e-3)
    assert measure(experiment, trajectory).outcome == "not_converged"


@pytest.mark.parametrize("law", ["displacement", "bearing"])
def test_a_comparison_law_ends_where_its_prediction_says(law: str) -> None:
    experiment = open_experiment(f"law-{law}", ("plant.name=single_integrator",), duration=120.0)
    metrics = measure(experiment, simulate(experiment, 0))
    assert metrics.outcome == "converged"
    np.testing.assert_allclose(metrics.phases[-1].distances, 0.0, atol=1e-5)


def test_a_share_does_not_depend_on_how_many_runs_advance_together(monkeypatch: pytest.MonkeyPatch) -> None:
    changes = ("law.name=distance", "plant.name=single_integrator", *RANDOM_START, "goal.angle_error_sum_rad=8.0")
    experiment = open_experiment("law-displacement", changes, 6.0)
    shares, seen = [], []
    for states in (laws.BATCH_STATES, 6 * 182 * 4):
        monkeypatch.setattr(laws, "BATCH_STATES", states)
        shares.append(share_reaching(experiment, 10, lambda *count: seen.append(count)))
    assert shares[0] == shares[1]
    assert 0.0 < shares[0] < 1.0
    parts = [done / total for done, total in seen]
    half = len(parts) // 4
    assert parts[half - 1] == parts[-1] == 1.0  # one batch, then three
    assert parts[half:] == sorted(parts[half:])


@pytest.mark.parametrize(("law", "scale", "turn"), [("displacement", 0.7, -1.0), ("bearing", 1.0, -1.0)])
def test_a_comparison_law_follows_what_it_can_of_a_maneuver(law: str, scale: float, turn: float) -> None:
    """A quarter turn to the right and a smaller formation, of a displacement that the phases command."""
    changes = ("plant.name=single_integrator", f"law.name={law}", "phases.3.duration_s=200")
    trajectory = simulate(open_experiment("maneuver", changes), 0)
    before, after = (trajectory.points[trajectory.phase <= last][-1] for last in (0, 2))
    e_before, e_after = (complex(*(p[1] - p[0])) for p in (before, after))
    assert e_after / e_before == pytest.approx(scale * np.exp(0.5j * np.pi * turn), abs=1e-3)
