"""What a script's run prints: how it ended, where the robots went, and what the testbed says."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray
from rich.console import Console
from rich.markup import escape

from robots.rps.simulation import Record
from scenarios.measures.script_result import OUTCOMES, describe
from scenarios.simulation.script.script_file import ScriptFile
from scenarios.terminal import new_table, print_table

MOST_ROWS = 12
"""Robots that get a row each."""


def print_script(console: Console, file: ScriptFile) -> None:
    """What is run, before it runs."""
    by = f", by {', '.join(file.marks[:3])}{', ...' if len(file.marks) > 3 else ''}" if file.marks else ""
    console.print(escape(f"{file.path.name}: speaks rps {file.version}{by}"))


def print_script_result(console: Console, record: Record, result: dict[str, Any]) -> None:
    """The result of a script's run."""
    table = new_table("robot", "start (m, deg)", "end (m, deg)", "way (m)")
    rows = range(min(result["robots"], MOST_ROWS))
    for robot in rows:
        table.add_row(
            str(robot), _pose(record.poses[0, robot]), _pose(record.poses[-1, robot]), f"{result['way_m'][robot]:.2f}"
        )
    console.print()
    print_table(console, table)
    if result["robots"] > MOST_ROWS:
        console.print(f"and {result['robots'] - MOST_ROWS} robots more")
    console.print()
    if result["sets_of_robots"] > 1:
        console.print(f"the script made {result['sets_of_robots']} sets of robots; this is the one that drove longest")
    near = result["min_separation"]
    if near["distance_m"] is not None:
        console.print(
            f"smallest separation: {near['distance_m']:.3f} m at {near['time_s']:.1f} s, "
            f"robots {near['robots'][0]} and {near['robots'][1]}"
        )
    if result["plant"] == "pymunk":
        console.print(f"contacts: {_contacts(result['contacts'])}")
    testbed = result["testbed"]
    console.print(f"testbed: {'[green]accepted' if testbed['accepted'] else '[red]rejected'}")
    for violation in testbed["violations"]:
        console.print(escape(f"  {describe(violation)}"))
    code = f" with code {result['exit_code']}" if result["exit_code"] and result["outcome"] == "exited" else ""
    how = f"[bold]{OUTCOMES[result['outcome']]}[/bold]{code}"
    console.print(f"outcome: the script {how} at {result['duration_s']:.2f} s")
    if result["advice"] is not None:
        console.print(escape(f"hint: {result['advice']}"))


def _pose(pose: NDArray[Any]) -> str:
    x, y, theta = (float(value) for value in pose)
    turn = (theta * 57.29577951308232 + 180.0) % 360.0 - 180.0
    return f"({x:.3f}, {y:.3f}), {turn:.0f}"


def _contacts(contacts: dict[str, Any]) -> str:
    if contacts["first"] is None:
        return "none"
    robots = contacts["first"]["robots"]
    who = f"{'robot' if len(robots) == 1 else 'robots'} {' and '.join(map(str, robots))}"
    return f"in {contacts['periods']} control periods, first of {who} at {contacts['first']['time_s']:.2f} s"
