"""The text of a script that runs a scenario's law on the Robotarium: numpy, ``rps`` and nothing else."""

# Longer than 300 lines: half of them are the script's own text.

from __future__ import annotations

import textwrap
from collections.abc import Iterable

from formation import AngleLaw, agents
from robots import GTERNAL
from robots.model import CONTROL_PERIOD
from robots.safety.certificate import BARRIER_GAIN, BOUNDARY_MARGIN, SAFETY_RADIUS
from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError
from scenarios.export.portable import start_poses

WIDTH = 79
"""Columns of a line, PEP 8."""

_ROUNDING = 1e-9  # a wheel commanded at exactly its limit trips the testbed's check by rounding


def script(experiment: Experiment, seed: int = 0) -> str:
    """The script that runs ``experiment`` from the start of the run with that seed.

    Raises:
        InputError: the testbed cannot run the scenario; the message names the field.
    """
    law = experiment.law
    if not isinstance(law, AngleLaw):
        name = experiment.scenario.law.name
        raise InputError(f"{experiment.file.path}: law.name: a script for the testbed needs 'angle', got {name!r}")
    poses = start_poses(experiment, seed).tolist()
    observer, observed = (column[1:].tolist() for column in experiment.graph.edges.T)
    edges = [
        (repr(experiment.number(k)), repr(experiment.number(i)), number(gain))
        for k, i, gain in zip(observer, observed, law.gains.ravel().tolist(), strict=True)
    ]
    angles = [
        (*(repr(experiment.number(row)) for row in triple), repr(target))
        for triple, target in zip(experiment.angles.triples.tolist(), experiment.target_angles.tolist(), strict=True)
    ]
    steered = experiment.first_follower != "stationary"
    filtered = experiment.scenario.safety.filter != "none"
    leader, first = (experiment.number(row) for row in (agents.LEADER, agents.FIRST_FOLLOWER))
    renumbered = _renumbered(experiment)
    return _SCRIPT.format(
        introduction=_introduction(experiment, seed),
        certificate_import=_CERTIFICATE_IMPORT if filtered else "",
        n=experiment.n,
        whom="those of AGENTS" if renumbered else "agents 1 to N",
        numbers=_numbers(experiment) if renumbered else "",
        indices=_BY_NUMBER if renumbered else _BY_ROW,
        period=CONTROL_PERIOD,
        start=table([repr(value) for value in pose] for pose in poses),
        edges=table(edges),
        phases=table(_phases(experiment)),
        told=f", and agent {first} as seen from agent {leader}" if steered else "",
        argument=", delta" if steered else "",
        angles=table(angles),
        ahead=experiment.nid.projection_distance,
        constants=_constants(experiment),
        first_follower=_FIRST_FOLLOWER[experiment.first_follower].format(number=first),
        scaling=_SCALING if experiment.scenario.robot.saturation == "scale" else "",
        certificate=_certificate(experiment) if filtered else "",
        filtering=_FILTERING if filtered else "",
        goal=experiment.goal,
    )


def number(value: complex) -> str:
    """A complex number as Python writes it, without its zero part; every digit is kept.

    >>> number(0.5 - 0.25j), number(0.35 + 0j), number(-0.01j)
    ('0.5 - 0.25j', '0.35', '-0.01j')
    """
    if value.imag == 0.0:
        return repr(value.real)
    if value.real == 0.0:
        return f"{value.imag!r}j"
    return f"{value.real!r} {'-' if value.imag < 0.0 else '+'} {abs(value.imag)!r}j"


def quoted(text: str) -> str:
    """A string literal, in double quotes where that needs no escapes.

    >>> print(quoted("turn"), quoted('the "turn"'))
    "turn" 'the "turn"'
    """
    literal = repr(text)
    return f'"{literal[1:-1]}"' if literal[0] == "'" and '"' not in text else literal


def table(rows: Iterable[Iterable[str]]) -> str:
    """The lines of a list of tuples; a tuple that is too long for one line takes a line for each item."""
    lines = []
    for row in rows:
        items = list(row)
        line = f"    ({', '.join(items)}),"
        if len(line) > WIDTH:
            line = "\n".join(["    (", *(f"        {item}," for item in items), "    ),"])
        lines.append(line)
    return "\n".join(lines)


def prose(text: str) -> str:
    """Text for a docstring: wrapped, and nothing in it that could end the docstring or the line."""
    plain = "".join(character if character.isprintable() else " " for character in text)
    return textwrap.fill(
        plain.replace("\\", "\\\\").replace('"""', '\\"\\"\\"'), WIDTH, break_long_words=False, break_on_hyphens=False
    )


def _introduction(experiment: Experiment, seed: int) -> str:
    title = experiment.scenario.title.strip().rstrip(".") or experiment.file.name
    named = (
        "agents have the scenario's numbers"
        if _renumbered(experiment)
        else "agents are numbered from 1, as in the paper"
    )
    return "\n\n".join(
        [
            prose(f"{title}."),
            prose(
                f"Scenario {experiment.file.name} from the start of seed {seed}, for the Robotarium; written by "
                "`formation export`. Needs numpy and the Robotarium's simulator, rps 2.1."
            ),
            prose(
                "Every follower measures the relative positions of two others and steers the angles of their triangle "
                'to those of the target: Li, Shen, Jing, Song, "Angle-Constrained Formation Control under Directed '
                'Non-Triangulated Sensing Graphs", Automatica. Points and velocities in the plane are complex numbers '
                f"x + iy, in m and m/s; {named}."
            ),
        ]
    )


def _phases(experiment: Experiment) -> list[list[str]]:
    rows = []
    for phase in experiment.phases:
        rows.append([quoted(phase.name), repr(phase.duration), number(complex(*phase.velocity))])
        if experiment.first_follower != "stationary" and phase.delta is not None:
            rows[-1].append(number(complex(*phase.delta)))
    return rows


def _constants(experiment: Experiment) -> str:
    if experiment.scenario.robot.saturation != "scale":
        return ""
    drive = GTERNAL.drive
    return (
        f"BASE_LENGTH = {drive.base_length}  # m, between the wheels\n"
        f"WHEEL_SPEED = {drive.speed_limit} * (1 - {_ROUNDING})  # m/s, just below the testbed's limit\n"
    )


def _certificate(experiment: Experiment) -> str:
    # In the place of another filter it also keeps robots on the floor, beyond which its own default boundary lies.
    arena = experiment.arena
    substitute = experiment.scenario.safety.filter != "robotarium"
    margin = 0.0 if substitute else BOUNDARY_MARGIN
    return _CERTIFICATE.format(
        why=f"In place of the scenario's {experiment.scenario.safety.filter} filter"
        if substitute
        else "As in the scenario",
        radius=SAFETY_RADIUS,
        gain=BARRIER_GAIN,
        boundary=[round(x + side * margin, 9) for x, side in zip((*arena.x, *arena.y), (-1, 1, -1, 1), strict=True)],
    )


def _renumbered(experiment: Experiment) -> bool:
    return experiment.numbers != tuple(range(1, experiment.n + 1))


def _numbers(experiment: Experiment) -> str:
    listed = ", ".join(map(str, experiment.numbers))
    line = f"AGENTS = [{listed}]"
    if len(line) > WIDTH:
        line = "AGENTS = [\n" + "".join(f"    {each},\n" for each in experiment.numbers) + "]"
    return f"# The agents' numbers, in the order of START.\n{line}\n\n"


_FIRST_FOLLOWER = {
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

_BY_ROW = """\
FOLLOWER, MEASURED = np.array([edge[:2] for edge in EDGES]).T - 1
GAIN = np.array([edge[2] for edge in EDGES])
VERTEX, FROM, TO = np.array([angle[:3] for angle in ANGLES]).T - 1
"""

_BY_NUMBER = """\
ROW = {agent: row for row, agent in enumerate(AGENTS)}
FOLLOWER, MEASURED = np.array([[ROW[k] for k in edge[:2]] for edge in EDGES]).T
GAIN = np.array([edge[2] for edge in EDGES])
VERTEX, FROM, TO = np.array([[ROW[k] for k in angle[:3]] for angle in ANGLES]).T
"""

_SCALING = """\
    # Slow both wheels by one factor: the testbed would clip each by itself,
    # and so bend the path.
    wheel_speed = abs(v) + BASE_LENGTH / 2 * abs(omega)
    scale = WHEEL_SPEED / np.maximum(wheel_speed, WHEEL_SPEED)
    v, omega = scale * v, scale * omega
"""

_CERTIFICATE_IMPORT = """\
from rps.utilities.barrier_certificates import (
    create_si_barrier_certificate_with_boundary,
)
"""

_CERTIFICATE = """\
    # {why}.
    certificate = create_si_barrier_certificate_with_boundary(
        safety_radius={radius},  # m, between two steered points
        barrier_gain={gain},
        boundary_points=np.array({boundary}),
    )
"""

_FILTERING = """\
            wish, points = (np.array([z.real, z.imag]) for z in (u, p))
            vx, vy = certificate(wish, points)
            u = vx + 1j * vy
"""

_SCRIPT = '''\
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


def law(p{argument}):
    """Velocities of the points p, but for the velocity of all."""
    u = np.zeros(N, dtype=complex)
    np.add.at(u, FOLLOWER, GAIN * (p[MEASURED] - p[FOLLOWER]))
{first_follower}    return u


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
{certificate}    p, heading = observe(robots)
    for name, duration, velocity{argument} in PHASES:
        for _ in range(round(duration / PERIOD)):
            u = law(p{argument}) + velocity
{filtering}            robots.set_velocities(np.arange(N), unicycle(u, heading))
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
