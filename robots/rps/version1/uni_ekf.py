"""An extended Kalman filter of a unicycle's pose from its wheels and places measured now and then, as in ``rps`` 1."""

from __future__ import annotations

import numpy as np

from robots.rps.columns import Real, wrapped


class UnicycleEKF:
    """Predicts by the unicycle's equations over dt by Euler, corrects by places in Joseph's form.

    Args:
        initial_state: (3,) x, y, theta, metres and radians.
        initial_covariance: (3, 3).
        b, r: base length and wheel radius, metres.
        M: (2, 2) covariance of the wheels' speeds, right and left, (rad/s)^2.
        Q: (3, 3) of the process, per second.
        R_gps: (2, 2) of a measured place, m^2; None where none is measured.
        R_imu: kept, and used by nothing.

    Attributes:
        state: (3,) the estimate.
        P: (3, 3) its covariance.
    """

    def __init__(
        self,
        initial_state: Real,
        initial_covariance: Real,
        b: float,
        r: float,
        M: Real,  # noqa: N803 (named by rps, here and below)
        Q: Real,  # noqa: N803
        R_gps: Real | None = None,  # noqa: N803
        R_imu: Real | None = None,  # noqa: N803
    ) -> None:
        self.state, self.P = initial_state, initial_covariance
        self.covariance = initial_covariance
        self.base_length, self.wheel_radius = b, r
        self.wheel_encoder_noise_covariance_matrix = M
        self.Q, self.R_gps, self.R_imu = Q, R_gps, R_imu

    def predict(self, v: float, w: float, dt: float) -> None:
        """Go on by dt, seconds, at v, m/s, and w, rad/s."""
        transition, wheels = self.form_F(v, dt), self.form_wheel_encoder_process_noise_matrix(dt)
        self.P = transition @ self.P @ transition.T + wheels + self.form_Q(dt)
        self.state = self.state + self.form_G(dt) @ np.array([v, w])
        self.state[2] = wrapped(self.state[2])

    def update_gps(self, gps_measurement: Real) -> None:
        """Take in a measured place (2,), metres.

        Raises:
            ValueError: there is no ``R_gps``.
        """
        if self.R_gps is None:
            raise ValueError("R_gps must be given to take in a measured place")
        place = np.eye(2, 3)
        gain = self.P @ place.T @ np.linalg.inv(place @ self.P @ place.T + self.R_gps)
        rest = np.eye(3) - gain @ place
        self.P = rest @ self.P @ rest.T + gain @ self.R_gps @ gain.T
        self.state = self.state + gain @ (gps_measurement - place @ self.state)

    def form_fx(self, v: float, w: float, dt: float) -> Real:
        """(3, 1) by how much the state moves in dt."""
        return (self.form_G(dt) @ np.array([v, w])).reshape(3, 1)

    def form_F(self, v: float, dt: float) -> Real:  # noqa: N802
        """(3, 3) the derivative of the next state with respect to this one."""
        transition = np.eye(3)
        transition[:2, 2] = v * dt * np.array([-np.sin(self.state[2]), np.cos(self.state[2])])
        return transition

    def form_G(self, dt: float) -> Real:  # noqa: N802
        """(3, 2) the derivative of the next state with respect to (v, w)."""
        return dt * np.array([[np.cos(self.state[2]), 0.0], [np.sin(self.state[2]), 0.0], [0.0, 1.0]])

    def form_Q(self, dt: float) -> Real:  # noqa: N802
        """(3, 3) what the process adds to the covariance in dt."""
        return self.Q * dt

    def form_wheel_encoder_process_noise_matrix(self, dt: float) -> Real:
        """(3, 3) what the wheels' noise adds to the covariance in dt."""
        half, turn = self.wheel_radius / 2.0, self.wheel_radius / self.base_length
        of_wheels = self.form_G(dt) @ np.array([[half, half], [turn, -turn]])
        return of_wheels @ self.wheel_encoder_noise_covariance_matrix @ of_wheels.T
