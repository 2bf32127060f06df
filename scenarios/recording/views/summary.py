"""The summary page and the run's parameters."""

from __future__ import annotations

from typing import Any

import rerun as rr

from scenarios.definition.experiment import Experiment
from scenarios.documents import cell, markdown_table
from scenarios.recording.recorder import Recorder

SUMMARY = "summary"


def page(recorder: Recorder, experiment: Experiment, result: dict[str, Any]) -> None:
    """The result as a page to read."""
    recorder.fixed(SUMMARY, rr.TextDocument(markdown(experiment, result), media_type=rr.MediaType.MARKDOWN))


def parameters(recorder: Recorder, experiment: Experiment, result: dict[str, Any]) -> None:
    """Scenario, seed, plant, safety, versions and outcome as properties of the recording."""
    keys = ("scenario", "scenario_sha256", "seed", "plant", "safety", "outcome", "duration_s")
    versions = [f"{name} {version}" for name, version in result["versions"].items()]
    name = f"{recorder.root}_run" if recorder.root else "run"
    recorder.parameters(name, rr.AnyValues(**{key: result[key] for key in keys}, versions=versions))


def markdown(experiment: Experiment, result: dict[str, Any]) -> str:
    """The summary page: verdicts first, then every angle."""
    near, settled = result["min_separation"], result["settling_time_s"]
    accepted = "accepted" if result["testbed"]["accepted"] else "rejected"
    kinds = [violation["kind"] for violation in result["testbed"]["violations"]]
    rows = [
        ("outcome", f"**{result['outcome'].replace('_', ' ')}**"),
        ("sum of angle errors", cell(result["angle_error_sum_rad"], ".2e", " rad")),
        ("settled below the goal", cell(settled, ".1f", " s") if settled is not None else "never"),
        ("closest pair", f"{cell(near['distance_m'], '.3f', ' m')} at {near['time_s']:.1f} s"),
        ("testbed", f"**{accepted}**" + (f" ({', '.join(kinds)})" if kinds else "")),
        ("plant, safety, seed", f"{result['plant']}, {result['safety']}, {result['seed']}"),
    ]
    angles = [
        (a["name"], cell(a["target_deg"], ".2f"), cell(a["final_deg"], ".2f"), cell(a["error_rad"], "+.1e"))
        for a in result["angles"]
    ]
    lines = [f"**{experiment.scenario.title}**", ""]
    lines += markdown_table(rows[0], rows[1:])  # the outcome as the head
    lines += ["", *markdown_table(("angle", "target (deg)", "final (deg)", "error (rad)"), angles)]
    return "\n".join(lines) + "\n"
