"""The recording of a script's run: its robots on the floor with their trails, its own figure over time, the verdict."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from robots.arena import ROBOTARIUM_FLOOR, Arena
from robots.model import COLLISION_CENTRE, GTERNAL
from robots.rps.simulation import Record
from robots.testbed import COLLISION_DISTANCE, collision_centres, separation
from robots.worlds import NOTHING
from scenarios.measures.script_result import OUTCOMES, describe
from scenarios.recording.encode import SIDES
from scenarios.recording.recorder import TIMELINE, Recorder, open_stream
from scenarios.recording.views import scene, style
from scenarios.simulation.script.frames import Frames
from scenarios.storage.script_folder import ScriptRun

Real = NDArray[np.float64]

FIGURE, SUMMARY, EVENTS = "figure", "summary", "events"
NEAR, WHEELS = "separation", "wheels"
CLOSEST = "Closest pair (m), limit red"
NO_LEGEND = rrb.PlotLegend(visible=False)
FLOOR = Arena(ROBOTARIUM_FLOOR.x, ROBOTARIUM_FLOOR.y, walls=False)
MARGIN = 0.22
"""Metres of floor around everything that is shown."""


def encode_script(run: ScriptRun) -> bytes:
    """The recording, as the content of an ``.rrd`` file."""
    blueprint = layout(run.record.poses, bool(run.frames.pictures))
    return _encoded(identity(run.result), title(run.result), blueprint, [(run, "", style.MEASURED)])


def encode_scripts(runs: Sequence[ScriptRun]) -> bytes:
    """One recording of two runs, side by side, with their closest pairs in shared axes."""
    sides = [(run, side.root, side.colour) for run, side in zip(runs, SIDES, strict=True)]
    names = [title(run.result) for run in runs]
    arenas = [
        rrb.Vertical(
            arena(run.record.poses, side.root, f"{side.root}, {side.word}: {name}"),
            *picture(run.frames.pictures, side.root),
            notes(side.root),
            row_shares=[2.2, *([1.6] if run.frames.pictures else []), 1.0],
        )
        for run, side, name in zip(runs, SIDES, names, strict=True)
    ]
    near = rrb.TimeSeriesView(
        contents=[f"+ {_path(side.root, NEAR)}/**" for side in SIDES], name=CLOSEST, plot_legend=NO_LEGEND
    )
    blueprint = _panels(rrb.Vertical(rrb.Horizontal(*arenas), near, row_shares=[3.0, 1.0]), "playing")
    return _encoded(" ".join(identity(run.result) for run in runs), " beside ".join(names), blueprint, sides)


def _encoded(
    recording_id: str, name: str, blueprint: rrb.Blueprint, runs: Sequence[tuple[ScriptRun, str, style.Colour]]
) -> bytes:
    """Runs, each with the entity below which it goes and the colour of its curves."""
    stream = open_stream(recording_id)
    memory = stream.memory_recording()
    try:
        stream.send_recording_name(name)
        stream.send_blueprint(blueprint)
        for run, root, colour in runs:
            recorder = Recorder(stream, root, colour)
            send_setup(recorder, run.record.poses.shape[1])
            send_motion(recorder, run.record)
            send_frames(recorder, run.frames)
            _outcome(recorder, run)
        return memory.drain_as_bytes()
    finally:
        stream.disconnect()


def identity(result: dict[str, Any]) -> str:
    """What two recordings share only if they are of the same run."""
    return f"{result['script']}-{result['plant']}-seed{result['seed']}-{result['script_sha256'][:12]}"


def title(result: dict[str, Any]) -> str:
    """How people tell runs apart."""
    return f"{result['script']}, {result['plant']}, seed {result['seed']}"


def send_setup(recorder: Recorder, n: int) -> None:
    """What is known before n robots move."""
    scene.ground(recorder, FLOOR)
    scene.draw_bodies(recorder, GTERNAL, COLLISION_CENTRE, [str(robot) for robot in range(n)])
    scene.shade_trails(recorder, n)
    _series(recorder, f"{NEAR}/value", ["closest pair"], [recorder.colour])
    _series(recorder, f"{NEAR}/limit", ["testbed's limit"], [style.LIMIT])
    names = [f"{robot} {side}" for robot in range(n) for side in ("left", "right")]
    _series(recorder, f"{WHEELS}/value", names, [style.agent_colour(k // 2) for k in range(2 * n)])
    _series(recorder, f"{WHEELS}/limit", ["limit", "limit"], [style.LIMIT] * 2)


def send_motion(recorder: Recorder, record: Record) -> None:
    """Where robots are, how close, and how fast their wheels are told to turn."""
    t, poses = record.t, record.poses
    scene.move_bodies(recorder, t, poses, [str(robot) for robot in range(poses.shape[1])])
    scene.draw_trails(recorder, t, poses[..., :2])
    near = separation(collision_centres(poses))
    if np.isfinite(near.distance).all():
        recorder.columns(f"{NEAR}/value", t, rr.Scalars.columns(scalars=near.distance))
    wheels = record.wheel_speeds.reshape(len(t), -1)
    columns = rr.Scalars.columns(scalars=wheels.ravel()).partition(np.full(len(t), wheels.shape[1]))
    recorder.columns(f"{WHEELS}/value", t, columns)
    recorder.columns(f"{NEAR}/limit", t, rr.Scalars.columns(scalars=np.full(len(t), COLLISION_DISTANCE)))
    limit = GTERNAL.drive.wheel_speed_limit
    both = rr.Scalars.columns(scalars=np.tile([-limit, limit], len(t))).partition(np.full(len(t), 2))
    recorder.columns(f"{WHEELS}/limit", t, both)
    _events(recorder, record, near.distance, near.pairs)


def send_frames(recorder: Recorder, frames: Frames) -> None:
    """The script's own figure."""
    if frames.pictures:
        kinds = ["image/png"] * len(frames.pictures)
        columns = rr.EncodedImage.columns(blob=list(frames.pictures), media_type=kinds)
        recorder.columns(FIGURE, frames.t, columns)


def layout(poses: Real, figure: bool, live: bool = False) -> rrb.Blueprint:
    """The views of a run of poses (T, n, 3); with room for a figure, where there is one."""
    plots = [
        rrb.TimeSeriesView(origin=_path("", entity), name=name, plot_legend=NO_LEGEND)
        for entity, name in ((NEAR, CLOSEST), (WHEELS, "Wheels as told (rad/s), limits red"))
    ]
    right = rrb.Vertical(*picture(figure, ""), *plots, row_shares=[*([2.0] if figure else []), 1.0, 1.0])
    left = rrb.Vertical(arena(poses, "", "Arena (m)"), notes(""), row_shares=[2.2, 1.0])
    return _panels(rrb.Horizontal(left, right, column_shares=[1.35, 1.0]), "following" if live else "playing")


def arena(poses: Real, root: str, name: str) -> rrb.Spatial2DView:
    """The floor with all that robots with poses (T, n, 3) come to."""
    seen = poses[..., :2].reshape(-1, 2)
    known = np.concatenate([seen[np.isfinite(seen).all(axis=1)].clip(-4.0, 4.0), FLOOR.corners])
    (x0, y0), (x1, y1) = known.min(axis=0) - MARGIN, known.max(axis=0) + MARGIN
    trail = rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.cursor_relative(seconds=-style.TRAIL_LENGTH),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
    still = rrb.EntityBehavior(interactive=False)
    return rrb.Spatial2DView(
        origin="/",
        contents=f"+ {_path(root, scene.VIEW)}/**",
        name=name,
        visual_bounds=rrb.VisualBounds2D(x_range=[x0, x1], y_range=[-y1, -y0]),
        background=rrb.Background(color=style.BACKGROUND),
        overrides={_path(root, scene.TRAILS): trail, **{_path(root, entity): still for entity in scene.BACKDROP}},
    )


def notes(root: str) -> rrb.Tabs:
    """The summary and the events."""
    return rrb.Tabs(
        rrb.TextDocumentView(origin=_path(root, SUMMARY), name="Summary"),
        rrb.TextLogView(origin=_path(root, EVENTS), name="Events"),
        active_tab="Summary",
    )


def picture(shown: object, root: str) -> list[rrb.Spatial2DView]:
    """The script's figure, where there is one."""
    return [rrb.Spatial2DView(origin=_path(root, FIGURE), name="The script's figure")] if shown else []


def _path(root: str, entity: str) -> str:
    return f"/{root}/{entity}" if root else f"/{entity}"


def _panels(views: rrb.Container, play_state: Literal["playing", "following"]) -> rrb.Blueprint:
    return rrb.Blueprint(
        views,
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state=play_state, playback_speed=1.0),
    )


def markdown(result: dict[str, Any]) -> str:
    """The summary page: how it ended, and what the testbed says."""
    testbed, near = result["testbed"], result["min_separation"]
    closest = "-" if near["distance_m"] is None else f"{near['distance_m']:.3f} m at {near['time_s']:.1f} s"
    rows = [
        ("outcome", f"**{OUTCOMES[result['outcome']]}** at {result['duration_s']:.2f} s"),
        ("testbed", "**accepted**" if testbed["accepted"] else "**rejected**"),
        ("closest pair", closest),
        ("robots", str(result["robots"])),
        ("plant, seed, rps", f"{result['plant']}, {result['seed']}, {result['rps']}"),
    ]
    table = [f"| {name} | {value} |" for name, value in rows]
    lines = [f"**{result['script']}**", "", table[0], "|---|---|", *table[1:], ""]
    lines += [f"- {describe(violation)}" for violation in testbed["violations"]]
    if result["advice"]:
        lines += ["", result["advice"]]
    return "\n".join(lines) + "\n"


def _outcome(recorder: Recorder, run: ScriptRun) -> None:
    result = run.result
    recorder.fixed(SUMMARY, rr.TextDocument(markdown(result), media_type=rr.MediaType.MARKDOWN))
    keys = ("script", "script_sha256", "seed", "plant", "rps", "outcome", "duration_s")
    versions = [f"{name} {version}" for name, version in result["versions"].items()]
    recorder.parameters("run", rr.AnyValues(**{key: result[key] for key in keys}, versions=versions))


def _events(recorder: Recorder, record: Record, distance: Real, pairs: NDArray[np.intp]) -> None:
    """When robots come too close, touch, and leave the floor."""
    found: list[tuple[int, str]] = []
    close = distance <= COLLISION_DISTANCE
    found += [
        (row, f"robots {pairs[row, 0]} and {pairs[row, 1]} come within {COLLISION_DISTANCE:g} m")
        for row in _begins(close)
    ]
    outside = ~FLOOR.contains(record.poses[..., :2])
    for robot in range(record.poses.shape[1]):
        found += [(row, f"robot {robot} leaves the floor") for row in _begins(outside[:, robot])]
        touches = record.contacts[:, robot] != NOTHING
        found += [
            (row, f"robots {robot} and {record.contacts[row, robot]} touch")
            for row in _begins(touches)
            if record.contacts[row, robot] > robot
        ]
    if found:
        rows, texts = zip(*sorted(found), strict=True)
        levels = [str(rr.TextLogLevel.WARN)] * len(texts)
        recorder.columns(EVENTS, record.t[list(rows)], rr.TextLog.columns(text=list(texts), level=levels))


def _begins(holds: NDArray[np.bool_]) -> list[int]:
    before = np.concatenate([[False], holds[:-1]])
    return np.flatnonzero(holds & ~before).tolist()


def _series(recorder: Recorder, entity: str, names: list[str], colours: list[style.Colour]) -> None:
    recorder.fixed(entity, rr.SeriesLines(names=names, colors=colours, widths=[1.5] * len(names)))
