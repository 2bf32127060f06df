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
}

BY_ROW = """\
FOLLOWER, MEASURED = np.array([edge[:2] for edge in EDGES]).T - 1
GAIN = np.array([edge[2] for edge in EDGES])
VERTEX, FROM, TO = np.array([angle[:3] for angle in ANGLES]).T - 1
"""

BY_NUMBER = """\
ROW = {agent: row for row, agent in enumerate(AGENTS)}
FOLLOWER, MEASURED = np.array([[ROW[k] for k in edge[:2]] for edge in EDGES]).T
GAIN = np.array([edge[2] for edge in EDGES])
VERTEX, FROM, TO = np.array([[ROW[k] for k in angle[:3]] for angle in ANGLES]).T
"""

SCALING = """\
    # Slow both wheels by one factor: the testbed would clip each by itself,
    # and so bend the path.
    wheel_speed = abs(v) + BASE_LENGTH / 2 * abs(omega)
    scale = WHEEL_SPEED / np.maximum(wheel_speed, WHEEL_SPEED)
    v, omega = scale * v, scale * omega
"""

CERTIFICATE_IMPORT = """\
from rps.utilities.barrier_certificates import (
    create_si_barrier_certificate_with_boundary,
)
"""

CERTIFICATE = """\
    # {why}.
    certificate = create_si_barrier_certificate_with_boundary(
        safety_radius={radius},  # m, between two steered points
        barrier_gain={gain},
        boundary_points=np.array({boundary}),
    )
"""

FILTERING = """\
            wish, points = (np.array([z.real, z.imag]) for z in (u, p))
            vx, vy = certificate(wish, points)
            u = vx + 1j * vy
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

# Follower, agent that it measures, and the law's gain (1/s), eq. (u).
EDGES = [
{edges}
]

# Phase, its length (s), the velocity of all{told}.
PHASES = [
{phases}
]

# Angle at an agent, counter-clockwise from one agent to another; target (rad).
ANGLES = [
{angles}
]
GOAL = {goal}  # rad, for the sum of all angle errors

AHEAD = {ahead}  # m, from the axle's centre to the point that the law steers
{constants}
{indices}TARGET = np.array([angle[3] for angle in ANGLES])
{estimate}{slow}

def law(p{argument}):
    """Velocities of the points p, but for the velocity of all."""
    u = np.zeros(N, dtype=complex)
    np.add.at(u, FOLLOWER, GAIN * (p[MEASURED] - p[FOLLOWER]))
{first_follower}    return u
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


def angle_errors(p):
    """How far each angle is from its target, rad."""
    turn = (p[TO] - p[VERTEX]) / (p[FROM] - p[VERTEX])
    return np.angle(turn * np.exp(-1j * TARGET))


def main():
    robots = Robotarium(
        number_of_robots=N,
        show_figure=SHOW_FIGURE,
        sim_in_real_time=SHOW_FIGURE,
        initial_conditions=np.array(START).T,
    )
{certificate}{known}{settled}    p, heading = observe(robots)
    for name, duration, velocity{argument} in PHASES:
        for _ in range(round(duration / PERIOD)):
{believing}            u = law(p{argument}){added}
{waiting}{filtering}            robots.set_velocities(np.arange(N), unicycle(u, heading))
            robots.step()
            p, heading = observe(robots)
        total = abs(angle_errors(p)).sum()
        print(f"{{name}}: the angle errors add up to {{total:.2e}} rad")

    print("angle at (from, to)    target    reached        error")
    for angle, error in zip(ANGLES, angle_errors(p), strict=True):
        at, start, end, target = angle
        degrees = np.degrees([target, (target + error) % (2 * np.pi)])
        print(
            f"{{at:5d}} ({{start:4d}}, {{end:4d}})"
            f" {{degrees[0]:9.2f}}  {{degrees[1]:9.2f}} deg  {{error:+.1e}} rad"
        )
    print(f"goal of {{GOAL}} rad: {{'reached' if total < GOAL else 'missed'}}")
    robots.debug()


if __name__ == "__main__":
    main()
'''
