"""The text of a script that runs a scenario's law on the Robotarium: numpy, ``rps`` and nothing else."""

from __future__ import annotations

from formation import agents, decay_rates
from robots import GTERNAL
from robots.model import CONTROL_PERIOD
from scenarios.definition.experiment import Experiment
from scenarios.export import pieces
from scenarios.export.certificate import safety_text
from scenarios.export.course import course_text
from scenarios.export.laws import law_text
from scenarios.export.listing import renumbered, rows_by_number
from scenarios.export.portable import start_poses
from scenarios.export.wording import WIDTH, prose, table

_ROUNDING = 1e-9  # a wheel commanded at exactly its limit trips the testbed's check by rounding


def script(experiment: Experiment, seed: int = 0) -> str:
    """The script that runs ``experiment`` from the start of the run with that seed.

    Raises:
        InputError: the testbed cannot run the scenario; the message names the field.
    """
    poses = start_poses(experiment, seed).tolist()
    law, safety = law_text(experiment), safety_text(experiment)
    course = course_text(experiment)
    return pieces.SCRIPT.format(
        introduction=_introduction(experiment, seed, law.saying),
        certificate_import=safety.imported,
        n=experiment.n,
        whom="those of AGENTS" if renumbered(experiment) else "agents 1 to N",
        numbers=_numbers(experiment) if renumbered(experiment) else "",
        period=CONTROL_PERIOD,
        start=table([repr(value) for value in pose] for pose in poses),
        tables=law.tables,
        ahead=experiment.nid.projection_distance,
        constants=_constants(experiment),
        functions=law.functions,
        obstacles=safety.constants,
        scaling=pieces.SCALING if experiment.scenario.robot.saturation == "scale" else "",
        certificate=safety.made,
        filtering=safety.used,
        indices=rows_by_number(experiment) + law.indices,
        body=law.body,
        more_functions=course["timed_functions"] + safety.functions,
        **course,
        **_estimation(experiment),
        **_activation(experiment),
        goal=experiment.goal,
    )


def _introduction(experiment: Experiment, seed: int, law: str) -> str:
    title = experiment.scenario.title.strip().rstrip(".") or experiment.file.name
    named = (
        "agents have the scenario's numbers"
        if renumbered(experiment)
        else "agents are numbered from 1, as in the paper"
    )
    return "\n\n".join(
        [
            prose(f"{title}."),
            prose(
                f"Scenario {experiment.file.name} from the start of seed {seed}, for the Robotarium; written by "
                "`formation export`. Needs numpy and the Robotarium's simulator, rps 2.1."
            ),
            prose(f"{law} Points and velocities in the plane are complex numbers x + iy, in m and m/s; {named}."),
        ]
    )


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
    place = "ROW[{}]" if renumbered(experiment) else "{} - 1"
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


def _numbers(experiment: Experiment) -> str:
    listed = ", ".join(map(str, experiment.numbers))
    line = f"AGENTS = [{listed}]"
    if len(line) > WIDTH:
        line = "AGENTS = [\n" + "".join(f"    {each},\n" for each in experiment.numbers) + "]"
    return f"# The agents' numbers, in the order of START.\n{line}\n\n"
