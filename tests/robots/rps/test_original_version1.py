"""What version 1 and 2018 alone have against the public simulator's own, 300 random inputs each, where it is installed.

    RPS1=FOLDER RPS2018=FOLDER .venv/bin/pytest tests/robots/rps/test_original_version1.py

RPS2018 has the folder ``rps`` of September 2018 (commit 4370c89 of its repository). The robust certificates need
quadprog and cvxopt beside them; quadprog is exact, so that 1e-6 of the wheels' limit is what both solvers' rounding
leaves. Where there is no solution the original raises, and here the rows are relaxed: those inputs are not compared.
"""

from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from robots.rps import hook
from robots.rps.version1.robotarium import Robotarium

pytestmark = pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")  # of np.matrix, which it uses

INPUTS = 300
Original = Callable[[int, str], ModuleType]


def names(module: str) -> dict[str, Any]:
    return dict(hook.names(f"utilities.{module}", 1))


def scene(rng: np.random.Generator, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Wishes (2, n), m/s and rad/s, and poses (3, n) of robots that are apart."""
    places = np.stack(np.meshgrid(np.linspace(-1.2, 1.2, 4), [-0.6, 0.0, 0.6])).reshape(2, -1)
    poses = np.vstack([rng.permutation(places.T)[:n].T + rng.uniform(-0.18, 0.18, (2, n)), rng.uniform(-3.1, 3.1, n)])
    return np.vstack([rng.uniform(-0.2, 0.2, n), rng.uniform(-1.5, 1.5, n)]), poses


@pytest.mark.parametrize("obstacles", [0, 3])
@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("barrier_certificates", "create_unicycle_differential_drive_barrier_certificate"),
        ("barrier_certificates2", "create_robust_barriers"),
    ],
)
def test_robust_certificates_agree(
    module: str, name: str, obstacles: int, original: Original, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("cvxopt")
    solver, there_module = pytest.importorskip("quadprog"), original(1, f"utilities.{module}")
    monkeypatch.setattr(there_module, "solver2", solver, raising=False)  # one of both calls it and imports it not
    theirs, ours = getattr(there_module, name)(), names(module)[name]()
    rng, compared = np.random.default_rng(0), 0
    for _ in range(INPUTS):
        wish, poses = scene(rng, int(rng.integers(2, 7)))
        things = rng.uniform(-1.0, 1.0, (2, obstacles)) if obstacles else np.empty(0)
        try:
            there = np.asarray(theirs(wish.copy(), poses.copy(), things))
        except ValueError:
            continue  # no solution
        here = ours(wish.copy(), poses.copy(), things)
        wheels = [np.array([v - 0.0525 * omega, v + 0.0525 * omega]) / 0.016 for v, omega in (here, there)]
        np.testing.assert_allclose(*wheels, atol=12.5e-6)
        compared += 1
    assert compared > 0.8 * INPUTS


def test_the_kalman_filter_agrees(original: Original) -> None:
    theirs, ours = original(1, "utilities.uni_ekf").UnicycleEKF, names("uni_ekf")["UnicycleEKF"]
    rng = np.random.default_rng(0)
    for _ in range(INPUTS):
        roots = [rng.normal(0.0, 1.0, (k, k)) for k in (3, 2, 3, 2)]
        start, noises = rng.uniform(-2.0, 2.0, 3), [root @ root.T for root in roots]
        given = (noises[0], rng.uniform(0.05, 0.2), rng.uniform(0.01, 0.03), *noises[1:])
        pair = [each(start.copy(), *given) for each in (theirs, ours)]
        for _ in range(5):
            v, w, dt, place = (
                rng.uniform(-0.2, 0.2),
                rng.uniform(-3.0, 3.0),
                rng.uniform(0.01, 0.1),
                rng.normal(0, 1, 2),
            )
            for form, arguments in (
                ("form_fx", (v, w, dt)),
                ("form_F", (v, dt)),
                ("form_G", (dt,)),
                ("form_Q", (dt,)),
                ("form_wheel_encoder_process_noise_matrix", (dt,)),
            ):
                np.testing.assert_allclose(*(getattr(each, form)(*arguments) for each in pair), atol=1e-15)
            for each in pair:
                each.predict(v, w, dt)
                each.update_gps(place)
            np.testing.assert_allclose(pair[0].state, pair[1].state, atol=1e-10)
            np.testing.assert_allclose(pair[0].P, pair[1].P, atol=1e-10)


def test_sizes_in_the_figure_and_points_that_are_seen_agree(original: Original) -> None:
    theirs, ours = original(1, "utilities.misc"), names("misc")
    rng = np.random.default_rng(0)
    robots = Robotarium(number_of_robots=3, show_figure=False, initial_conditions=scene(rng, 3)[1], plant="saturated")
    for _ in range(INPUTS):
        size, n = rng.uniform(0.01, 0.5), int(rng.integers(1, 6))
        for name in ("determine_marker_size", "determine_font_size"):
            np.testing.assert_allclose(ours[name](robots, size), getattr(theirs, name)(robots, size), rtol=1e-12)
        distances = np.where(rng.random((7, n)) < 0.3, -1.0, rng.uniform(0.0, 1.2, (7, n)))
        name, poses = "calculate_global_distance_points", scene(rng, n)[1]
        np.testing.assert_allclose(
            ours[name](robots, poses, distances), getattr(theirs, name)(robots, poses, distances), atol=1e-12
        )


@pytest.mark.parametrize(
    ("module", "name", "rows"),
    [
        ("controllers", "single_integrator_position_controller", (2, 2)),
        ("controllers", "unicycle_pose_controller", (3, 3)),
        ("transformations", "single_integrator_to_unicycle2", (2, 3)),
        ("transformations", "unicycle_to_single_integrator", (2, 3)),
    ],
)
def test_functions_of_2018_agree(module: str, name: str, rows: tuple[int, int], original: Original) -> None:
    theirs, ours = getattr(original(2018, f"utilities.{module}"), name), names(module)[name]
    rng = np.random.default_rng(0)
    for _ in range(INPUTS):
        a, b = (rng.uniform(-1.5, 1.5, (k, 4)) for k in rows)
        if module == "controllers":  # a goal that is near: the limit of speed had no effect until October 2018
            b[:2] = a[:2] + rng.uniform(-0.05, 0.05, (2, 4)) * rng.integers(0, 2, 4)
        np.testing.assert_allclose(ours(a.copy(), b.copy()), theirs(a.copy(), b.copy()), atol=1e-12)


def test_the_mapping_of_2018_agrees(original: Original) -> None:
    name = "create_single_integrator_to_unicycle"
    theirs = getattr(original(2018, "utilities.transformations"), name)(0.04)
    ours = names("transformations")[name](0.04)
    rng = np.random.default_rng(0)
    for _ in range(INPUTS):
        u, x = rng.uniform(-0.5, 0.5, (2, 5)), rng.uniform(-1.5, 1.5, (3, 5))
        np.testing.assert_allclose(ours[0](u, x), theirs[0](u, x), atol=1e-12)
        np.testing.assert_allclose(ours[1](x), theirs[1](x), atol=1e-15)


def test_robots_of_2018_move_as_there_up_to_their_wheels_and_eulers_rule(
    original: Original, global_draws: Callable[[int], None]
) -> None:
    """Below its wheels' limits a robot is a unicycle in 2018 too: a step differs by half the way times the turn."""
    module = original(2018, "robotarium")
    rng = np.random.default_rng(0)
    for _ in range(INPUTS // 10):
        _, poses = scene(rng, 4)
        global_draws(0)
        there = module.Robotarium(number_of_agents=4, show_figure=False, save_data=False)
        there.poses = poses.copy()
        here = Robotarium(number_of_agents=4, show_figure=False, initial_conditions=poses, plant="saturated", seed=0)
        for _ in range(10):
            command = np.vstack([rng.uniform(-0.1, 0.1, 4), rng.uniform(-1.0, 1.0, 4)])
            for robots in (there, here):
                robots.get_poses()
                robots.set_velocities(np.arange(4), command.copy())
                robots.step()
        np.testing.assert_allclose(here.get_poses()[:2], there.get_poses()[:2], atol=10 * 0.0033 * 0.033 / 2)
