"""What is what in the arena, as a page to read."""

from __future__ import annotations

import rerun as rr

from scenarios.definition.experiment import Experiment
from scenarios.documents import markdown_table
from scenarios.recording.recorder import Recorder
from scenarios.recording.views import filtering, scene, style

LEGEND = "legend"


def page(recorder: Recorder, experiment: Experiment) -> None:
    """The marks that this run has."""
    recorder.fixed(LEGEND, rr.TextDocument(markdown(experiment), media_type=rr.MediaType.MARKDOWN))


def markdown(experiment: Experiment) -> str:
    """A row a mark."""
    crowd, filtered = experiment.n > style.CROWD, experiment.safety != "none"
    rows = [("a colour", "an agent, in the arena and in all plots"), ("grey arrow", "senses")]
    if scene.roles(experiment):
        rows.append(("gold diamond, triangle", "leader, first follower"))
    if experiment.predicted:
        rows.append(("small ring", "where an agent is predicted to end"))
    kept = experiment.filter_settings.safe_distance
    rows.append(("red circle", f"keeps {kept:g} m" if filtered else "the testbed's distance: two may not touch"))
    if not crowd:
        rows.append(("arc", "an angle of the formation, from its first ray to its second; red is what it lacks"))
        rows.append(("white arrow", f"velocity, {filtering.AHEAD:g} s of it"))
    if filtered and not crowd:
        rows.append(("gold arrow below", "what the law asked for before the filter"))
        rows.append(("grey circle", f"what a robot senses of others, {experiment.filter_settings.sensing_range:g} m"))
    if experiment.arena.obstacles:
        rows.append(("hatched", "an obstacle"))
    rows.append(("in plots", "red is a limit, grey a prediction, green the goal"))
    return "\n".join(markdown_table(("mark", "is"), rows)) + "\n"
