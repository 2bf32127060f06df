"""What the robots run: from what they sense to the velocities that they command, law and safety filter included."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from formation import SequentialActivation
from formation.laws.feedforward import FeedForward
from robots.instruments import Disturbance
from robots.obstacles import standing
from robots.own_motion import OwnMotion, Sensed
from scenarios.definition.experiment import Experiment
from scenarios.simulation.guard import make_guard
from scenarios.simulation.outages import Outages
from scenarios.simulation.told import told

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


class Controller:
    """The formation law as the robots run it: body-frame velocities of the projected points from what they sense.

    A law gets the measurements that it declares, in body frames, and a compass only if it declares one. It never sees a
    position or a heading. The common velocity v_r is stated in the common frame, so following it takes a compass too.

    Attributes:
        active: (..., n) which agents follow the law; the others hold still but for v_r.
        guard: the safety filter; None without one.
        wish: (..., n, 2) what the law and v_r asked for last, in body frames, m/s.
        command: (..., n, 2) the same after the safety filter.
    """

    def __init__(self, experiment: Experiment, generators: Sequence[np.random.Generator], batch: tuple[int, ...]):
        self._experiment = experiment
        self._law = experiment.law
        self._outages = Outages.at(experiment, 0.0, 0)
        self._instruments = experiment.instruments
        self._observer = self._instruments.edges[:, 0]
        self._estimator = experiment.estimator
        self._generators = generators
        self._batch = batch
        self._disturbance: Disturbance | None = None
        self._commanded = np.zeros(2)
        self._velocity: Real | None = None
        self._delta: Real | None = None
        self._feedforward = FeedForward(experiment.target) if experiment.scenario.law.feedforward else None
        self._keeps = experiment.scenario.law.without_neighbour == "keep-last"
        self._last: Real | None = None
        self._shape = experiment.of_phase(0)
        self._phase = experiment.phases[0]
        self._clock = self._begin = 0.0
        self._rate = 0j
        self.guard = make_guard(experiment, batch)
        scenario = experiment.scenario
        table = scenario.sensor
        self._own_motion = OwnMotion(
            table.delay_periods, table.own_motion, np.radians(table.gyro_noise_deg_s), table.encoder_noise_m_s
        )
        self._compass_error = self._draw_compass(np.radians(table.compass_bias_deg), experiment.n)
        self._activation = None
        self.active = np.ones((*batch, experiment.n), dtype=bool)
        self.wish = self.command = np.zeros((*batch, experiment.n, 2))
        if scenario.law.activation == "sequential":
            self._activation = self._sequence(experiment)
            self.active = self._activation.active
        if self._estimator is not None:
            self._velocity = np.zeros((*batch, experiment.n, 2))

    def begin_phase(self, index: int) -> None:
        """Take the commands of a phase, from its begin, and its shape, where that changes."""
        experiment = self._experiment
        phase = experiment.phases[index]
        if experiment.shapes:
            self._take_shape(experiment.shapes[index])
        self._phase, self._clock, self._rate = phase, 0.0, 0j
        self._commanded = np.array(phase.velocity)
        self._delta = None if phase.delta is None else np.array(phase.delta)
        if self._estimator is None:
            self._velocity = self._commanded if self._commanded.any() else None

    def take(self, outages: Outages) -> None:
        """Take what has become of robots, sensors and messages; the shape is that of the phase."""
        self._outages = outages
        self._instruments = outages.instruments(self._shape.instruments, self._experiment.scenario.sensor)

    def avoid(self, there: Sequence[bool]) -> None:
        """Let the safety filter know which obstacles are there."""
        if self.guard is not None:
            self.guard.filter.avoid(standing(self._experiment.arena.obstacles, there))

    def _take_shape(self, shape: Experiment) -> None:
        if shape is self._shape:
            return
        self._shape, self._law, self._instruments = shape, shape.law, shape.instruments
        self._observer = self._instruments.edges[:, 0]
        if self._feedforward is not None:
            self._feedforward = FeedForward(shape.target)
        if self._activation is not None:
            self._activation = self._sequence(shape)
            self.active = self._activation.active

    def _sequence(self, shape: Experiment) -> SequentialActivation:
        return SequentialActivation(shape.target, shape.scenario.law.settled_m, self._batch, shape.own_gains)

    def begin_period(self, points: Real, headings: Real, period: float) -> None:
        """Do what happens once per control period: draw noise, exchange estimates of v_r, activate followers."""
        self._begin, self._clock = self._clock, self._clock + period
        self._take_reference(0.0)
        self._own_motion.begin_period(points, headings, period, self._generators)
        draws = [draw for rng in self._generators if (draw := self._instruments.draw(rng)) is not None]
        disturbance = Disturbance.stack(draws, self._batch) if draws else None
        if self._outages.blind:
            sensed = self._own_motion.sense(points, headings)
            disturbance = self._outages.disturb(disturbance, self._instruments, sensed)
        self._disturbance = disturbance
        if self.guard is not None:
            self.guard.begin_period(None if self._disturbance is None else self._disturbance.keys, period)
        if self._estimator is not None and self._velocity is not None:
            self._velocity = self._estimator.step(self._velocity, self._commanded, period, self._heard())
        if self._activation is not None:
            self._activation.update(self._feedback(self._own_motion.sense(points, headings)))

    def __call__(self, points: Real, headings: Real, elapsed: float) -> Real:
        velocity = self._command(points, headings, elapsed)
        if self._outages.stopped is not None:
            velocity[..., self._outages.stopped, :] = 0.0
        return velocity

    def _command(self, points: Real, headings: Real, elapsed: float) -> Real:
        self._take_reference(elapsed)
        sensed = self._own_motion.sense(points, headings)
        feedback = self._feedback(sensed)
        if self._activation is not None:
            feedback *= self.active[..., None]
        if self._velocity is None:
            common, self.wish = np.zeros_like(feedback), feedback
        else:
            velocity = np.ascontiguousarray(self._velocity).view(np.complex128)
            common = (velocity * self._compass(sensed.headings)).view(np.float64)
            self.wish = feedback + common
        self.command = self.wish if self.guard is None else self.guard(sensed, feedback, common)
        return self.command

    def _take_reference(self, elapsed: float) -> None:
        """What agents are told so many seconds into the period, where that changes during a phase."""
        if self._phase.reference is None:
            return
        self._commanded, self._delta, rate = told(self._phase, self._begin, self._clock, elapsed)
        self._rate = complex(rate)
        if self._estimator is None:
            self._velocity = self._commanded

    def _feedback(self, sensed: Sensed) -> Real:
        """The law's own velocities, without v_r."""
        disturbance = self._disturbance
        measured = self._instruments.deliver(
            self._instruments.measure(sensed.others, sensed.headings, sensed.own), disturbance
        )
        compass = self._compass(sensed.headings).view(np.float64) if self._law.needs_compass else None
        feedback = self._law(*measured, compass, self._delta)
        if self._feedforward is not None and self._rate != 0.0:
            feedback += self._feedforward(measured[0], self._rate)
        if disturbance is not None and disturbance.lost is not None:
            self._do_without(feedback, disturbance.lost)
        if self._keeps:
            self._last = feedback.copy()
        return feedback

    def _do_without(self, feedback: Real, lost: NDArray[np.bool_]) -> None:
        """An agent whose law gives no number because edges (..., m) are lost does not move, or goes on as it did."""
        blind = lost @ (self._observer[:, None] == np.arange(feedback.shape[-2]))
        blind &= np.isnan(feedback).any(axis=-1)
        feedback[blind] = 0.0 if self._last is None else self._last[blind]

    def _heard(self) -> NDArray[np.bool_] | None:
        """(..., m) which messages arrive in this period; None where all do, and then nothing is drawn."""
        loss, estimator = self._outages.message_loss, self._estimator
        if estimator is None or loss == 0.0:
            return None
        arrives = [rng.random(len(estimator.edges)) >= loss for rng in self._generators]
        return np.stack(arrives).reshape(*self._batch, -1)

    def _compass(self, headings: Real) -> Complex:
        """(..., n, 1) the common x axis in each body frame as a complex number, as each robot's compass shows it."""
        compass = np.conj(headings.view(np.complex128))
        return compass if self._compass_error is None else compass * self._compass_error

    def _draw_compass(self, deviation: float, n: int) -> Complex | None:
        if deviation == 0.0:
            return None
        errors = np.stack([rng.normal(0.0, deviation, n) for rng in self._generators])
        return np.exp(1j * errors).reshape(*self._batch, n, 1)
