"""Every public function against the public simulator's own, over 300 random inputs each, where it is installed.

    RPS1=FOLDER RPS2=FOLDER .venv/bin/pytest tests/robots/rps/test_original.py

FOLDER has the folder ``rps`` of a generation; needs cvxopt beside it. Closed forms agree to 1e-12, except at a goal
itself; certificates to what the original's solver leaves: it stops at 1e-2.
"""

import random
import warnings
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from robots.rps import hook
from robots.rps.certificates import pair_rows

INPUTS = 300
Original = Callable[[int, str], ModuleType]

EXACT: dict[tuple[int, str], list[tuple[str, tuple[Any, ...], tuple[int, ...]]]] = {
    (2, "transformations"): [
        ("create_si_to_uni_dynamics", (0.7, 2.0), (2, 3)),
        ("create_si_to_uni_dynamics_with_backwards_motion", (0.7, 2.0), (2, 3)),
    ],
    (1, "transformations"): [
        ("create_si_to_uni_dynamics", (0.7, 2.0), (2, 3)),
        ("create_si_to_uni_dynamics_with_backwards_motion", (0.7, 2.0), (2, 3)),
        ("create_uni_to_si_dynamics", (0.07,), (2, 3)),
    ],
    (2, "controllers"): [
        ("create_si_position_controller", (), (2, 2)),
        ("create_uni_position_controller", (), (3, 2)),
        ("create_pose_controller_clf", (), (3, 3)),
        ("create_pose_controller_hybrid", (), (3, 3)),
        ("create_pose_parking_controller_clf", (), (3, 3)),
        ("create_pose_parking_controller_hybrid", (), (3, 3)),
    ],
    (1, "controllers"): [
        ("create_si_position_controller", (), (2, 2)),
        ("create_clf_unicycle_position_controller", (), (3, 2)),
        ("create_clf_unicycle_pose_controller", (), (3, 3)),
        ("create_hybrid_unicycle_pose_controller", (), (3, 3)),
    ],
    (2, "misc"): [("create_at_pose", (0.6, 1.5), (3, 3)), ("create_at_position", (0.6,), (2, 2))],
}
CERTIFICATES: list[tuple[int, str, int, float]] = [
    (2, "create_si_barrier_certificate", 2, 0.02),
    (2, "create_si_barrier_certificate_with_boundary", 2, 0.02),
    (2, "create_uni_barrier_certificate", 3, 0.02),
    (2, "create_uni_barrier_certificate_with_boundary", 3, 0.02),
    (1, "create_single_integrator_barrier_certificate", 2, 0.02),
    (1, "create_single_integrator_barrier_certificate_with_boundary", 2, 0.02),
    (1, "create_unicycle_barrier_certificate", 3, 0.02),
    (1, "create_unicycle_barrier_certificate_with_boundary", 3, 0.02),
    (1, "create_unicycle_differential_drive_barrier_certificate_with_boundary", 3, 0.02),
]


def inputs(rng: np.random.Generator, rows: tuple[int, ...], n: int) -> list[np.ndarray]:
    scale = np.array([[1.3], [0.8], [3.1]])
    return [scale[:k] * rng.uniform(-1.0, 1.0, (k, n)) for k in rows]


def same(a: Any, b: Any, atol: float) -> None:
    if isinstance(a, tuple):
        assert len(a) == len(b)
        for one, other in zip(a, b, strict=True):
            same(one, other, atol)
    else:
        np.testing.assert_allclose(np.asarray(a, dtype=float), np.asarray(b, dtype=float), rtol=1e-10, atol=atol)


@pytest.mark.parametrize(("version", "module", "name", "given", "rows"), [
    (version, module, *case) for (version, module), cases in EXACT.items() for case in cases
])  # fmt: skip
def test_closed_forms_agree(
    version: Any, module: str, name: str, given: tuple[Any, ...], rows: tuple[int, ...], original: Original
) -> None:
    theirs = getattr(original(version, f"utilities.{module}"), name)(*given)
    ours = hook.names(f"utilities.{module}", version)[name](*given)  # type: ignore[operator]
    rng = np.random.default_rng(0)
    n = 4  # the hybrid controllers remember as long as the number stays
    for _ in range(INPUTS):
        a, b = inputs(rng, rows, n)
        same(ours(a.copy(), b.copy()), theirs(a.copy(), b.copy()), 1e-12)


@pytest.mark.parametrize("version", [1, 2])
def test_mappings_agree(version: Any, original: Original) -> None:
    theirs = original(version, "utilities.transformations").create_si_to_uni_mapping(0.04)
    ours = hook.names("utilities.transformations", version)["create_si_to_uni_mapping"](0.04)  # type: ignore[operator]
    rng = np.random.default_rng(0)
    for _ in range(INPUTS):
        u, x = inputs(rng, (2, 3), 5)
        same(ours[0](u, x), theirs[0](u, x), 1e-12)
        same(ours[1](x), theirs[1](x), 1e-12)
    if version == 2:
        back = original(2, "utilities.transformations").create_uni_to_si_mapping(0.04)
        mine = hook.names("utilities.transformations", 2)["create_uni_to_si_mapping"](0.04)  # type: ignore[operator]
        for _ in range(INPUTS):
            u, x = inputs(rng, (2, 3), 5)
            same(mine[0](u, x), back[0](u, x), 1e-12)
            same(mine[1](x, u), back[1](x, u), 1e-12)


@pytest.mark.parametrize(("version", "name", "rows", "tolerance"), CERTIFICATES)
def test_certificates_agree_to_what_the_original_solves_to(
    version: Any, name: str, rows: int, tolerance: float, original: Original
) -> None:
    """With the solver of the original run on to 1e-9, what is left is 1e-5 m/s of the point that is steered."""
    pytest.importorskip("cvxopt")
    module = original(version, "utilities.barrier_certificates")
    theirs = getattr(module, name)()
    ours = hook.names("utilities.barrier_certificates", version)[name]()  # type: ignore[operator]
    rng = np.random.default_rng(0)
    from cvxopt import solvers

    for exact in (False, True):
        if exact:
            solvers.options.update(reltol=1e-10, abstol=1e-10, feastol=1e-10, maxiters=100)
        worst = []
        for _ in range(INPUTS):
            x = inputs(rng, (3,), int(rng.integers(2, 7)))[0] * [[0.9], [0.9], [1.0]]
            wish = rng.uniform(-0.2, 0.2, (2, x.shape[1]))
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                there = np.asarray(theirs(wish.copy(), x[:rows].copy()))
            here = ours(wish.copy(), x[:rows].copy())
            stopped = version == 2 and not there.any()
            if not stopped:  # it has found no solution
                lever = np.array([[1.0], [0.03 if rows == 3 else 1.0]])
                worst.append(np.abs(lever * (here - there)).max())
        assert len(worst) > 0.8 * INPUTS
        limit = 1e-4 if exact else tolerance
        assert np.quantile(worst, 0.99) < limit, f"{name}: {np.max(worst):.2g} m/s"


@pytest.mark.parametrize(
    ("name", "rows", "distance", "gain"),
    [
        ("create_single_integrator_barrier_certificate2", 2, 0.17, 100.0),
        ("create_unicycle_barrier_certificate2", 3, 0.17, 500.0),
    ],
)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-10])
def test_certificates_that_push_apart_agree_to_what_gap_and_feasibility_leave(
    name: str, rows: int, distance: float, gain: float, tolerance: float, original: Original
) -> None:
    """Robots that overlap are pushed apart at any speed, so that no one number of m/s says what a solver leaves.

    It stops at a gap of ``tolerance`` |J|, J = |x|^2 - 2 w.x of wish w and answer x, and with rows A x <= b broken by
    ``tolerance`` max(1, |b|). J grows by |dx|^2 around its least, and an answer whose active rows move by r moves by
    at most |r| / s, s their least singular value: |dx| <= sqrt(tolerance |J|) + tolerance max(1, |b|) / s.
    """
    pytest.importorskip("cvxopt")
    theirs = getattr(original(1, "utilities.barrier_certificates"), name)()
    from cvxopt import solvers

    solvers.options.update(reltol=tolerance, abstol=min(tolerance, 1e-7), feastol=tolerance, maxiters=100)
    ours = hook.names("utilities.barrier_certificates", 1)[name]()  # type: ignore[operator]
    ahead = 0.05 if rows == 3 else 0.0
    rng, shares = np.random.default_rng(0), []
    for _ in range(INPUTS):
        x = inputs(rng, (3,), int(rng.integers(2, 7)))[0] * [[0.9], [0.9], [1.0]]
        wish = rng.uniform(-0.2, 0.2, (2, x.shape[1]))
        answers = [np.asarray(each(wish.copy(), x[:rows].copy())) for each in (ours, theirs)]
        points, heading = x[:2], np.exp(1j * x[2])
        if rows == 3:
            points = points + ahead * np.array([heading.real, heading.imag])
            wish, *answers = (moved(each, heading, ahead) for each in (wish, *answers))
        wish = wish * np.minimum(1.0, 0.2 / np.linalg.norm(wish, axis=0))
        a, squared = pair_rows(points)
        h = squared - distance**2
        bounds = np.where(h >= 0.0, gain, 1e6) * h**3
        here, there = (each.T.ravel() for each in answers)
        active = a[a @ here > bounds - 1e-6 * (1.0 + np.abs(bounds))]
        least = np.linalg.svd(active, compute_uv=False).min() if len(active) else np.inf
        gap = tolerance * abs(here @ here - 2.0 * wish.T.ravel() @ here)
        left = np.sqrt(gap) + tolerance * max(1.0, float(np.linalg.norm(bounds))) / least
        shares.append(np.linalg.norm(here - there) / max(left, 1e-9))
    assert np.max(shares) < 1.0, f"{name}: {np.max(shares):.2g} of what is allowed"
    assert np.median(shares) > 0.0


def moved(command: np.ndarray, heading: np.ndarray, ahead: float) -> np.ndarray:
    """(2, N) velocities of the points that unicycle commands (2, N) move."""
    velocity = (command[0] + 1j * ahead * command[1]) * heading
    return np.array([velocity.real, velocity.imag])


@pytest.mark.parametrize("version", [1, 2])
def test_graphs_agree(version: Any, original: Original, global_draws: Callable[[int], None]) -> None:
    theirs, ours = original(version, "utilities.graph"), hook.names("utilities.graph", version)
    rng = np.random.default_rng(0)
    cycle = "cycle_GL" if version == 1 else "cycleGL"
    for n in range(3, 20):
        for name in (cycle, "lineGL", "completeGL"):
            same(ours[name](n), getattr(theirs, name)(n), 0.0)  # type: ignore[operator]
    for draw in range(INPUTS):
        v, e = int(rng.integers(1, 12)), int(rng.integers(0, 30))
        for name in ("random_connectedGL", "randomGL"):
            drawn = []
            for make in (ours[name], getattr(theirs, name)):
                global_draws(draw)
                drawn.append(make(v, e))  # type: ignore[operator]
            same(drawn[0], drawn[1], 0.0)
        poses, agent = rng.uniform(-1.0, 1.0, (3, v)), int(rng.integers(0, v))
        disk = ours["delta_disk_neighbors"](poses, agent, 0.7)  # type: ignore[operator]
        same(disk, theirs.delta_disk_neighbors(poses, agent, 0.7), 0.0)
        near = ours["topological_neighbors"](drawn[0], agent)  # type: ignore[operator]
        same(near, theirs.topological_neighbors(drawn[1].copy(), agent), 0.0)


def test_random_poses_agree(original: Original, global_draws: Callable[[int], None]) -> None:
    second = original(2, "utilities.misc")
    for draw in range(INPUTS):
        n = 1 + draw % 8
        for name in ("generate_random_poses", "generate_random_positions"):
            drawn = []
            for make in (hook.names("utilities.misc", 2)[name], getattr(second, name)):
                global_draws(draw)
                drawn.append(make(n))  # type: ignore[operator]
            same(drawn[0], drawn[1], 1e-15)
        drawn = []
        for make in (hook.names("utilities.misc", 2)["generate_initial_poses"], second.generate_initial_poses):
            random.seed(draw)
            drawn.append(make(n, 3.0, 2.0))  # type: ignore[operator]
        same(drawn[0], drawn[1], 1e-15)
    angles = np.random.default_rng(0).uniform(-7.0, 7.0, 50)
    same(hook.names("utilities.misc", 2)["rotation_matrix"](angles), second.rotation_matrix(angles), 0.0)  # type: ignore[operator]


def test_random_poses_of_version_one_agree(original: Original, global_draws: Callable[[int], None]) -> None:
    theirs, ours = original(1, "utilities.misc"), hook.names("utilities.misc", 1)
    rng = np.random.default_rng(0)
    for draw in range(INPUTS):
        drawn = []
        for make in (ours["generate_initial_conditions"], theirs.generate_initial_conditions):
            global_draws(draw)
            drawn.append(make(1 + draw % 8))  # type: ignore[operator]
        same(drawn[0], drawn[1], 1e-15)
        x, goals = inputs(rng, (3, 3), 4)
        for name, target in (("at_pose", goals), ("at_position", goals[:2])):
            same(ours[name](x, target, 0.8), getattr(theirs, name)(x, target, 0.8), 0.0)  # type: ignore[operator]
    angles = rng.uniform(-7.0, 7.0, 50)
    same(ours["rotation_matrix"](angles), theirs.rotation_matrix(angles), 0.0)  # type: ignore[operator]


def test_distance_sensors_agree(original: Original, global_draws: Callable[[int], None]) -> None:
    theirs, ours = original(2, "utilities.sensors"), hook.names("utilities.sensors", 2)
    from robots.rps import constants as c

    rng = np.random.default_rng(0)
    for draw in range(INPUTS):
        x = inputs(rng, (3,), int(rng.integers(1, 6)))[0]
        lines = rng.uniform(-1.5, 1.5, (int(rng.integers(0, 5)), 2, 2))
        noise = (c.DISTANCE_SENSOR_RANGE, 0.03, 0.1, 0.1)
        for name, sizes in (
            ("simulate_distance_sensors", (0.11, 0.01)),
            ("simulate_distance_sensors_without_robots", ()),
        ):
            read = []
            for make in (ours[name], getattr(theirs, name)):
                global_draws(draw)
                read.append(make(x, lines, c.DISTANCE_SENSORS_ORIENTATION, *sizes, *noise))  # type: ignore[operator]
            same(read[0], read[1], 1e-9)


def test_constants_agree(original: Original) -> None:
    theirs, ours = original(2, "robotarium").Robotarium, hook.names("robotarium", 2)["Robotarium"]
    names = [name for name in dir(theirs) if name.isupper()]
    assert len(names) > 20
    for name in names:
        np.testing.assert_allclose(getattr(ours, name), getattr(theirs, name), rtol=1e-12, err_msg=name)
    there = original(2, "patch_creation.gternal_patch").gternal_patch()
    here = hook.names("patch_creation.gternal_patch", 2)["gternal_patch"]()  # type: ignore[operator]
    np.testing.assert_allclose(here.vertices, there.vertices, atol=1e-12)
    np.testing.assert_allclose(here.colors, there.colors, atol=1e-12)
