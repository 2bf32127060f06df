"""What is known of an experiment before it runs: graph, assumptions, predicted rates and ends."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import islice
from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape

from formation import agents, collision_margins, decay_rates, end_similarity, needs
from scenarios.definition.experiment import Experiment
from scenarios.documents import cell
from scenarios.measures.late_rates import expected_late_rates
from scenarios.measures.predictions.forecast import NEAR, PhaseForecast, forecast
from scenarios.measures.predictions.remarks import remarks
from scenarios.report.cells import CHANGING, NO_PREDICTION, chosen, digits, place
from scenarios.report.closed_forms import MOST_LISTED, print_closed_forms
from scenarios.report.course import print_course
from scenarios.report.happenings import print_plan
from scenarios.simulation.compiled.ability import unable
from scenarios.terminal import new_table, print_table


def print_experiment(console: Console, experiment: Experiment, seed: int) -> None:
    """Graph, angles, assumptions, predicted rates and end configurations."""
    console.print(f"[bold]{escape(experiment.file.name)}[/bold]: {escape(experiment.scenario.title)}")
    if experiment.file.description:
        console.print(escape(experiment.file.description), style="dim")
    start = experiment.initial_points(seed)
    shown = chosen(len(experiment.phases))
    predicted = forecast(experiment, start, shown)
    _print_assumptions(console, experiment, start)
    if experiment.formation is experiment.aim.target:
        _print_agents(console, experiment, start, predicted[-1].end)
    if experiment.predicted:
        _print_forecast(console, experiment, predicted, shown)
    else:
        console.print(f"\n{NO_PREDICTION}")
    print_course(console, experiment, start)
    print_plan(console, experiment, start)
    print_closed_forms(console, experiment, start)
    for remark in remarks(experiment, seed):
        console.print(escape(remark), style="bold")
    reason = unable(experiment)
    how = "compiled as a whole" if reason is None else f"stepped by Python, {reason}"
    console.print(escape(f"\ncontrol period: {how}"))
    table = new_table("angle", "target (deg)")
    angles = zip(experiment.angle_names, np.degrees(experiment.target_angles), strict=True)
    for name, value in islice(angles, MOST_LISTED):
        table.add_row(name, f"{value:.4f}")
    console.print("\n[bold]Angles, counter-clockwise, alpha(vertex;from,to)[/bold]")
    print_table(console, table)
    _print_rest(console, len(experiment.target_angles), "angles")


def _print_rest(console: Console, count: int, what: str) -> None:
    """How many more there are than have lines of their own."""
    if count > MOST_LISTED:
        console.print(f"and {count - MOST_LISTED} {what} more")


def _print_assumptions(console: Console, experiment: Experiment, start: Any) -> None:
    distance = float(np.linalg.norm(start[agents.FIRST_FOLLOWER] - start[agents.LEADER]))
    console.print("\n[bold]Assumptions[/bold]")
    if experiment.formation is not experiment.aim.target:
        _print_graph(console, experiment, start)
        return
    target = experiment.target
    graph = target.graph
    sine = np.abs(np.sin(target.follower_angles))
    worst = int(sine.argmin())
    flattest = tuple(experiment.numbered(graph.triangles[worst]).tolist())
    console.print(
        f"  1  leader-first-follower sensing graph: holds, {graph.n} agents, {len(graph.edges)} edges, "
        f"depth {graph.depth.max()}"
    )
    console.print(
        f"  2  strongly nondegenerate target: holds, flattest triangle {flattest}, "
        f"|sin| = {digits(sine[worst], 3)} at {experiment.name(graph.followers[worst])}"
    )
    console.print(f"  p_1(0) != p_2(0): holds, {distance:.3f} m apart\n")


def _print_graph(console: Console, experiment: Experiment, start: Any) -> None:
    """The sensing graph of a law that needs another kind than the paper's."""
    graph, condition = experiment.graph, needs(experiment.law).graph
    origin = "as given" if experiment.scenario.graph == "given" else "designed from the target"
    console.print(f"  {condition} sensing graph: holds, {graph.n} agents, {len(graph.edges)} edges, {origin}\n")
    table = new_table("agent", "senses", "start (m)")
    sensed = _sensed(graph.n, graph.edges)
    for row in range(min(graph.n, MOST_LISTED)):
        senses = [str(experiment.number(i)) for i in sensed[row]]
        table.add_row(str(experiment.number(row)), ", ".join(senses) or "-", place(start[row]))
    print_table(console, table)
    _print_rest(console, graph.n, "agents")


def _sensed(n: int, edges: Iterable[tuple[int, int]]) -> list[list[int]]:
    """The rows that each of n agents senses, of edges (k, i): k senses i."""
    found: list[list[int]] = [[] for _ in range(n)]
    for k, i in edges:
        found[k].append(i)
    return found


def _print_agents(console: Console, experiment: Experiment, start: Any, end: Any) -> None:
    target = experiment.target
    graph = target.graph
    few = graph.n <= MOST_LISTED  # late rates are measured of the exact motion of all
    rates, late = decay_rates(target), expected_late_rates(experiment, start) if few else None
    sensed = _sensed(graph.n, graph.edges)
    margins = collision_margins(target, start, end)
    at_rest = len(experiment.phases) == 1 and not experiment.phases[0].moving
    still = at_rest and experiment.predicted  # the premise of Lemma 3
    table = new_table(
        "agent",
        "senses",
        "depth",
        "follower angle (deg)",
        "sin^2 (1/s)",
        "late rate (1/s)",
        "start (m)",
        "end (m)",
        "margin of (c3) (m)",
    )
    for row in range(min(graph.n, MOST_LISTED)):
        follower = row - agents.FIRST_ORDINARY
        senses = [str(experiment.number(i)) for i in sensed[row]]
        cells = ["-"] * 4
        if follower >= 0:
            cells = [
                f"{np.degrees(target.follower_angles[follower]):.2f}",
                digits(rates[follower], 4),
                "-" if late is None or (rate := late[follower]) is None else digits(rate, 4),
                f"{margins[follower]:+.3f}" if still else "-",
            ]
        table.add_row(
            str(experiment.number(row)),
            ", ".join(senses) or "-",
            str(graph.depth[row]),
            *cells[:3],
            place(start[row]),
            place(end[row]) if experiment.predicted else "-",
            cells[3],
        )
    print_table(console, table)
    _print_rest(console, graph.n, "agents")
    if late is not None and experiment.safety != "none":
        console.print("late rate: of the law alone; a filter that still acts near the end moves it (docs/theory.md)")
    if still:
        console.print("(c3): a follower with a positive margin that starts after its neighbours settled avoids both")


def _print_forecast(
    console: Console, experiment: Experiment, predicted: list[PhaseForecast], shown: Sequence[int]
) -> None:
    table = new_table(
        "phase",
        "until (s)",
        "v_r (m/s)",
        "delta (m)",
        "scale c",
        "theta (deg)",
        "xi (m)",
        "angle error sum (rad)",
        f"within {NEAR:g} m after (s)",
    )
    ends = np.cumsum([phase.duration for phase in experiment.phases])
    for index in shown:
        phase, ahead = experiment.phases[index], predicted[index]
        similarity = end_similarity(experiment.of_phase(index).formation, *ahead.end[: agents.FIRST_ORDINARY])
        table.add_row(
            escape(phase.name),
            f"{ends[index]:g}",
            place(phase.velocity) if phase.reference is None else CHANGING,
            "-" if phase.delta is None else place(phase.delta) if phase.reference is None else CHANGING,
            f"{similarity.scale:.4f}",
            f"{np.degrees(similarity.angle):.2f}",
            place(similarity.translation),
            cell(ahead.error_sum, ".2e"),
            cell(ahead.arrival, ".1f"),
        )
    console.print("\n[bold]Predicted end of each phase, c R(theta) p* + xi, for ideal single integrators[/bold]")
    print_table(console, table)
    if len(shown) < len(predicted):
        console.print(f"{len(shown)} of {len(predicted)} phases, equally far apart")
