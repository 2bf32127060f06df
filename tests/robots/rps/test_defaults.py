"""Arguments that a script leaves out, and constants, have the public simulator's own values, by generation.

Read from its repository, robotarium_python_simulator: generation 2 at b23069e, generation 1 at 8f00bdc.
"""

import importlib
import inspect
from math import pi

import numpy as np
import pytest

from robots.rps import constants

FLOOR = (-1.6, 1.6, -1.0, 1.0)

DEFAULTS: dict[tuple[int, str], dict[str, dict[str, object]]] = {
    (1, "barrier_certificates"): {
        "create_single_integrator_barrier_certificate": {
            "barrier_gain": 100.0,
            "safety_radius": 0.17,
            "magnitude_limit": 0.2,
        },
        "create_single_integrator_barrier_certificate_with_boundary": {
            "barrier_gain": 100.0,
            "safety_radius": 0.17,
            "magnitude_limit": 0.2,
            "boundary_points": FLOOR,
        },
        "create_single_integrator_barrier_certificate2": {
            "barrier_gain": 100.0,
            "unsafe_barrier_gain": 1000000.0,
            "safety_radius": 0.17,
            "magnitude_limit": 0.2,
        },
        "create_unicycle_barrier_certificate": {
            "barrier_gain": 100.0,
            "safety_radius": 0.12,
            "projection_distance": 0.05,
            "magnitude_limit": 0.2,
        },
        "create_unicycle_barrier_certificate_with_boundary": {
            "barrier_gain": 100.0,
            "safety_radius": 0.12,
            "projection_distance": 0.05,
            "magnitude_limit": 0.2,
            "boundary_points": FLOOR,
        },
        "create_unicycle_barrier_certificate2": {
            "barrier_gain": 500.0,
            "unsafe_barrier_gain": 1000000.0,
            "safety_radius": 0.12,
            "projection_distance": 0.05,
            "magnitude_limit": 0.2,
        },
        "create_unicycle_differential_drive_barrier_certificate": {
            "max_num_obstacle_points": 100,
            "max_num_robots": 30,
            "disturbance": 5.0,
            "wheel_vel_limit": 12.5,
            "base_length": 0.105,
            "wheel_radius": 0.016,
            "projection_distance": 0.05,
            "barrier_gain": 150.0,
            "safety_radius": 0.17,
        },
        "create_unicycle_differential_drive_barrier_certificate_with_boundary": {
            "max_num_obstacle_points": 100,
            "max_num_robots": 30,
            "disturbance": 5.0,
            "wheel_vel_limit": 12.5,
            "base_length": 0.105,
            "wheel_radius": 0.016,
            "projection_distance": 0.05,
            "barrier_gain": 150.0,
            "safety_radius": 0.17,
            "boundary_points": FLOOR,
        },
    },
    (1, "barrier_certificates2"): {
        "create_robust_barriers": {
            "max_num_obstacles": 100,
            "max_num_robots": 30,
            "d": 5.0,
            "wheel_vel_limit": 12.5,
            "base_length": 0.105,
            "wheel_radius": 0.016,
            "projection_distance": 0.05,
            "gamma": 150.0,
            "safety_radius": 0.12,
        },
    },
    (1, "controllers"): {
        "create_si_position_controller": {
            "x_velocity_gain": 1.0,
            "y_velocity_gain": 1.0,
            "velocity_magnitude_limit": 0.15,
        },
        "create_clf_unicycle_position_controller": {"linear_velocity_gain": 0.8, "angular_velocity_gain": 3.0},
        "create_clf_unicycle_pose_controller": {
            "approach_angle_gain": 1.0,
            "desired_angle_gain": 2.7,
            "rotation_error_gain": 1.0,
        },
        "create_hybrid_unicycle_pose_controller": {
            "linear_velocity_gain": 1.0,
            "angular_velocity_gain": 2.0,
            "velocity_magnitude_limit": 0.15,
            "angular_velocity_limit": pi,
            "position_error": 0.05,
            "position_epsilon": 0.03,
            "rotation_error": 0.05,
        },
        "single_integrator_position_controller": {"gain": 1.0, "magnitude_limit": 0.08},
        "unicycle_pose_controller": {"magnitude_limit": 0.08, "position_error": 0.01, "rotation_error": 0.25},
    },
    (1, "misc"): {
        "generate_initial_conditions": {"spacing": 0.3, "width": 3.0, "height": 1.8},
        "at_pose": {"position_error": 0.05, "rotation_error": 0.2},
        "at_position": {"position_error": 0.02},
    },
    (1, "transformations"): {
        "create_si_to_uni_dynamics": {"linear_velocity_gain": 1.0, "angular_velocity_limit": pi},
        "create_si_to_uni_dynamics_with_backwards_motion": {"linear_velocity_gain": 1.0, "angular_velocity_limit": pi},
        "create_si_to_uni_mapping": {"projection_distance": 0.05, "angular_velocity_limit": pi},
        "create_uni_to_si_dynamics": {"projection_distance": 0.05},
        "single_integrator_to_unicycle2": {"linear_velocity_gain": 1.0, "angular_velocity_limit": pi},
        "create_single_integrator_to_unicycle": {"projection_distance": 0.05},
        "unicycle_to_single_integrator": {"projection_distance": 0.05},
    },
    (2, "barrier_certificates"): {
        "create_si_barrier_certificate": {"safety_radius": 0.15, "barrier_gain": 100.0, "magnitude_limit": 0.2},
        "create_si_barrier_certificate_with_boundary": {
            "safety_radius": 0.15,
            "barrier_gain": 100.0,
            "magnitude_limit": 0.2,
            "boundary_points": None,
        },
        "create_uni_barrier_certificate": {
            "barrier_gain": 100.0,
            "safety_radius": 0.15,
            "projection_distance": 0.05,
            "velocity_magnitude_limit": 0.2,
        },
        "create_uni_barrier_certificate_with_boundary": {
            "safety_radius": 0.12,
            "barrier_gain": 150.0,
            "projection_distance": 0.03,
            "velocity_magnitude_limit": 0.2,
            "boundary_points": None,
        },
    },
    (2, "controllers"): {
        "create_si_position_controller": {
            "x_velocity_gain": 0.8,
            "y_velocity_gain": 0.8,
            "velocity_magnitude_limit": 0.15,
        },
        "create_uni_position_controller": {
            "x_velocity_gain": 0.8,
            "y_velocity_gain": 0.8,
            "velocity_magnitude_limit": 0.15,
            "projection_distance": 0.03,
        },
        "create_pose_controller_clf": {
            "approach_angle_gain": 1.0,
            "desired_angle_gain": 2.7,
            "rotation_error_gain": 1.0,
            "wheel_velocity_limit": 10.0,
            "wheel_radius": 0.016,
            "base_length": 0.105,
        },
        "create_pose_controller_hybrid": {
            "linear_velocity_gain": 0.8,
            "angular_velocity_limit": pi,
            "velocity_magnitude_limit": 0.15,
            "position_error": 0.03,
            "position_epsilon": 0.01,
            "rotation_error": 0.05,
        },
        "create_pose_parking_controller_clf": {
            "approach_angle_gain": 1.0,
            "desired_angle_gain": 2.7,
            "rotation_error_gain": 1.0,
            "wheel_velocity_limit": 10.0,
            "wheel_radius": 0.016,
            "base_length": 0.105,
            "position_error": 0.05,
            "rotation_error": 0.2,
        },
        "create_pose_parking_controller_hybrid": {
            "linear_velocity_gain": 0.8,
            "angular_velocity_limit": pi,
            "velocity_magnitude_limit": 0.15,
            "position_error": 0.05,
            "position_epsilon": 0.01,
            "rotation_error": 0.2,
        },
    },
    (2, "misc"): {
        "generate_initial_poses": {"width": 3.0, "height": 1.0},
        "generate_random_poses": {"spacing": 0.5, "width": 3.0, "height": 1.8},
        "generate_random_positions": {"spacing": 0.5, "width": 3.0, "height": 1.8},
        "create_at_pose": {"position_error": 0.05, "rotation_error": 0.2},
        "create_at_position": {"position_error": 0.05},
    },
    (2, "transformations"): {
        "create_si_to_uni_dynamics": {"linear_velocity_gain": 1.0, "angular_velocity_limit": pi},
        "create_si_to_uni_dynamics_with_backwards_motion": {"linear_velocity_gain": 1.0, "angular_velocity_limit": pi},
        "create_si_to_uni_mapping": {"projection_distance": 0.05},
        "create_uni_to_si_mapping": {"projection_distance": 0.05},
    },
}


@pytest.mark.parametrize(
    ("version", "module", "name"),
    [(version, module, name) for (version, module), functions in DEFAULTS.items() for name in functions],
)
def test_what_is_left_out_is_what_it_is_there(version: int, module: str, name: str) -> None:
    function = getattr(importlib.import_module(f"robots.rps.version{version}.{module}"), name)
    given = {key: value.default for key, value in inspect.signature(function).parameters.items()}
    expected = DEFAULTS[version, module][name]
    assert {key: given[key] for key in expected} == expected


CONSTANTS: dict[str, object] = {
    "TIME_STEP": 0.033,
    "MAX_LINEAR_VELOCITY": 0.2,
    "MAX_ANGULAR_VELOCITY": 2.0 * 0.2 / 0.11,
    "MAX_WHEEL_VELOCITY": 0.2 / 0.016,
    "ROBOT_DIAMETER": 0.11,
    "WHEEL_RADIUS": 0.016,
    "BASE_LENGTH": 0.11,
    "COLLISION_DIAMETER": 0.135,
    "COLLISION_OFFSET": 0.025,
    "BOUNDARIES": [-1.6, 1.6, -1.0, 1.0],
    "CENTER_OFFSET": 0.01,
    "DISTANCE_SENSOR_ERROR": 0.03,
    "DISTANCE_SENSOR_DROPOUT_PROB": 0.035,
    "DISTANCE_SENSOR_OUTLIER_PROB": 0.014,
    "DISTANCE_SENSOR_RANGE": 1.2,
    "DISTANCE_SENSORS_ORIENTATION": [
        [-0.04, 0.0, 0.04, 0.05, 0.04, 0.0, -0.04],
        [0.04, 0.06, 0.05, 0.0, -0.05, -0.06, -0.04],
        [pi, pi / 2.0, pi / 4.0, 0.0, -pi / 4.0, -pi / 2.0, -pi],
    ],
    "ENCODER_COUNTS_PER_REVOLUTION": 28,
    "MOTOR_GEAR_RATIO": 100.37,
    "ENCODER_NOISE_STD": 0.25,
    "IMU_ORIENTATION": [0.0594 - 0.00319, 0.0344628 - 0.0475, 0.0],
    "ACCELEROMETER_NOISE_STDS": [0.012929, 0.012127, 0.052979],
    "GYRO_NOISE_STDS": [0.001663, 0.001216, 0.002372],
    "MAGNETOMETER_NOISE_STDS": [3.275843, 2.365798, 5.232685],
    "MAGNETOMETER_Z_AVG": -39.8594,
    "MAGNETOMETER_XY_AVG": 6.0712,
    "ORIENTATION_NOISE_STD": 0.310830,
}


@pytest.mark.parametrize("name", CONSTANTS)
def test_a_constant_is_that_of_the_public_simulator(name: str) -> None:
    np.testing.assert_allclose(getattr(constants, name), np.array(CONSTANTS[name], dtype=float), rtol=1e-12)
