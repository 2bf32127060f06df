"""The text of a script that runs a scenario's law on the Robotarium: numpy, ``rps`` and nothing else."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

from formation import AngleLaw, agents, decay_rates
from robots import GTERNAL
from robots.model import CONTROL_PERIOD
from robots.safety.certificate import BARRIER_GAIN, BOUNDARY_MARGIN, SAFETY_RADIUS
from scenarios.definition.experiment import Experiment
from scenarios.errors import InputError
from scenarios.export import pieces
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
    return pieces.SCRIPT.format(
        introduction=_introduction(experiment, seed),
        certificate_import=pieces.CERTIFICATE_IMPORT if filtered else "",
        n=experiment.n,
        whom="those of AGENTS" if renumbered else "agents 1 to N",
        numbers=_numbers(experiment) if renumbered else "",
        indices=pieces.BY_NUMBER if renumbered else pieces.BY_ROW,
        period=CONTROL_PERIOD,
        start=table([repr(value) for value in pose] for pose in poses),
        edges=table(edges),
        phases=table(_phases(experiment)),
        told=f", and agent {first} as seen from agent {leader}" if steered else "",
        argument=", delta" if steered else "",
        angles=table(angles),
        ahead=experiment.nid.projection_distance,
        constants=_constants(experiment),
        first_follower=pieces.FIRST_FOLLOWER[experiment.first_follower].format(number=first),
        scaling=pieces.SCALING if experiment.scenario.robot.saturation == "scale" else "",
        certificate=_certificate(experiment) if filtered else "",
        filtering=pieces.FILTERING if filtered else "",
        **_estimation(experiment),
        **_activation(experiment),
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


def _estimation(experiment: Experiment) -> dict[str, str]:
    """The pieces with which agents learn the velocity of all; without, all are told."""
    estimator = experiment.estimator
    if estimator is None:
        return {"estimate": "", "believing": "", "known": ""}
    place = "ROW[{}]" if _renumbered(experiment) else "{} - 1"
    return {
        "estimate": pieces.ESTIMATE.format(
            hears=table([repr(number) for number in edge] for edge in experiment.numbered(estimator.edges).tolist()),
            share=repr(estimator.share(CONTROL_PERIOD)),
            receiver=place.format("receiver"),
            sender=place.format("sender"),
            leader=experiment.number(agents.LEADER),
        ),
        "believing": pieces.BELIEVING,
        "known": "    known = np.zeros(N, dtype=complex)\n",
    }


def _activation(experiment: Experiment) -> dict[str, str]:
    """The pieces with which followers wait for their neighbours, and the velocity of all that is added then."""
    common = "velocity" if experiment.estimator is None else "known"
    law = experiment.scenario.law
    if law.activation != "sequential":
        return {"added": f" + {common}", "waiting": "", "may_move": "", "slow": "", "settled": ""}
    gains = 1.0 if experiment.own_gains is None else experiment.own_gains
    slow = (law.settled_m * gains * decay_rates(experiment.target)).tolist()
    return {
        "added": "",
        "waiting": pieces.WAITING.format(common=common),
        "may_move": pieces.MAY_MOVE,
        "slow": pieces.SLOW.format(slow="\n".join(f"    {value!r}," for value in [0.0, 0.0, *slow])),
        "settled": "    settled = np.arange(N) < 2\n",
    }


def _certificate(experiment: Experiment) -> str:
    # In the place of another filter it also keeps robots on the floor, beyond which its own default boundary lies.
    arena = experiment.arena
    substitute = experiment.scenario.safety.filter != "robotarium"
    margin = 0.0 if substitute else BOUNDARY_MARGIN
    return pieces.CERTIFICATE.format(
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
