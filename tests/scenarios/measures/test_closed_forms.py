"""The closed forms of a scenario are those of its loop, and they warn where they should."""

from collections.abc import Callable

import numpy as np
import pytest
from rich.console import Console

from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.measures.closed_forms import closed_forms, passages
from scenarios.measures.predictions.theory import motion
from scenarios.report.closed_forms import print_closed_forms
from scenarios.report.experiment import print_experiment
from scenarios.simulation.loop import simulate


def shown(experiment: Experiment) -> str:
    console = Console(width=400, record=True, file=open("/dev/null", "w"))  # noqa: SIM115
    print_closed_forms(console, experiment, experiment.initial_points(0))
    console.file.close()
    return console.export_text()


def test_the_papers_shape_has_the_noise_the_bias_and_the_gains_of_its_loop(shape: Experiment) -> None:
    found = closed_forms(shape, shape.initial_points(0))
    assert found is not None
    np.testing.assert_allclose(1e3 * found.noise[2:], [2.234, 2.241, 2.915, 2.915], atol=1e-3)
    np.testing.assert_allclose(found.bias[2:], [1.732, 1.581, 2.372, 2.372], atol=1e-3)
    assert found.gains == (pytest.approx(3.51, abs=0.01), pytest.approx(3.86, abs=0.01))
    assert found.most_periods == 47
    assert found.longest_period == pytest.approx(2.0)
    assert found.filter is None


def test_noise_of_the_scenario_is_taken_where_it_has_some(varied: Callable[..., Experiment]) -> None:
    noisy = varied("sensor.position_noise_m=0.02")
    found = closed_forms(noisy, noisy.initial_points(0))
    assert found is not None
    assert 1e3 * found.noise[2] == pytest.approx(4.468, abs=1e-3)
    assert "scenario's 2 cm" in shown(noisy)


def test_a_long_cascade_is_warned_of_and_a_short_one_is_not(shape: Experiment) -> None:
    assert "A long cascade amplifies: depth 11" in shown(open_experiment("random-50"))
    assert "A long cascade" not in shown(shape)


def test_noise_that_is_too_small_to_be_squared_does_not_amplify(varied: Callable[..., Experiment]) -> None:
    experiment = varied("sensor.position_noise_m=1e-200")
    found = closed_forms(experiment, experiment.initial_points(0))
    assert found is not None
    assert (found.noise.max(), found.last_over_first) == (0.0, 1.0)


def test_commands_that_turn_robots_past_their_aim_are_warned_of() -> None:
    literal = open_experiment("random-50", ("plant.name=unicycle", "safety.filter=none"))
    assert "Warning: the law asks for" in shown(literal)
    assert "Warning" not in shown(open_experiment("random-50", ("plant.name=saturated", "safety.filter=none")))


def test_what_robots_know_of_their_own_motion_has_its_own_margin(varied: Callable[..., Experiment]) -> None:
    keys = ("sensor.delay_periods=6", "plant.name=unicycle", "safety.filter=none")
    measured, turn, unknown = (
        shown(varied(*keys, f"sensor.own_motion={knows}")) for knows in ("measured", "turn", "unknown")
    )
    assert "stand any delay" in measured
    assert "undo their own turn alone stand 47 control periods (1.55 s)" in turn
    assert "Above 0.183 m/s turning is unstable" in unknown


def test_the_filter_is_told_what_a_delay_asks_of_it(varied: Callable[..., Experiment]) -> None:
    assert "safety.safe_distance_m=0.254" in shown(varied("sensor.delay_periods=30"))


def test_ways_are_told_where_agents_1_and_2_stand_and_nowhere_else(shape: Experiment) -> None:
    found = passages(shape, shape.initial_points(0))
    assert found is not None
    assert (found.roughly <= found.neighbours).all()
    assert "Lines of sight: agent 2 crosses 5's to 1" in shown(shape)
    maneuver = open_experiment("maneuver")
    assert passages(maneuver, maneuver.initial_points(0)) is None


def test_other_laws_have_no_closed_forms() -> None:
    assert shown(open_experiment("law-distance")) == ""


def test_normalised_gains_make_all_rates_one_at_a_price_in_noise(varied: Callable[..., Experiment]) -> None:
    even = varied("law.gain=normalised", "plant.name=single_integrator")
    found = closed_forms(even, even.initial_points(0))
    assert found is not None
    np.testing.assert_allclose(found.loop.rates[1:], 1.0)
    assert 1e3 * found.noise.max() == pytest.approx(3.58, abs=0.01)
    assert 1e3 * found.paper_noise.max() == pytest.approx(2.915, abs=0.001)
    assert "with gains of 1 2.91 mm" in shown(even)
    run = simulate(even, 0)
    np.testing.assert_allclose(motion(even, run.points[0], 0), run.points, atol=1e-6)


def test_a_follower_may_have_its_own_gain_and_agents_1_and_2_have_none(varied: Callable[..., Experiment]) -> None:
    own = varied("agents.3.gain=1.5")
    found = closed_forms(own, own.initial_points(0))
    assert found is not None
    np.testing.assert_allclose(found.loop.rates[1:], [0.75, 1.0, 0.64, 0.64])
    with pytest.raises(InputError, match="leader and first follower have none"):
        varied("agents.2.gain=1.5")
    with pytest.raises(InputError, match=r"law\.gain: only for the angle law"):
        open_experiment("law-distance", ("law.gain=normalised",))


def test_of_many_agents_the_first_ones_have_lines_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.report.experiment.MOST_LISTED", 4)
    monkeypatch.setattr("scenarios.report.closed_forms.MOST_LISTED", 4)
    console = Console(width=200)
    with console.capture() as capture:
        print_experiment(console, open_experiment("shape"), 0)
    assert capture.get().count("and 2 agents more") == 2
    assert "and 4 angles more" in capture.get()
