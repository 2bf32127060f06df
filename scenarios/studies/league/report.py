"""The league's tables, for a terminal of eighty columns and for its page."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Console

from formation import needs
from formation.graph.designs import DESIGNS
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.documents import markdown_table
from scenarios.studies.league import noise
from scenarios.studies.league.beside import beside, interval
from scenarios.studies.league.citations import CITATIONS, Citation
from scenarios.studies.league.ends import ENDS, RIGHT, STILL, TOLERANCE
from scenarios.studies.league.ideal import BOX, NEAR
from scenarios.studies.league.measure import AS_GIVEN, COMPASS_DEG, PLANTS, Row
from scenarios.terminal import new_table, print_table

PAPERS = "shape"
"""The scenario whose target the first computation used."""


@dataclass(frozen=True)
class Sheet:
    """A table: its title, its columns, how many of the last ones are numbers, its rows."""

    title: str
    columns: tuple[str, ...]
    numbers: int
    rows: Sequence[tuple[str, ...]]


def sheets(rows: Sequence[Row]) -> list[Sheet]:
    """All tables of the league."""
    return [_needs(rows), _ends(rows), _errors(rows)]


def _needs(rows: Sequence[Row]) -> Sheet:
    cells = []
    for row in rows:
        one = row.player
        if one is None:
            cells.append((row.entry.name, "-", row.refused, "", ""))
            continue
        declared = needs(one.law)
        frame = "compass" if declared.compass else "own, one handedness" if declared.handedness else "own"
        measures = ", ".join(declared.measures)
        graph = f"{declared.graph}, {len(one.formation.graph.edges)} edges"
        cells.append((row.entry.name, graph, measures, frame, ", ".join(one.law.fixes)))
    return Sheet("What each needs", ("law", "graph", "measures", "frame", "fixes"), 0, cells)


def _ends(rows: Sequence[Row]) -> Sheet:
    cells = []
    for row in rows:
        if row.player is None:
            continue
        low, high = interval(row.counts[ENDS.index(RIGHT)], row.runs)
        others = [f"{count / row.runs:.1%}" if count else "-" for count in row.counts[1:]]
        settling = "-" if row.settling is None else f"{row.settling:.1f}"
        cells.append((row.entry.name, f"{row.share:.1%}", f"{low:.1%} to {high:.1%}", *others, settling))
    return Sheet("Where random starts end", ("law", RIGHT, "95 %", *ENDS[1:], "settles (s)"), len(ENDS) + 2, cells)


def _errors(rows: Sequence[Row]) -> Sheet:
    cells = []
    for row in rows:
        if row.player is None:
            continue
        compass = ("-", "-", "-")
        if row.compass is not None:
            moves = " ".join(f"{speed:.2f}" for speed in row.compass.drift)
            stands = row.compass.drift[-1] < STILL
            compass = (f"{row.compass.right:.0%}", f"{row.compass.residual:.1%}", "stands" if stands else moves)
        noise = "-" if row.noise is None else f"{row.noise:.2%}"
        plants = " ".join(str(reached) for reached in row.plants) or "-"
        near = " ".join(f"{share:.0%}" for share in row.near)
        cells.append((row.entry.name, near, *compass, noise, plants))
    columns = ("law", "near", "compass", "residual", "drift (m/s)", "noise", "robots")
    return Sheet("Near the target, with errors, on robots", columns, len(columns) - 1, cells)


def remarks(rows: Sequence[Row], robots: int) -> list[str]:
    """What the tables' words mean, in sentences."""
    runs = max((row.runs for row in rows), default=0)
    sides = f"{2.0 * BOX:g} times the target's root mean square radius"
    return [
        f"{runs} random starts each, the same for all, in a square of {sides}; ideal integrators with adaptive steps. "
        f"Right: the residual, the distance from the nearest similar copy of the target over the formation's size, is "
        f"below {TOLERANCE:.0%} at the horizon. Horizons (s): {_horizons(rows)}. Settles: median time to that.",
        "Mirrored: a copy of the mirror image. Flipped: all sensed distances right, up to one factor, another shape. "
        f"Moving: an agent faster than {STILL * 1e3:g} mm/s at the horizon.",
        "Near: share right from starts about the target, each coordinate disturbed with a standard deviation of "
        f"{', '.join(f'{sigma:g}' for sigma in NEAR)} of its radius. Compass, residual, drift: with constant compass "
        f"errors of {COMPASS_DEG:g} degrees, the share that is right, the median residual, and the speed in the end, "
        "its quantiles at 5, 50 and 95 %.",
        _on_robots(robots),
    ]


def _on_robots(robots: int) -> str:
    if not robots:
        return "Noise, robots: not run; `--robots N` runs N seeds on each plant with wheels."
    return (
        "Noise: median residual over the last ten seconds on `saturated` with 1 cm, 1 degree and 5 % of noise. "
        f"Robots: how many of {robots} seeds are right on {', '.join(PLANTS)}, from the scenario's starts, with its "
        "filter."
    )


def _horizons(rows: Sequence[Row]) -> str:
    by_horizon: dict[float, list[str]] = {}
    for row in rows:
        by_horizon.setdefault(row.entry.horizon, []).append(row.entry.name)
    common = max(by_horizon, key=lambda horizon: len(by_horizon[horizon]))
    others = [f"{', '.join(names)} {horizon:g}" for horizon, names in by_horizon.items() if horizon != common]
    return "; ".join([*others, f"all others {common:g}"])


def print_league(console: Console, rows: Sequence[Row], robots: int) -> None:
    """The tables, in a terminal."""
    for sheet in sheets(rows):
        table = new_table(*sheet.columns, title=sheet.title)
        for cells in sheet.rows:
            table.add_row(*cells)
        print_table(console, table)
    for remark in remarks(rows, robots):
        console.print(remark)


def markdown(scenario: str, changes: tuple[str, ...], rows: Sequence[Row], starts: int, robots: int) -> str:
    """The page."""
    settings = [text for change in changes for text in ("--set", change)]
    command = shlex.join(["formation", "laws", scenario, *settings, "--starts", str(starts), "--robots", str(robots)])
    command += " --markdown docs/laws.md --figure docs/images/laws.png"
    lines = ["# The laws side by side", "", f"Written by `{command}`."]
    lines += ["", "One file a law in `formation/laws/`: source, equation, what is proved, what fails."]
    lines += ["", "![From random starts to where each law ends](images/laws.png)"]
    for sheet in sheets(rows):
        lines += ["", f"## {sheet.title}", "", *markdown_table(sheet.columns, sheet.rows, numbers=sheet.numbers)]
    lines += ["", *[line for remark in remarks(rows, robots) for line in (remark, "")]]
    papers = scenario == PAPERS and not changes
    lines += _first(rows) if papers else []
    lines += _noise(open_experiment(scenario, (*changes, *AS_GIVEN)), papers)
    lines += ["## The paper's references", "", *_citations(CITATIONS)]
    lines += [
        "",
        "## Graphs that are built",
        "",
        '`graph = "design"` builds, from the target, what a law needs: ' + ", ".join(sorted(DESIGNS)) + ".",
    ]
    return "\n".join(lines) + "\n"


def _first(rows: Sequence[Row]) -> list[str]:
    counts = {row.entry.name: (row.counts[ENDS.index(RIGHT)], row.runs) for row in rows if row.player is not None}
    cells = [
        (
            each.name,
            f"{each.first:.1%}",
            f"{each.here:.1%}",
            f"{each.low:+.1%} to {each.high:+.1%}",
            "as before" if each.agree else f"differs: {each.why or 'not explained'}",
        )
        for each in beside(counts)
    ]
    columns = ("law", "first", "here", "difference, 99.9 %", "")
    text = "Other code, with other starts (300; the triangle's 1000) in the same square, once gave the shares `first`."
    return ["## Beside a first computation", "", text, "", *markdown_table(columns, cells), ""]


def _noise(experiment: Experiment, papers: bool) -> list[str]:
    text = (
        "Root mean square distance of the followers from their mean places with 1 degree of noise on every bearing and "
        f"5 % on the ratio of a follower's two distances, or on each of them, new every {noise.PERIOD * 1e3:g} ms: the "
        "covariance of the linearised loop with held commands. Eq. (u) with the same sensors has its first distance as "
        "it is, and its second as the ratio gives it. Size: the distance of agents 1 and 2. The mean moves as well, in "
        "second order: a ratio with a symmetric error r (1 + e) is not symmetric in 1 / r."
    )
    table = markdown_table(noise.COLUMNS, noise.table(experiment, papers))
    lines = ["## Without distances, with noise", "", text, "", *table, ""]
    if papers:
        both = " and ".join(f"{' '.join(f'{mm:.1f}' for mm in noise.FIRST[law])} ({law})" for law in noise.FIRST)
        lines += [
            f"The first computation gave {both}; its note says 0.5 m/s and no size. One row of each law is within "
            f"{noise.WITHIN:.0%} of it, `as first`: 5 % of the ratio, 1 m, and 1 m/s for the ratio law. With 5 % of "
            "each distance and 0.5 m/s the ratio law's are 7 % off, and eq. (u)'s a third: that it cannot have been.",
            "",
        ]
    return lines


def _citations(citations: Sequence[Citation]) -> list[str]:
    cells = [(cite.key, cite.law or "-", cite.remark) for cite in citations]
    return markdown_table(("key", "law", "remark"), cells)
