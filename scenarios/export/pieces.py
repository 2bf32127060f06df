"""The pieces of the scripts that scenarios become: Python with fields to fill in, nothing computed here."""

FIRST_FOLLOWER = {
    "stationary": "",
    "displacement": "    u[1] = delta - (p[1] - p[0])  # agent {number}, the first follower\n",
    "distance": (
        "    e = p[1] - p[0]  # agent {number}, the first follower\n    u[1] = (abs(delta) ** 2 - abs(e) ** 2) * e\n"
    ),
    "bearing": (
        "    b = (p[1] - p[0]) / abs(p[1] - p[0])  # agent {number}, the first follower\n"
        "    wanted = delta / abs(delta)\n"
        "    u[1] = wanted - b * (b.conjugate() * wanted).real\n"
    ),
    "spiral": (
        "    e = p[1] - p[0]  # agent {number}, the first follower\n"
        "    turn = np.log(e / delta * np.exp(-1e-6j)) + 1e-6j\n"
        "    u[1] = -e * turn\n"
    ),
}

SCALING = """\
    # Slow both wheels by one factor: the testbed would clip each by itself,
    # and so bend the path.
    wheel_speed = abs(v) + BASE_LENGTH / 2 * abs(omega)
    scale = WHEEL_SPEED / np.maximum(wheel_speed, WHEEL_SPEED)
    v, omega = scale * v, scale * omega
"""

ESTIMATE = """
# Who hears from whom; agents that are not told the velocity of all move what
# they believe it to be towards the mean of what they hear, by this share of
# the way in each period.
HEARS = [
{hears}
]
SHARE = {share}
MEAN = np.zeros((N, N))
for receiver, sender in HEARS:
    MEAN[{receiver}, {sender}] = 1.0
MEAN[0] = np.eye(N)[0]  # agent {leader} is told
MEAN /= MEAN.sum(axis=1, keepdims=True)
"""

BELIEVING = """\
            known[0] = velocity
            known += SHARE * (MEAN @ known - known)
"""

SLOW = """
# An agent has settled when both agents that it measures have and the law asks
# less than this of it (m/s); the first two have from the beginning.
SLOW = [
{slow}
]
"""

MAY_MOVE = '''

def may_move(settled):
    """Agents all of whose neighbours have settled."""
    return ~np.isin(np.arange(N), FOLLOWER[~settled[MEASURED]])
'''

WAITING = """\
            settled |= may_move(settled) & (abs(u) < SLOW)
            u *= may_move(settled)
            u += {common}
"""

CHANGING_GAINS = """\
GAINS = np.zeros((len(SHAPES), N, N), dtype=complex)
for shape, edges in enumerate(SHAPES):
    for follower, measured, gain in edges:
        GAINS[shape, {follower}, {measured}] += gain
        GAINS[shape, {follower}, {follower}] -= gain
"""

FEEDFORWARD = """\
# Agent, the two between which it measures, and the share of their distance
# that it adds, times the rate of the formation.
SHARES = [
{rows}
]
"""

FED = """\
    u[FED] += rate * SHARE * (p[FED_TO] - p[FED_FROM])
"""

STOPS = """
# Agents that stand still, from and until (s).
STOPS = [
{rows}
]
"""

STOPPED = '''

def stopped(t):
    """The rows of agents that stand still in the period that begins at t."""
    now = t + PERIOD / 2
    return [{row} for agent, begin, end in STOPS if begin <= now < end]
'''

COMMAND = """\
            robots.set_velocities(np.arange(N), unicycle(u, heading))
"""

COMMAND_UNLESS_STOPPED = """\
            command = unicycle(u, heading)
            command[:, stopped(t)] = 0
            robots.set_velocities(np.arange(N), command)
"""

SCRIPT = '''\
"""{introduction}
"""

import numpy as np
from rps.robotarium import Robotarium
{certificate_import}
SHOW_FIGURE = True  # False: no figure, and as fast as the computer can

N = {n}
PERIOD = {period}  # s, between two commands

{numbers}# Where the axles' centres start: x (m), y (m), heading (rad); {whom}.
START = [
{start}
]

{tables}
# Phase{columns}.
PHASES = [
{phases}
]
{reference}{stops}
{angles_told}
ANGLES = [
{angles}
]
GOAL = {goal}  # rad, for the sum of all angle errors

AHEAD = {ahead}  # m, from the axle's centre to the point that the law steers
{constants}
{indices}{vertices}TARGET = {target}
{estimate}{slow}{obstacles}{functions}

def law(p{arguments}):
    """Velocities of the points p, but for the velocity of all."""
    u = np.zeros(N, dtype=complex)
{body}    return u
{may_move}

def unicycle(u, heading):
    """The (2, N) v (m/s) and omega (rad/s) that move the points at u."""
    body = u * heading.conj()
    v, omega = body.real, body.imag / AHEAD
{scaling}    return np.array([v, omega])


def observe(robots):
    """The points that the law steers, and the headings as unit vectors."""
    x, y, theta = robots.get_poses()
    heading = np.exp(1j * theta)
    return x + 1j * y + AHEAD * heading, heading


def angle_errors(p{shape_argument}):
    """How far each angle is from its target, rad."""
    turn = (p[TO] - p[VERTEX]) / (p[FROM] - p[VERTEX])
    return np.angle(turn * np.exp(-1j * TARGET{of_shape}))
{more_functions}

def main():
    robots = Robotarium(
        number_of_robots=N,
        show_figure=SHOW_FIGURE,
        sim_in_real_time=SHOW_FIGURE,
        initial_conditions=np.array(START).T,
    )
{certificate}{known}{settled}{clock}    p, heading = observe(robots)
    for {items} in PHASES:
        for _ in range(round(duration / PERIOD)):
{telling}{believing}            u = law(p{arguments}){added}
{waiting}{filtering}{command}            robots.step()
{ticking}            p, heading = observe(robots)
        total = abs(angle_errors(p{shape_argument})).sum()
        print(f"{{name}}: the angle errors add up to {{total:.2e}} rad")

    print("angle at (from, to)    target    reached        error")
    for angle, error in zip(ANGLES, angle_errors(p{shape_argument}), strict=True):
        at, start, end, {target_item} = angle
{last_target}        degrees = np.degrees([target, (target + error) % (2 * np.pi)])
        print(
            f"{{at:5d}} ({{start:4d}}, {{end:4d}})"
            f" {{degrees[0]:9.2f}}  {{degrees[1]:9.2f}} deg  {{error:+.1e}} rad"
        )
    print(f"goal of {{GOAL}} rad: {{'reached' if total < GOAL else 'missed'}}")
    robots.debug()


if __name__ == "__main__":
    main()
'''
