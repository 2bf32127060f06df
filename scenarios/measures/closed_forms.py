"""What the theory says of a scenario in closed form: noise, bias, growth, delay, dwell, and who comes near whom."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from formation import agents, decay_rates
from formation.analysis.amplification import dwell_errors, peak_gains, transient_gain
from formation.analysis.cascade import Cascade
from formation.analysis.collisions import crossed_sight_lines, neighbour_clearance, others_clearance, settled_within
from formation.analysis.margins import longest_period, most_periods
from formation.analysis.noise import bias_gains, noise_power, noise_rms
from formation.plane import as_complex
from robots.safety import FilterSettings, delayed_settings
from scenarios.definition.experiment import Experiment
from scenarios.measures.predictions.theory import cascade, has_closed_loop
from scenarios.measures.tracking import predicted_ends

Real = NDArray[np.float64]
Index = NDArray[np.intp]

CENTIMETRE = 0.01
"""Metres: the sensor noise of each coordinate that is taken where the scenario has none."""

MANY = 60
"""Agents up to which gains over all frequencies and growth are computed."""

AMPLIFIES = 3.0
"""A cascade whose noise or errors grow by more than this is warned of."""


@dataclass(frozen=True, eq=False)
class ClosedForms:
    """Of the last phase of a scenario, from a start.

    Attributes:
        loop: the closed loop.
        noise: (n,) rms error of each agent, metres; of a centimetre in each coordinate if the scenario has no noise.
        paper_noise: (n,) the same if every follower's own gain were 1.
        assumed: whether that is so.
        bias: (n,) metres of offset for a metre of independent constant errors.
        growth: the largest norm of e^{Mt}, and when, seconds; None for many agents.
        gains: H-infinity of measurement errors (m/m) and of velocity disturbances (s); None for many agents.
        longest_period: control period, seconds, below which held commands decay.
        most_periods: of delay that held commands stand where a robot does not undo its own displacement.
        start_speed: the largest velocity that the law asks for at the start, m/s.
        turning_limit: speed, m/s, above which a heading does not settle, with the robot's knowledge of its turn.
        period: control period, seconds.
        dwell: the largest error that switching delta by 90 degrees back and forth at the end of the shortest phase
            leaves, metres, and that phase's length, seconds; None where delta does not change or agent 2 is not steered
            by displacement.
        filter: the settings that the delay asks for; None without delay or without filter.
    """

    loop: Cascade
    noise: Real
    paper_noise: Real
    assumed: bool
    bias: Real
    growth: tuple[float, float] | None
    gains: tuple[float, float] | None
    longest_period: float
    most_periods: int | None
    start_speed: float
    turning_limit: float
    period: float
    dwell: tuple[float, float] | None
    filter: FilterSettings | None

    @property
    def last_over_first(self) -> float:
        """Noise of the noisiest follower over that of the first in the cascade; 1 where that has none or no bound."""
        followers = self.noise[agents.FIRST_ORDINARY :]
        return float(followers.max() / followers[0]) if 0.0 < followers[0] < np.inf else 1.0


@dataclass(frozen=True, eq=False)
class Passages:
    """Who comes near whom while followers start one after the other (Lemma 3, exact).

    Attributes:
        neighbours: (n - 2,) metres below which a follower never comes to a neighbour that stands in its place.
        roughly: (n - 2,) the same while neighbours count as settled within `law.settled_m`.
        others: (n - 2,) metres between its way and that of the nearest agent that it has no edge with.
        nearest: (n - 2,) row of that agent; -1 where there is none.
        crossings: (k, i, m) rows: m crosses k's line of sight to i.
    """

    neighbours: Real
    roughly: Real
    others: Real
    nearest: Index
    crossings: list[tuple[int, int, int]]


def closed_forms(experiment: Experiment, start: Real) -> ClosedForms | None:
    """All of it, from agents at ``start`` (n, 2), metres; None for a law that is not eq. (man)."""
    if not has_closed_loop(experiment):
        return None
    scenario, table = experiment.scenario, experiment.scenario.sensor
    loop = cascade(experiment, start, len(experiment.phases) - 1)
    period, end = scenario.plant.control_period_s, predicted_ends(experiment, start)[-1]
    assumed = table.position_noise_m == table.bearing_noise_deg == 0.0
    power = noise_power(
        loop, end, CENTIMETRE if assumed else table.position_noise_m, float(np.radians(table.bearing_noise_deg))
    )
    if experiment.first_follower in ("distance", "bearing"):
        power[0] /= 2.0  # these laws see one of the two coordinates
    noise = noise_rms(loop, period, power)
    modes = -loop.rates[loop.rates > 0.0]
    undone = table.own_motion != "unknown"
    late = table.delay_periods * period
    few = experiment.n <= MANY
    filtered = late > 0.0 and experiment.safety == "decentralised"
    speed = float(np.min(experiment.fleet.drive.speed_limit))
    return ClosedForms(
        loop=loop,
        noise=noise,
        paper_noise=noise
        if experiment.own_gains is None
        else noise_rms(replace(loop, rates=_paper_rates(experiment, loop)), period, power),
        assumed=assumed,
        bias=bias_gains(loop),
        growth=transient_gain(loop) if few else None,
        gains=peak_gains(loop) if few else None,
        longest_period=longest_period(modes),
        most_periods=most_periods(modes, period),
        start_speed=float(np.abs(_first_velocity(loop, start, experiment)).max()),
        turning_limit=experiment.fleet.nid.turning_limit(period, 0 if undone else table.delay_periods),
        period=period,
        dwell=_dwell(experiment, loop),
        filter=delayed_settings(experiment.filter_settings, late, speed) if filtered else None,
    )


def passages(experiment: Experiment, start: Real) -> Passages | None:
    """Who comes near whom in sequential activation; None where agents 1 and 2 move, or the law is another one."""
    at_rest = len(experiment.phases) == 1 and not experiment.phases[0].moving
    if not has_closed_loop(experiment) or not at_rest or experiment.first_follower != "stationary":
        return None
    target, end = experiment.target, predicted_ends(experiment, start)[-1]
    others, nearest = others_clearance(target, start, end)
    settled = settled_within(target, experiment.scenario.law.settled_m)
    return Passages(
        neighbours=neighbour_clearance(target, start, end),
        roughly=neighbour_clearance(target, start, end, settled),
        others=others,
        nearest=nearest,
        crossings=crossed_sight_lines(target, start, end),
    )


def _paper_rates(experiment: Experiment, loop: Cascade) -> Real:
    """(n - 1,) the rates without the followers' own gains, 1/s."""
    return np.concatenate([loop.rates[:1], decay_rates(experiment.target)])


def _first_velocity(loop: Cascade, start: Real, experiment: Experiment) -> NDArray[np.complex128]:
    """(n - 2,) what the followers are asked for at the start, m/s."""
    velocity = complex(*experiment.phases[0].velocity)
    return loop.apply(as_complex(start))[agents.FIRST_ORDINARY :] + velocity


def _dwell(experiment: Experiment, loop: Cascade) -> tuple[float, float] | None:
    deltas = [phase.displacement for phase in experiment.phases]
    last = deltas[-1]
    if experiment.first_follower != "displacement" or last is None or len(set(deltas)) < 2:
        return None
    shortest = min(phase.duration for phase in experiment.phases)
    return float(dwell_errors(experiment.target, loop, shortest, last * (1.0 + 1.0j)).max()), shortest
