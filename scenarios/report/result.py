"""What a run gave, from the content of its ``result.json`` and nothing else."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.markup import escape

from formation import agents
from scenarios.documents import cell
from scenarios.report.cells import NO_PREDICTION, chosen, place
from scenarios.report.happenings import print_happenings
from scenarios.terminal import new_table, print_table


def print_result(console: Console, result: dict[str, Any]) -> None:
    """Final angle errors, predicted beside measured ends, and the testbed's verdict."""
    table = new_table("angle", "target (deg)", "final (deg)", "error (rad)", "axle error (rad)")
    for angle in result["angles"]:
        table.add_row(
            angle["name"],
            f"{angle['target_deg']:.4f}",
            cell(angle["final_deg"], ".4f"),
            cell(angle["error_rad"], "+.2e"),
            cell(angle["axle_error_rad"], "+.2e"),
        )
    table.add_section()
    total, axle = result["angle_error_sum_rad"], result["axle_angle_error_sum_rad"]
    table.add_row("sum of |error|", "", "", cell(total, ".2e"), cell(axle, ".2e"), style="bold")
    print_table(console, table)
    console.print()
    _print_phases(console, result)
    if result["phases"]:
        _print_ends(console, result)
    print_happenings(console, result)
    settled = result["settling_time_s"]
    settling = "never" if settled is None else f"after {settled:.1f} s"
    console.print(f"settled below {result['goal_rad']:g} rad: {settling}")
    if "error_window_s" in result:
        _print_window(console, result)
    near = result["min_separation"]
    if near["distance_m"] is not None:
        console.print(
            f"smallest separation: {near['distance_m']:.3f} m at {near['time_s']:.1f} s, "
            f"agents {near['agents'][0]} and {near['agents'][1]}"
        )
    _print_clearance(console, result["clearance"])
    _print_safety(console, result)
    if result["plant"] == "pymunk":
        console.print(f"contacts: {_contacts(result['contacts'])}")
    testbed = result["testbed"]
    console.print(f"testbed: {'[green]accepted' if testbed['accepted'] else '[red]rejected'}")
    for violation in testbed["violations"]:
        console.print(f"  {_describe(violation)}")
    console.print(f"outcome: [bold]{result['outcome'].replace('_', ' ')}[/bold]")


def _print_clearance(console: Console, clearance: dict[str, Any] | None) -> None:
    """How near anyone came to a wall or an obstacle; nothing on a floor with neither."""
    for what, near in (clearance or {}).items():
        if near is not None and near["distance_m"] is not None:
            console.print(
                f"smallest clearance of a {what}: {near['distance_m']:.3f} m at {near['time_s']:.1f} s, "
                f"agent {near['agent']} from {'the ' if 'wall' in near['thing'] else ''}{near['thing']}"
            )


def _print_window(console: Console, result: dict[str, Any]) -> None:
    """What a run with noisy sensors is judged by."""
    length = result["error_window_s"]
    console.print(f"sensors are noisy: judged by the mean of each signed error over the last {length:g} s")
    table = new_table("angle", "mean error (rad)", "rms (rad)")
    for angle in result["angles"]:
        table.add_row(angle["name"], cell(angle["mean_error_rad"], "+.2e"), cell(angle["rms_error_rad"], ".2e"))
    table.add_section()
    mean, rms = result["mean_angle_error_sum_rad"], result["rms_angle_error_sum_rad"]
    table.add_row("sum of |mean|, of rms", cell(mean, ".2e"), cell(rms, ".2e"), style="bold")
    print_table(console, table)
    console.print()


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
    shown = chosen(len(result["phases"]))
    for phase in (result["phases"][index] for index in shown):
        table.add_row(
            escape(phase["name"]),
            f"{phase['end_s']:.1f}",
            cell(phase["angle_error_sum_rad"], ".2e"),
            cell(phase["axle_angle_error_sum_rad"], ".2e"),
            cell(phase["scale_error"], "+.1e"),
            cell(phase["orientation_error_rad"], "+.1e"),
            cell(phase["translation_error_m"], ".1e"),
        )
    print_table(console, table)
    if len(shown) < len(result["phases"]):
        console.print(f"{len(shown)} of {len(result['phases'])} phases, equally far apart; result.json has all")
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
            str(result["agents"][row]),
            "-" if predicted is None else place(predicted),
            place(measured),
            cell(distance, ".1e"),
            *(cell(rate, ".3f") for rate in late),
        )
    print_table(console, table)
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
    who = ", ".join(f"{one} with {other}" for one, other in contacts["first"]["touching"])
    return f"in {contacts['periods']} control periods, first {who} at {contacts['first']['time_s']:.2f} s"


def _describe(violation: dict[str, Any]) -> str:
    first, worst = violation["first"], violation["worst"]
    who = " and ".join(str(agent) for agent in worst["agents"])
    begins = "" if first["agents"] == worst["agents"] else f" by {' and '.join(map(str, first['agents']))}"
    where = (
        f"; worst at {worst['time_s']:.2f} s, {place(worst['place_m'])} m, first at {first['time_s']:.2f} s{begins}, "
        f"{violation['steps']} steps"
    )
    match violation["kind"]:
        case "floor":
            return f"agent {who} leaves the floor by {cell(worst['value'], '.3f')} m{where}"
        case "obstacle":
            return f"agent {who} comes within {cell(worst['value'], '.3f')} m of an obstacle{where}"
        case "collision":
            return f"agents {who} come within {cell(worst['value'], '.3f')} m{where}"
        case _:
            return f"agent {who} commands a wheel to {cell(worst['value'], '.6g')} rad/s (warning){where}"
