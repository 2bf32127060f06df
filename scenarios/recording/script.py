"""The recording of a script's run: its robots on the floor with their trails, its own figure over time, the verdict."""

from __future__ import annotations

from typing import Any

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
from scenarios.recording.recorder import TIMELINE, Recorder, open_stream
from scenarios.recording.views import scene, style
from scenarios.simulation.script.frames import Frames
from scenarios.storage.script_folder import ScriptRun

Real = NDArray[np.float64]

FIGURE, SUMMARY, EVENTS = "figure", "summary", "events"
NEAR, WHEELS = "separation", "wheels"
FLOOR = Arena(ROBOTARIUM_FLOOR.x, ROBOTARIUM_FLOOR.y, walls=False)
MARGIN = 0.22
"""Metres of floor around everything that is shown."""


def encode_script(run: ScriptRun) -> bytes:
    """The recording, as the content of an ``.rrd`` file."""
    result = run.result
    stream = open_stream(identity(result))
    memory = stream.memory_recording()
    try:
        stream.send_recording_name(title(result))
        stream.send_blueprint(layout(run.record.poses, bool(run.frames.pictures)))
        recorder = Recorder(stream)
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
    _series(recorder, f"{NEAR}/value", ["closest pair"], [style.MEASURED])
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
    seen = poses[..., :2].reshape(-1, 2)
    known = np.concatenate([seen[np.isfinite(seen).all(axis=1)].clip(-4.0, 4.0), FLOOR.corners])
    (x0, y0), (x1, y1) = known.min(axis=0) - MARGIN, known.max(axis=0) + MARGIN
    trail = rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.cursor_relative(seconds=-style.TRAIL_LENGTH),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
    still = rrb.EntityBehavior(interactive=False)
    arena = rrb.Spatial2DView(
        origin="/",
        contents=f"+ /{scene.VIEW}/**",
        name="Arena (m)",
        visual_bounds=rrb.VisualBounds2D(x_range=[x0, x1], y_range=[-y1, -y0]),
        background=rrb.Background(color=style.BACKGROUND),
        overrides={f"/{scene.TRAILS}": trail, **{f"/{entity}": still for entity in scene.BACKDROP}},
    )
    notes = rrb.Tabs(
        rrb.TextDocumentView(origin=f"/{SUMMARY}", name="Summary"),
        rrb.TextLogView(origin=f"/{EVENTS}", name="Events"),
        active_tab="Summary",
    )
    plots = [
        rrb.TimeSeriesView(origin=f"/{entity}", name=name, plot_legend=rrb.PlotLegend(visible=False))
        for entity, name in ((NEAR, "Closest pair (m), limit red"), (WHEELS, "Wheels as told (rad/s), limits red"))
    ]
    picture = [rrb.Spatial2DView(origin=f"/{FIGURE}", name="The script's figure")] if figure else []
    right = rrb.Vertical(*picture, *plots, row_shares=[*([2.0] if figure else []), 1.0, 1.0])
    left = rrb.Vertical(arena, notes, row_shares=[2.2, 1.0])
    return rrb.Blueprint(
        rrb.Horizontal(left, right, column_shares=[1.35, 1.0]),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        rrb.TimePanel(
            state="collapsed", timeline=TIMELINE, play_state="following" if live else "playing", playback_speed=1.0
        ),
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
