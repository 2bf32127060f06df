"""Whom each robot of a target should sense: candidates side by side, and the scenario of the one that is chosen."""

# Longer than 300 lines: a question, its answer, and the scenario and the table that tell it.

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from formation import agents
from formation.design.candidates import Candidate, Task, choose, evaluate, propose, unbeaten
from formation.design.closure import TIE, best_leaders, fastest
from formation.design.field import Choice, Field
from scenarios.definition.choice import needs_edge, scattered, sensed_edges
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.targets import in_order
from scenarios.documents import cell
from scenarios.errors import InputError
from scenarios.storage.files import write_whole
from scenarios.terminal import new_table, print_table

Real = NDArray[np.float64]

MOST_SHOWN = 12
"""Candidates that are printed, besides the given graph and those that nothing beats."""

OBJECTIVES = ("both", "settling", "noise")


@dataclass(frozen=True, eq=False)
class Question:
    """A target and what its graph may be.

    Attributes:
        name: of the target.
        experiment: the scenario; None where the target is a list of places.
        numbers: of the agents, in the field's order.
        field: places and allowed edges.
        task: what the graph is for.
        given: the scenario's own graph; None where there is none.
        leaders: rows of the leader and of the first follower; None to choose them too.
    """

    name: str
    experiment: Experiment | None
    numbers: tuple[int, ...]
    field: Field
    task: Task
    given: Choice | None
    leaders: tuple[int, int] | None


@dataclass(frozen=True, eq=False)
class Answer:
    """Candidates, best settling first, the given graph among them, and the one chosen."""

    question: Question
    given: Candidate | None
    candidates: list[Candidate]
    chosen: Candidate


def ask(
    source: str,
    changes: tuple[str, ...] = (),
    leaders: str = "free",
    edges: str = "all",
    within: float | None = None,
    sight: float | None = None,
    seed: int = 0,
) -> Question:
    """The question that a target poses.

    Args:
        source: a scenario's name or path, or a CSV file of places: x, y, or number, x, y, metres.
        changes: ``key=value`` texts, as with ``--set``.
        leaders: ``given``, ``free``, or two numbers, ``1,4``.
        edges: ``all``, ``given`` (the scenario's), or a CSV file of observer, observed.
        within: longest edge, metres in the target.
        sight: radius, metres, of a robot that hides what is behind it in the target.
        seed: of random starts.

    Raises:
        InputError: anything of these that cannot be used.
    """
    if source.endswith(".csv"):
        if changes:
            raise InputError(f"--set: only for a scenario, {source} is a list of places")
        numbers, places = _places(source)
        experiment, given, start = None, None, scattered(places)
        task = Task(start, "displacement")
    else:
        experiment = open_experiment(source, changes)
        if experiment.scenario.law.name != "angle":
            raise InputError(f"{source}: law.name: expected the angle law, got {experiment.scenario.law.name!r}")
        numbers, places = experiment.numbers, experiment.target.positions
        graph = experiment.target.graph
        given = Choice((0, 1), np.concatenate([np.full((2, 2), -1), graph.neighbours]), graph.depth)
        task = _task(experiment, seed)
    field = _allowed(source, experiment, numbers, places, edges)
    if within is not None:
        field = field.within(within)
    if sight is not None:
        field = field.in_sight(sight)
    return Question(source, experiment, numbers, field, task, given, _leaders(leaders, numbers))


def answer(question: Question, objective: str = "both") -> Answer:
    """The candidates and the best by an objective of :data:`OBJECTIVES`.

    Raises:
        InputError: no allowed graph reaches every agent.
    """
    field, task = question.field, question.task
    found = propose(field, task, question.leaders)
    if not found:
        raise InputError(f"{question.name}: no leader-first-follower graph of allowed edges reaches every agent")
    given = None if question.given is None else evaluate("as given", field, task, question.given)
    return Answer(question, given, found, choose(found, objective))


def print_answer(console: Console, found: Answer) -> None:
    """The candidates as a table, what was proved of rates, and the choice."""
    question = found.question
    front = unbeaten(found.candidates)
    shown = [each for each in found.candidates if each in front or each is found.chosen]
    shown += [each for each in found.candidates if each not in shown][: max(0, MOST_SHOWN - len(shown))]
    shown = sorted(shown, key=found.candidates.index)
    table = new_table(
        "graph", "leaders", "rate (1/s)", "depth", "settles (s)", "noise (mm/cm)", "bias", "delay (s)", "sensed by"
    )
    for each in ([] if found.given is None else [found.given]) + shown:
        mark = "> " if each is found.chosen else "* " if each in front else "  "
        a, b = (question.numbers[row] for row in each.choice.leaders)
        table.add_row(
            mark + each.name,
            f"{a}, {b}",
            f"{each.rate:.3f}",
            str(each.depth),
            cell(each.settling, ".1f"),
            f"{10.0 * each.noise:.2f}",
            f"{each.bias:.2f}",
            f"{each.delay_margin:.2f}",
            str(each.sensed_by),
        )
    print_table(console, table)
    console.print(
        "> chosen   * nothing settles sooner with less noise   sensed by: of the robot that most others sense"
    )
    for sentence in _proved(question):
        console.print(sentence)
    if question.experiment is not None and _turns(question.experiment):
        console.print(
            'The scenario has law.first_follower = "spiral": the same end, never straight through the leader.'
        )


def write_scenario(found: Answer, path: Path) -> None:
    """Write the chosen graph as a scenario.

    Raises:
        InputError: the file cannot be written.
    """
    import tomli_w

    write_whole(path, tomli_w.dumps(_content(found)).encode())


def _content(found: Answer) -> dict[str, Any]:
    question, choice = found.question, found.chosen.choice
    numbers, experiment = question.numbers, question.experiment
    leaders = [numbers[row] for row in choice.leaders]
    content: dict[str, Any]
    if experiment is None:
        content = {"title": f"Designed from {Path(question.name).name}", "random_start": {}, "duration_s": 60.0}
        starts: dict[int, dict[str, Any]] = {}
    else:
        content = experiment.scenario.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
        content.pop("random_formation", None)
        content["title"] += ", designed"
        if _turns(experiment):
            content["law"]["first_follower"] = "spiral"
        starts = {agent["id"]: agent for agent in content.get("agents", ())}
        for phase in content.get("phases", ()):
            if "displacement_m" in phase:
                phase["displacement_m"] = _displacement(question, choice, phase["displacement_m"])
    places = question.field.positions
    content["agents"] = [
        starts.get(number, {})
        | {"id": number, "neighbours": _senses(question, choice, row), "target": places[row].tolist()}
        for row, number in sorted(enumerate(numbers), key=lambda each: each[1])
    ]
    content |= {"graph": "subgraph", "leaders": leaders}
    tables = {key: value for key, value in content.items() if isinstance(value, dict) or key in ("phases", "obstacles")}
    return {key: value for key, value in content.items() if key not in tables} | tables


def _turns(experiment: Experiment) -> bool:
    """Whether the written scenario lets its first follower go around the leader instead of through it.

    From about one start in thirty the straight way to a displacement leads through the leader, whoever leads. There
    the formation shrinks to a crowd in which robots that keep apart shut the first follower in for ever.
    """
    return experiment.scenario.law.first_follower == "displacement" and experiment.scenario.reference is None


def _senses(question: Question, choice: Choice, row: int) -> list[int]:
    if row == choice.leaders[0]:
        return []
    if row == choice.leaders[1]:
        return [question.numbers[choice.leaders[0]]] if question.task.steered or choice.leaders == (0, 1) else []
    return [question.numbers[i] for i in choice.pairs[row].tolist()]


def _displacement(question: Question, choice: Choice, given: list[float]) -> list[float]:
    """What a commanded displacement of the given leaders is for the chosen ones: the same end."""
    p = question.field.positions
    first, then = (p[b] - p[a] for a, b in ((0, 1), choice.leaders))
    turned = complex(*given) / complex(*first) * complex(*then)
    return [turned.real, turned.imag]


def _proved(question: Question) -> list[str]:
    field, numbers = question.field, question.numbers
    told = []
    if question.given is not None and question.leaders in (None, (0, 1)):
        rate, own = fastest(field, (0, 1))[0], evaluate("", field, question.task, question.given).rate
        has = "which the given graph has" if own >= rate - TIE else f"the given graph has {own:.4g}"
        told.append(f"No graph with the leaders {numbers[0]} and {numbers[1]} has a rate above {rate:.4g} 1/s; {has}.")
    if question.leaders is None and (best := best_leaders(field, question.task.steered)) is not None:
        rate, choice = best
        a, b = (numbers[row] for row in choice.leaders)
        told.append(
            f"No leaders allow more than {rate:.4g} 1/s; of those that allow it {a} and {b} have the least depth, "
            f"{int(choice.depth.max())}."
        )
    return told


def _task(experiment: Experiment, seed: int) -> Task:
    target, delta = experiment.target, experiment.phases[-1].displacement
    p = target.positions
    factor = 1.0 + 0j if delta is None else delta / complex(*(p[agents.FIRST_FOLLOWER] - p[agents.LEADER]))
    return Task(
        start=experiment.initial_points(seed),
        law=experiment.first_follower if needs_edge(experiment.scenario) else "stationary",
        factor=factor,
        period=experiment.scenario.plant.control_period_s,
    )


def _allowed(source: str, experiment: Experiment | None, numbers: tuple[int, ...], places: Real, edges: str) -> Field:
    if edges == "all":
        return Field.open(places)
    row = {number: place for place, number in enumerate(numbers)}
    if edges == "given":
        if experiment is None or not experiment.scenario.agents:
            raise InputError(f"--edges given: {source} lists no neighbours")
        ordered = in_order(experiment.scenario.agents)
        listed = [(ordered[k].id, ordered[i].id) for k, i in sensed_edges(source, ordered).tolist()]
    else:
        listed = [(int(observer), int(observed)) for observer, observed in _table(edges, 2)]
    for pair in listed:
        for number in pair:
            if number not in row:
                raise InputError(f"--edges {edges}: no agent {number}")
    return Field.of_edges(places, np.array([(row[k], row[i]) for k, i in listed], dtype=np.intp))


def _leaders(leaders: str, numbers: tuple[int, ...]) -> tuple[int, int] | None:
    if leaders == "free":
        return None
    if leaders == "given":
        return 0, 1
    try:
        a, b = (int(part) for part in leaders.split(","))
        rows = numbers.index(a), numbers.index(b)
    except ValueError:
        raise InputError(f"--leaders: expected given, free, or the numbers of two agents, got {leaders!r}") from None
    if a == b:
        raise InputError(f"--leaders: expected two agents, got {a} twice")
    return rows


def _places(source: str) -> tuple[tuple[int, ...], Real]:
    rows = _table(source, 2, 3)
    if len(rows) < 3:
        raise InputError(f"{source}: expected at least 3 places, got {len(rows)}")
    numbers = tuple(int(row[0]) for row in rows) if len(rows[0]) == 3 else tuple(range(1, len(rows) + 1))
    if len(set(numbers)) < len(numbers) or min(numbers) < 1:
        raise InputError(f"{source}: expected a number of its own, from 1 on, for each place")
    return numbers, np.array([row[-2:] for row in rows])


def _table(path: str, *widths: int) -> list[list[float]]:
    """The numbers of a CSV file, with or without a line of names above them.

    Raises:
        InputError: no such file, a cell that is no finite number, or a line of another length.
    """
    try:
        lines = list(csv.reader(io.StringIO(Path(path).read_text(encoding="utf-8-sig"))))
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error
    found: list[list[float]] = []
    for number, line in enumerate(lines, start=1):
        if not any(part.strip() for part in line):
            continue
        try:
            row = [float(part) for part in line]
        except ValueError:
            if number == 1:
                continue
            raise InputError(f"{path}: line {number}: expected numbers, got {','.join(line)[:80]!r}") from None
        if len(row) not in ((len(found[0]),) if found else widths) or not np.isfinite(row).all():
            raise InputError(f"{path}: line {number}: expected {' or '.join(map(str, widths))} finite numbers")
        found.append(row)
    return found
