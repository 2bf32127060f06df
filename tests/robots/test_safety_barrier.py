"""The barrier rows against the motion itself, by finite differences and in closed loop."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from robots import GTERNAL, ROBOTARIUM_FLOOR, Arena, NearIdentityDiffeomorphism, make_world
from robots.obstacles import Obstacle
from robots.safety import FilterSettings, make_filter, sampling_loss
from robots.safety.certificate import RobotariumCertificate
from robots.testbed import separation

NID = NearIdentityDiffeomorphism(0.025)
SETTINGS = FilterSettings(turn=0.0)
PERIOD = 0.033
TINY = 1e-7

angles = st.floats(-np.pi, np.pi)
distances = st.floats(0.156, 0.29)


def world(points: np.ndarray, theta: np.ndarray):
    return make_world("unicycle", points, theta, nid=NID, robot=GTERNAL)


def in_body(velocity: complex, theta: float) -> np.ndarray:
    z = velocity * np.exp(-1j * theta)
    return np.array([z.real, z.imag])


@given(angles, angles, angles, distances, st.floats(-0.03, 0.03), st.floats(-0.03, 0.03))
def test_a_robot_that_drives_at_another_takes_exactly_its_half_of_the_barrier(
    bearing: float, theta_i: float, theta_j: float, distance: float, v_x: float, v_y: float
) -> None:
    """dh/dt by finite differences over the NID and the exact arc, with the other robot at v_r, is -gamma h / 2."""
    away = np.exp(1j * bearing)
    theta = np.array([theta_i, theta_j])
    points = np.array([[away.real * distance, away.imag * distance], [0.0, 0.0]])
    feedback = np.stack([in_body(-0.3 * away, theta_i), [0.0, 0.0]])
    common = np.stack([in_body(complex(v_x, v_y), t) for t in theta])
    safety = make_filter("decentralised", (2,), GTERNAL.drive, NID, SETTINGS)
    plant = world(points, theta)
    u = safety.filter(plant.points, plant.headings, feedback, common, PERIOD)
    normal = in_body(away, theta_i)
    row = -SETTINGS.gain * (distance**2 - SETTINGS.safe_distance**2) / (4.0 * distance)
    assume(abs(normal @ (u[0] - common[0]) - row) < 1e-9)  # else the wheels' limits alone hold it back
    plant.step(lambda p, h, _: u, TINY)
    h = [((p[0] - p[1]) ** 2).sum() - SETTINGS.safe_distance**2 for p in (points, plant.points)]
    assert (h[1] - h[0]) / TINY == pytest.approx(-SETTINGS.gain * h[0] / 2.0, abs=1e-6)


@given(angles, st.floats(-1.5, 1.5), st.sampled_from(["wall", "disc", "segment", "polygon"]), st.floats(0.081, 0.2))
def test_a_robot_takes_all_of_the_barrier_of_a_thing(theta: float, along: float, kind: str, distance: float) -> None:
    things = {
        "wall": (),
        "disc": (Obstacle(np.array([[along, -0.2]]), 0.2),),
        "segment": (Obstacle(np.array([[-3.0, -0.05], [3.0, -0.05]]), 0.05),),
        "polygon": (Obstacle(np.array([[-3.0, 0.0], [0.0, -1.0], [3.0, 0.0]])),),
    }[kind]
    arena = Arena((-9.0, 9.0), (0.0 if kind == "wall" else -9.0, 9.0), kind == "wall", things)
    points = np.array([[along, distance]])
    feedback = in_body(-0.3j, theta)[None]
    safety = make_filter("decentralised", (1,), GTERNAL.drive, NID, SETTINGS, arena)
    plant = world(points, np.array([theta]))
    u = safety.filter(plant.points, plant.headings, feedback, np.zeros((1, 2)), PERIOD)
    room = distance - SETTINGS.clearance
    assume(abs(in_body(1j, theta) @ u[0] + SETTINGS.gain * room) < 1e-9)
    plant.step(lambda p, h, _: u, TINY)
    assert (plant.points[0, 1] - distance) / TINY == pytest.approx(-SETTINGS.gain * room, abs=1e-5)


@given(st.integers(0, 10**6))
def test_the_rows_of_the_joint_filters_are_derivatives_of_the_barrier(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, velocity = rng.uniform(-0.2, 0.2, (4, 2)), rng.normal(0.0, 0.1, (4, 2))
    frame = np.ones((4, 1), dtype=complex)
    pairs = np.triu_indices(4, 1)

    def h(p: np.ndarray) -> np.ndarray:
        return ((p[pairs[0]] - p[pairs[1]]) ** 2).sum(axis=1)

    rate = (h(points + TINY * velocity) - h(points - TINY * velocity)) / (2.0 * TINY)
    rows = RobotariumCertificate((4,))._rows(0, points, frame, None)
    np.testing.assert_allclose((rows.matrix(4) @ velocity.ravel())[: len(rate)], rate, atol=1e-6)
    joint = make_filter("centralised", (4,), GTERNAL.drive, NID, SETTINGS)
    rows = joint._rows(0, points, frame, None)
    distance = np.sqrt(h(points))
    near = distance < SETTINGS.sensing_range
    np.testing.assert_allclose(rows.matrix(4) @ velocity.ravel(), (rate / (2.0 * distance))[near], atol=1e-6)
    np.testing.assert_allclose(
        rows.lower, (-SETTINGS.gain * (distance**2 - SETTINGS.safe_distance**2) / (2.0 * distance))[near], atol=1e-12
    )


@pytest.mark.parametrize("name", ["decentralised", "centralised"])
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_a_crowd_that_drives_at_random_never_comes_closer_than_the_sampling_allows(name: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(np.arange(3), np.arange(3)), axis=-1).reshape(-1, 2) * 0.17
    plant = world(grid.astype(float), rng.uniform(-np.pi, np.pi, 9))
    safety = make_filter(name, (9,), GTERNAL.drive, NID, FilterSettings())
    least = FilterSettings().safe_distance - sampling_loss(GTERNAL.drive, NID, FilterSettings(), PERIOD)
    for step in range(60):
        if step % 10 == 0:
            feedback = rng.normal(0.0, 0.3, (9, 2))
        plant.step(lambda p, h, _, g=feedback: safety.filter(p, h, g, np.zeros((9, 2)), PERIOD), PERIOD)
        assert separation(plant.points[None]).distance[0] >= least


def test_at_the_defaults_the_sampling_loss_leaves_no_chance_of_contact() -> None:
    settings_ = FilterSettings()
    loss = sampling_loss(GTERNAL.drive, NID, settings_, PERIOD)
    assert settings_.safe_distance - loss > 2.0 * GTERNAL.chassis.radius
    assert settings_.clearance - loss / 2.0 > GTERNAL.chassis.radius


def test_the_certificate_holds_two_robots_by_its_published_equation() -> None:
    points = np.array([[-0.11, 0.0], [0.11, 0.0]])
    headings = np.array([[1.0, 0.0], [1.0, 0.0]])
    certificate = RobotariumCertificate((2,), ROBOTARIUM_FLOOR)
    u = certificate.filter(points, headings, np.array([[0.2, 0.0], [-0.2, 0.0]]), np.zeros((2, 2)), PERIOD)
    h = 0.22**2 - 0.15**2
    assert 2.0 * 0.22 * (u[0, 0] - u[1, 0]) == pytest.approx(100.0 * h**3)
    np.testing.assert_allclose(u[:, 1], 0.0, atol=1e-12)


def test_the_certificate_slows_a_robot_at_the_boundary_by_its_published_equation() -> None:
    points, still = np.array([[1.55, 0.0]]), np.zeros((1, 2))
    u = RobotariumCertificate((1,), ROBOTARIUM_FLOOR).filter(
        points, np.array([[1.0, 0.0]]), np.array([[0.1, 0.05]]), still, PERIOD
    )
    np.testing.assert_allclose(u, [[0.4 * 100.0 * (1.7 - 0.15 / 2.0 - 1.55) ** 3, 0.05]], atol=1e-12)


@given(direction=st.floats(-np.pi, np.pi), speed=st.floats(0.0, 2.0))
def test_the_certificate_keeps_a_free_robot_in_the_published_octagon(direction: float, speed: float) -> None:
    wish = speed * np.array([[np.cos(direction), np.sin(direction)]])
    u = RobotariumCertificate((1,), ROBOTARIUM_FLOOR).filter(
        np.zeros((1, 2)), np.array([[1.0, 0.0]]), wish, np.zeros((1, 2)), PERIOD
    )
    limit, normals = 0.2 * np.cos(np.pi / 8.0), np.arange(8) * np.pi / 4.0
    along = np.stack([np.cos(normals), np.sin(normals)], axis=1)
    assert (along @ u[0] <= limit + 1e-9).all()
    # The nearest: what is cut off lies along the sides that hold the robot back.
    cut = (wish - u)[0]
    if (along @ wish[0] <= limit).all():
        np.testing.assert_allclose(cut, 0.0, atol=1e-9)
    else:
        assert (cut @ (0.2 * np.stack([np.cos(normals + np.pi / 8), np.sin(normals + np.pi / 8)]) - u.T) <= 1e-9).all()
