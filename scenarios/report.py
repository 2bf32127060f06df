"""What the command line prints: tables of scenarios, predictions and results."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from formation import agents, decay_rates, end_similarity
from scenarios.experiment import Experiment
from scenarios.load import library, load
from scenarios.metrics import predicted_ends


def _table(*columns: str, title: str | None = None) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for column in columns:
        left = column in ("scenario", "title", "angle", "agent", "senses", "phase", "plant")
        table.add_column(column, justify="left" if left else "right", no_wrap=column != "title")
    return table


def print_library(console: Console) -> None:
    """The scenarios that come with the project."""
    table = _table("scenario", "agents", "time (s)", "plant", "title")
    for name in library():
        s = load(name).scenario
        seconds = s.duration_s or sum(phase.duration_s for phase in s.phases)
        table.add_row(name, str(len(s.agents)), f"{seconds:g}", s.plant.name, s.title)
    console.print(table)


def print_experiment(console: Console, experiment: Experiment, seed: int) -> None:
    """Graph, angles, assumptions, predicted rates and end configurations."""
    graph, target = experiment.graph, experiment.target
    console.print(f"[bold]{experiment.file.name}[/bold]: {experiment.scenario.title}")
    if experiment.file.description:
        console.print(experiment.file.description, style="dim", highlight=False)
    sine = np.abs(np.sin(target.follower_angles))
    worst = int(sine.argmin())
    flattest = tuple(agents.numbers(graph.triangles[worst]).tolist())
    console.print("\n[bold]Assumptions[/bold]")
    console.print(f"  1  leader-first-follower sensing graph: {graph.n} agents, {len(graph.edges)} edges, holds")
    console.print(
        f"  2  strongly nondegenerate target: holds, flattest triangle {flattest}, "
        f"|sin| = {sine[worst]:.3f} at {agents.name(graph.followers[worst])}"
    )
    start = experiment.initial_points(seed)
    distance = float(np.linalg.norm(start[agents.FIRST_FOLLOWER] - start[agents.LEADER]))
    console.print(f"  p_1(0) != p_2(0): holds, {distance:.3f} m apart\n")
    rates = decay_rates(target)
    ends = predicted_ends(experiment, start)
    table = _table("agent", "senses", "depth", "follower angle (deg)", "rate (1/s)", "start (m)", "end (m)")
    for row in range(graph.n):
        follower = row - agents.FIRST_ORDINARY
        senses = [str(agents.number(i)) for k, i in graph.edges if k == row]
        table.add_row(
            str(agents.number(row)),
            ", ".join(senses) or "-",
            str(graph.depth[row]),
            f"{np.degrees(target.follower_angles[follower]):.2f}" if follower >= 0 else "-",
            f"{rates[follower]:.4f}" if follower >= 0 else "-",
            _point(start[row]),
            _point(ends[-1, row]),
        )
    console.print(table)
    table = _table("phase", "until (s)", "v_r (m/s)", "delta (m)", "scale c", "angle (deg)", "translation (m)")
    until = 0.0
    for phase, end in zip(experiment.phases, ends, strict=True):
        until += phase.duration
        similarity = end_similarity(target, end[agents.LEADER], end[agents.FIRST_FOLLOWER])
        table.add_row(
            phase.name,
            f"{until:g}",
            _point(phase.velocity),
            "-" if phase.delta is None else _point(phase.delta),
            f"{similarity.scale:.4f}",
            f"{np.degrees(similarity.angle):.2f}",
            _point(similarity.translation),
        )
    console.print("\n[bold]Predicted end p = c R(angle) p* + translation[/bold]")
    console.print(table)
    table = _table("angle", "target (deg)")
    for name, value in zip(experiment.angles.names, np.degrees(experiment.target_angles), strict=True):
        table.add_row(name, f"{value:.4f}")
    console.print("\n[bold]Angles, counter-clockwise, alpha(vertex;from,to)[/bold]")
    console.print(table)


def print_result(console: Console, result: dict[str, Any]) -> None:
    """Final angle errors, predicted beside measured ends, and the testbed's verdict."""
    table = _table("angle", "target (deg)", "final (deg)", "error (rad)", "axle error (rad)")
    for angle in result["angles"]:
        table.add_row(
            angle["name"],
            f"{angle['target_deg']:.4f}",
            _value(angle["final_deg"], ".4f"),
            _value(angle["error_rad"], "+.2e"),
            _value(angle["axle_error_rad"], "+.2e"),
        )
    table.add_section()
    total, axle = result["angle_error_sum_rad"], result["axle_angle_error_sum_rad"]
    table.add_row("sum of |error|", "", "", _value(total, ".2e"), _value(axle, ".2e"), style="bold")
    console.print(table)
    console.print()
    table = _table("phase", "until (s)", "angle error sum (rad)", "axle sum (rad)", "farthest from prediction (m)")
    for phase in result["phases"]:
        farthest = max(phase["distance_m"], default=None, key=lambda d: d if d is not None else np.inf)
        table.add_row(
            phase["name"],
            f"{phase['end_s']:.1f}",
            _value(phase["angle_error_sum_rad"], ".2e"),
            _value(phase["axle_angle_error_sum_rad"], ".2e"),
            _value(farthest, ".2e"),
        )
    console.print(table)
    console.print()
    settled = result["settling_time_s"]
    settling = "never" if settled is None else f"after {settled:.1f} s"
    console.print(f"settled below {result['goal_rad']:g} rad: {settling}")
    near = result["min_separation"]
    if near["distance_m"] is not None:
        console.print(
            f"smallest separation: {near['distance_m']:.3f} m at {near['time_s']:.1f} s, "
            f"agents {near['agents'][0]} and {near['agents'][1]}"
        )
    testbed = result["testbed"]
    console.print(f"testbed: {'[green]accepted' if testbed['accepted'] else '[red]rejected'}")
    for violation in testbed["violations"]:
        console.print(f"  {_describe(violation)}")
    console.print(f"outcome: [bold]{result['outcome'].replace('_', ' ')}[/bold]")


def _describe(violation: dict[str, Any]) -> str:
    first = violation["first"]
    who = " and ".join(str(agent) for agent in first["agents"])
    where = f"first at {first['time_s']:.2f} s, {_point(first['place_m'])} m, {violation['steps']} steps"
    match violation["kind"]:
        case "floor":
            return f"agent {who} leaves the floor by {first['value']:.3f} m; {where}"
        case "collision":
            return f"agents {who} come within {first['value']:.3f} m; {where}"
        case _:
            return f"agent {who} commands a wheel to {first['value']:.1f} rad/s (warning); {where}"


def _point(point: Any) -> str:
    x, y = (float(c) + 0.0 if abs(c) > 5e-5 else 0.0 for c in point)
    return f"({x:.4g}, {y:.4g})"


def _value(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
