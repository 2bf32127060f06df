"""What the command line prints of experiments: predictions, results, and laws side by side."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape

from formation import agents, collision_margins, decay_rates, end_similarity
from scenarios.definition.experiment import Experiment
from scenarios.measures.forecast import NEAR, PhaseForecast, forecast
from scenarios.measures.misfits import misfits
from scenarios.measures.tracking import predicted_late_rates
from scenarios.studies.laws import COMPASS_BIAS_DEG, Share
from scenarios.terminal import new_table

NO_PREDICTION = "no closed-form prediction for an own law: `formation audit` measures what it does"
"""What stands where the theory speaks of the other laws."""


def print_experiment(console: Console, experiment: Experiment, seed: int) -> None:
    """Graph, angles, assumptions, predicted rates and end configurations."""
    console.print(f"[bold]{escape(experiment.file.name)}[/bold]: {escape(experiment.scenario.title)}")
    if experiment.file.description:
        console.print(escape(experiment.file.description), style="dim")
    start = experiment.initial_points(seed)
    predicted = forecast(experiment, start)
    _print_assumptions(console, experiment, start)
    _print_agents(console, experiment, start, predicted[-1].end)
    if experiment.predicted:
        _print_forecast(console, experiment, predicted)
        for misfit in misfits(experiment, start):
            console.print(f"does not fit: {escape(misfit)}", style="bold")
    else:
        console.print(f"\n{NO_PREDICTION}")
    table = new_table("angle", "target (deg)")
    for name, value in zip(experiment.angles.names, np.degrees(experiment.target_angles), strict=True):
        table.add_row(name, f"{value:.4f}")
    console.print("\n[bold]Angles, counter-clockwise, alpha(vertex;from,to)[/bold]")
    console.print(table)


def _print_assumptions(console: Console, experiment: Experiment, start: Any) -> None:
    graph, target = experiment.graph, experiment.target
    sine = np.abs(np.sin(target.follower_angles))
    worst = int(sine.argmin())
    flattest = tuple(agents.numbers(graph.triangles[worst]).tolist())
    distance = float(np.linalg.norm(start[agents.FIRST_FOLLOWER] - start[agents.LEADER]))
    console.print("\n[bold]Assumptions[/bold]")
    console.print(
        f"  1  leader-first-follower sensing graph: holds, {graph.n} agents, {len(graph.edges)} edges, "
        f"depth {graph.depth.max()}"
    )
    console.print(
        f"  2  strongly nondegenerate target: holds, flattest triangle {flattest}, "
        f"|sin| = {sine[worst]:.3f} at {agents.name(graph.followers[worst])}"
    )
    console.print(f"  p_1(0) != p_2(0): holds, {distance:.3f} m apart\n")


def _print_agents(console: Console, experiment: Experiment, start: Any, end: Any) -> None:
    graph, target = experiment.graph, experiment.target
    rates, late = decay_rates(target), predicted_late_rates(experiment)
    margins = collision_margins(target, start, end)
    at_rest = len(experiment.phases) == 1 and not any(experiment.phases[0].velocity)
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
    for row in range(graph.n):
        follower = row - agents.FIRST_ORDINARY
        senses = [str(agents.number(i)) for k, i in graph.edges if k == row]
        cells = ["-"] * 4
        if follower >= 0:
            cells = [
                f"{np.degrees(target.follower_angles[follower]):.2f}",
                f"{rates[follower]:.4f}",
                "-" if late is None else f"{late[follower]:.4f}",
                f"{margins[follower]:+.3f}" if still else "-",
            ]
        table.add_row(
            str(agents.number(row)),
            ", ".join(senses) or "-",
            str(graph.depth[row]),
            *cells[:3],
            _point(start[row]),
            _point(end[row]) if experiment.predicted else "-",
            cells[3],
        )
    console.print(table)
    if still:
        console.print("(c3): a follower with a positive margin that starts after its neighbours settled avoids both")


def _print_forecast(console: Console, experiment: Experiment, predicted: list[PhaseForecast]) -> None:
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
    until = 0.0
    for phase, ahead in zip(experiment.phases, predicted, strict=True):
        until += phase.duration
        similarity = end_similarity(experiment.target, *ahead.end[: agents.FIRST_ORDINARY])
        table.add_row(
            escape(phase.name),
            f"{until:g}",
            _point(phase.velocity),
            "-" if phase.delta is None else _point(phase.delta),
            f"{similarity.scale:.4f}",
            f"{np.degrees(similarity.angle):.2f}",
            _point(similarity.translation),
            _value(ahead.error_sum, ".2e"),
            _value(ahead.arrival, ".1f"),
        )
    console.print("\n[bold]Predicted end of each phase, c R(theta) p* + xi, for ideal single integrators[/bold]")
    console.print(table)


def print_laws(console: Console, shares: list[Share]) -> None:
    """The comparison of laws."""
    biased = f"with {COMPASS_BIAS_DEG:g} deg compass error"
    table = new_table("law", "measures", "frame", "fixes", "right shape", biased)
    for share in shares:
        law = share.law
        table.add_row(law.name, law.measures, law.frame, law.fixes, f"{share.exact:.1%}", f"{share.biased:.1%}")
    console.print(table)


def print_result(console: Console, result: dict[str, Any]) -> None:
    """Final angle errors, predicted beside measured ends, and the testbed's verdict."""
    table = new_table("angle", "target (deg)", "final (deg)", "error (rad)", "axle error (rad)")
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
    _print_phases(console, result)
    if result["phases"]:
        _print_ends(console, result)
    settled = result["settling_time_s"]
    settling = "never" if settled is None else f"after {settled:.1f} s"
    console.print(f"settled below {result['goal_rad']:g} rad: {settling}")
    near = result["min_separation"]
    if near["distance_m"] is not None:
        console.print(
            f"smallest separation: {near['distance_m']:.3f} m at {near['time_s']:.1f} s, "
            f"agents {near['agents'][0]} and {near['agents'][1]}"
        )
    _print_safety(console, result)
    if result["plant"] == "pymunk":
        console.print(f"contacts: {_contacts(result['contacts'])}")
    testbed = result["testbed"]
    console.print(f"testbed: {'[green]accepted' if testbed['accepted'] else '[red]rejected'}")
    for violation in testbed["violations"]:
        console.print(f"  {_describe(violation)}")
    console.print(f"outcome: [bold]{result['outcome'].replace('_', ' ')}[/bold]")


def _print_phases(console: Console, result: dict[str, Any]) -> None:
    table = new_table(
        "phase",
        "until (s)",
        "angle error sum (rad)",
        "axle sum (rad)",
        "scale error",
        "orientation error (rad)",
        "translation error (m)",
    )
    for phase in result["phases"]:
        table.add_row(
            escape(phase["name"]),
            f"{phase['end_s']:.1f}",
            _value(phase["angle_error_sum_rad"], ".2e"),
            _value(phase["axle_angle_error_sum_rad"], ".2e"),
            _value(phase["scale_error"], "+.1e"),
            _value(phase["orientation_error_rad"], "+.1e"),
            _value(phase["translation_error_m"], ".1e"),
        )
    console.print(table)
    console.print()


def _print_ends(console: Console, result: dict[str, Any]) -> None:
    """Predicted beside measured: the end of the last phase and the late decay rates."""
    last, rates = result["phases"][-1], result["late_rates_per_s"]
    nowhere = [None] * len(last["measured_m"])
    table = new_table(
        "agent", "predicted end (m)", "measured (m)", "distance (m)", "predicted late rate (1/s)", "measured (1/s)"
    )
    for row, (predicted, measured, distance) in enumerate(
        zip(last["predicted_m"] or nowhere, last["measured_m"], last["distance_m"] or nowhere, strict=True)
    ):
        follower = row - agents.FIRST_ORDINARY
        late = [rates[kind][follower] if follower >= 0 and rates[kind] else None for kind in ("predicted", "measured")]
        table.add_row(
            str(agents.number(row)),
            "-" if predicted is None else _point(predicted),
            _point(measured),
            _value(distance, ".1e"),
            *(_value(rate, ".3f") for rate in late),
        )
    console.print(table)
    if last["predicted_m"] is None:
        console.print(NO_PREDICTION)
    console.print()


def _print_safety(console: Console, result: dict[str, Any]) -> None:
    """What the filter did, if there was one."""
    if result["safety"] == "none":
        console.print("safety filter: none")
        return
    share, relaxed = result["interventions"]["share"], result["relaxed"]
    console.print(f"safety filter: {result['safety']}, changed {100 * share:.1f} % of the commands")
    if relaxed["count"]:
        console.print(
            f"  {relaxed['count']} of {relaxed['of']} problems infeasible, relaxed by at most "
            f"{relaxed['largest_m_s']:.1e} m/s"
        )
        for entry in relaxed["agents"]:
            first = entry["first"]
            console.print(
                f"  agent {entry['agent']}: {entry['count']}, first at {first['time_s']:.2f} s "
                f"by {', '.join(first['rows'])}"
            )
    for deadlock in result["deadlocks"]:
        until = deadlock["until_s"]
        end = "never broken" if until is None else f"broken at {until:.1f} s"
        console.print(f"  deadlock of agent {deadlock['agent']} declared at {deadlock['from_s']:.1f} s, {end}")


def _contacts(contacts: dict[str, Any]) -> str:
    if contacts["first"] is None:
        return "none"
    who = " and ".join(str(agent) for agent in contacts["first"]["agents"])
    return f"in {contacts['periods']} control periods, first agents {who} at {contacts['first']['time_s']:.2f} s"


def _describe(violation: dict[str, Any]) -> str:
    first = violation["first"]
    who = " and ".join(str(agent) for agent in first["agents"])
    where = f"first at {first['time_s']:.2f} s, {_point(first['place_m'])} m, {violation['steps']} steps"
    match violation["kind"]:
        case "floor":
            return f"agent {who} leaves the floor; {where}"
        case "obstacle":
            return f"agent {who} comes within {first['value']:.3f} m of an obstacle; {where}"
        case "collision":
            return f"agents {who} come within {first['value']:.3f} m; {where}"
        case _:
            return f"agent {who} commands a wheel to {_value(first['value'], '.4g')} rad/s (warning); {where}"


def _point(point: Any) -> str:
    if None in point:
        return "nowhere"
    x, y = (float(c) + 0.0 if abs(c) > 5e-5 else 0.0 for c in point)
    return f"({x:.4g}, {y:.4g})"


def _value(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)
