"""The page on the testbed as it is: an identified robot, what of it is known, and what that does to a formation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

from robots.identification.estimate import Identified
from robots.identification.numbers import NAMES
from robots.measured import MEASURED
from scenarios.documents import markdown_table
from scenarios.studies import identification, ladder
from scenarios.studies.ladder import Ladder

UNKNOWN = (
    ("base length against drift", "0.1043 to 0.1069 m", "spins in both directions, straights there and back"),
    ("spread from robot to robot", "base 1 %, radius 0.5 %, assumed", "the same script on ten robots"),
    ("command delay, motor lag", "0.018 s and 0.05 s, assumed", "steps of v, with times"),
    ("loss of commands", "0.19, as of encoder messages; assumed", "steps of v: how often one comes a turn late"),
    ("camera latency", "0.033 s, assumed; the log has the encoders' lag behind it alone", "steps of v, with times"),
    ("speed at full PWM", "20 rad/s, assumed", "chirps up to the wheels' limit"),
    ("tyre friction, mass", "0.8 and 0.2 kg, assumed", "a spin stopped at once, two robots that push"),
)
"""What no public log tells, what is assumed in its place, and the part of `formation calibrate`'s script that tells."""


def constants() -> list[str]:
    """The constants of the measured robot beyond the log's, with their sources."""
    rows = []
    for entry in fields(MEASURED):
        if entry.metadata:
            value = f"{getattr(MEASURED, entry.name):g} {entry.metadata['unit']}".strip()
            source = entry.metadata["source"]
            span = f" ({entry.metadata['range']})" if entry.metadata["range"] else ""
            rows.append((entry.name, value, source + span, entry.metadata["meaning"]))
    return markdown_table(("constant", "value", "source (range)", "meaning"), rows)


def page(found: Identified, source: str, ladders: Sequence[Ladder], command: str) -> str:
    """The page, as Markdown."""
    climbed = [line for each in ladders for line in (f"### `{each.scenario}`", "", *ladder.markdown(each), "")]
    lines = [
        "# The testbed as it is",
        "",
        "Every simulator of the Robotarium simulates its data sheet. This page is what a log of a real robot and the",
        f"robots' public firmware say instead. Made by `{command}`; the arrays of the log",
        f"({source}) are not part of the project, because their repository states no licence.",
        "",
        "    formation identify LOG                 # a robot's numbers, robot.toml, a figure of what is left over",
        "    formation run shape --set robot.model=measured [--set robot.file=robot.toml]",
        "    formation ladder shape                 # five rungs, from the theory to measured robots",
        "    formation adopt LOG --scenario shape   # a log of all robots as a run folder, and its simulation",
        "    formation calibrate --out script.py    # a script for the testbed that tells what is unknown",
        "",
        "## The robot of the log",
        "",
        *identification.markdown(found),
        "",
        *_READING,
        "",
        "## What the measured robot has",
        "",
        f"The first {len(NAMES)} numbers above, and:",
        "",
        *constants(),
        "",
        *_MODEL,
        "",
        "## What it does to a formation",
        "",
        *climbed,
        *_MARGIN,
        "",
        "## What is unknown",
        "",
        *markdown_table(("unknown", "in its place", "what would tell"), UNKNOWN),
        "",
    ]
    return "\n".join(lines)


_READING = """\
*Base length.* Two numbers stand in the table. Over the whole log the encoders' difference gives the heading as a base
of `base_length` would; its interval trusts no short window and is wide. Within a few turns, and with a drift of the
heading per metre taken out, it is `base_length_short`. Both intervals meet; the drift, as of wheels that differ by
0.2 %, is what sets them apart. By either, a robot that converts with 0.11 m turns 4 to 5 % faster than commanded.

*Method.* Poses are linear in radius, base, offset, lag and drift once the lag is guessed; slip is a random walk, the
timing between cameras and encoders an autoregressive jitter, the cameras' noise white. A Kalman filter whitens the
poses, generalised least squares gives the numbers, restricted maximum likelihood the noises (scipy's trust region);
`robots/identification` has the equations. Over 1000 synthetic logs of 500 to 5000 turns with all noises on,
`EVIDENCE_LOGS=1000 pytest tests/evidence/test_identification.py -rP` counts how often the intervals hold the truth.

*Bad logs.* Headings in degrees, 16-bit counters that wrap, missing values, left and right exchanged and both signs
turned round are repaired and said. Two robots mixed, columns in another order, one counter that runs backwards,
positions in other units, a robot at rest, and logs below 200 turns are refused in one line.""".splitlines()

_MODEL = """\
Commands become wheel speeds by the data sheet (that is what firmware and testbed do), wheels become motion by each
robot's own base and radius, drawn from the run's seed in a stream of its own: nominal runs are bit-identical to what
they were. `robot.base_spread` and `robot.radius_spread` set the spread. The wheel loop counts whole encoder counts,
0.224 rad/s each, and moves PWM in whole steps, so slow wheels turn in steps of 0.08 rad/s. What the law is given is
what the cameras say. A measured run never comes to rest; it is judged by the mean of each angle error over 10 s, as
runs with noisy sensors are.""".splitlines()

_MARGIN = """\
Over 500 seeds, and with the margin that the safety filter needs for such robots: [safety.md](safety.md), "Measured
robots".""".splitlines()
