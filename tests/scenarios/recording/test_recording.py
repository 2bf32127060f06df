"""Recordings: whole files whose columns are the run's own numbers, the same for the same run."""

import io
import json
import shutil
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from rerun.chunk import RrdReader
from rich.console import Console

from formation import agents as numbering
from robots.obstacles import Obstacle
from robots.testbed import COLLISION_DISTANCE
from robots.worlds import NOTHING
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.measures.result import result
from scenarios.measures.safety_result import NOTICEABLE
from scenarios.measures.tracking import predicted_ends
from scenarios.one_run import run_to_folder
from scenarios.recording import file, viewer
from scenarios.recording.encode import encode, encode_pair
from scenarios.recording.file import damage, write
from scenarios.recording.piece import rows, whole
from scenarios.recording.recorder import TIMELINE, Recorder, open_stream
from scenarios.recording.streams import send_motion, send_setup
from scenarios.recording.views import (
    angles,
    blueprint,
    filtering,
    happenings,
    legend,
    obstacles,
    plots,
    scene,
    style,
    timeline,
)
from scenarios.replay import recording_of
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.storage import run_folder

Columns = dict[str, dict[str, tuple[np.ndarray, list]]]


def read(path: Path) -> Columns:
    """Times (None for what is static) and values of every column, by entity and component."""
    found: dict[str, dict[str, tuple[list, list]]] = defaultdict(dict)
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if name not in ("rerun.controls.RowId", TIMELINE):
                times, values = found[chunk.entity_path].setdefault(name.rsplit(":", 1)[-1], ([], []))
                if TIMELINE in batch.schema.names:
                    times += batch.column(TIMELINE).cast("int64").to_pylist()
                values += batch.column(name).to_pylist()
    return {entity: {c: (np.array(t), v) for c, (t, v) in parts.items()} for entity, parts in found.items()}


def data(batch: pa.RecordBatch) -> str:
    """Everything in a chunk but its row ids. As text, where NaN equals itself."""
    columns = {name: batch.column(name) for name in batch.schema.names if name != "rerun.controls.RowId"}
    return str({name: (c.cast("int64") if name == TIMELINE else c).to_pylist() for name, c in columns.items()})


def scalars(columns: Columns, entity: str) -> np.ndarray:
    return np.array(columns[f"/{entity}"]["scalars"][1])


def of_states(columns: Columns, entity: str, t: np.ndarray) -> np.ndarray:
    """Scalars at the times of states; rows between them are gaps in curves that jump by a turn."""
    times = columns[f"/{entity}"]["scalars"][0]
    return scalars(columns, entity)[np.isin(times, np.round(t * 1e9).astype("int64"))]


def encoded(experiment: Experiment, path: Path, seed: int = 0) -> tuple[Path, object, object]:
    trajectory = simulate(experiment, seed)
    metrics = measure(experiment, trajectory)
    write(path, encode(experiment, trajectory, metrics, result(experiment, seed, trajectory, metrics)))
    return path, trajectory, metrics


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run folder of ten seconds of shape control among robots that touch."""
    folder = tmp_path_factory.mktemp("runs") / "shape"
    run_to_folder(open_experiment("shape", ("safety.filter=none",), 10.0), 0, folder, Console(quiet=True))
    return folder


@pytest.fixture(scope="module")
def columns(run: Path) -> Columns:
    return read(run / run_folder.RECORDING)


def test_a_run_leaves_a_recording_that_the_viewer_verifies(run: Path) -> None:
    path = run / run_folder.RECORDING
    assert damage(path) is None
    subprocess.run([viewer.executable(), "rrd", "verify", str(path)], check=True, capture_output=True)
    assert [path.name for path in run.iterdir() if path.name.startswith(".")] == []


def test_every_stream_has_its_entities(columns: Columns) -> None:
    expected = {
        f"/{scene.WORLD}": {"mat3x3"},
        f"/{scene.FLOOR}": {"strips"},
        f"/{scene.GRID}": {"strips"},
        f"/{scene.TICKS}": {"labels"},
        f"/{scene.SENSING}": {"vectors", "origins"},
        f"/{scene.TRAILS}": {"strips"},
        f"/{scene.PREDICTION}/rings": {"strips"},
        f"/{scene.PREDICTION}/links": {"strips"},
        f"/{scene.CAMERA}": {"translation"},
        f"/{angles.MEASURED}": {"strips"},
        f"/{angles.ERROR}": {"strips"},
        f"/{angles.WORDS}": {"labels"},
        f"/{legend.LEGEND}": {"text"},
        f"/{plots.ANGLES}/value": {"scalars", "names"},
        f"/{plots.ERROR_SUM}/value": {"scalars"},
        f"/{plots.ERROR_SUM}/goal": {"scalars"},
        f"/{plots.SEPARATION}/value": {"scalars"},
        f"/{plots.SEPARATION}/limit": {"scalars"},
        f"/{plots.WHEELS}/value": {"scalars"},
        f"/{plots.WHEELS}/limit": {"scalars"},
        f"/{plots.DISTANCE}/value": {"scalars"},
        f"/{timeline.PHASE}": {"state"},
        f"/{timeline.ERRORS}": {"state"},
        f"/{timeline.DISTANCE}": {"state"},
        f"/{timeline.FLOOR}": {"state"},
        f"/{timeline.EVENTS}/phases": {"text", "level"},
        f"/{timeline.EVENTS}/separation": {"text", "level"},
        f"/{timeline.EVENTS}/contacts": {"text", "level"},
        "/summary": {"text"},
        "/__properties/run": {"scenario", "seed", "plant", "safety", "outcome", "versions"},
    }
    for entity in (plots.SCALE, plots.ORIENTATION, plots.CENTROID):
        expected |= {f"/{entity}/{kind}": {"scalars"} for kind in ("ideal", "measured")}
    for number in range(1, 7):
        expected[f"/{scene.ROBOTS}/{number}"] = {"translation", "quaternion"}
        expected |= {f"/{scene.ROBOTS}/{number}/{part}": {"strips"} for part in ("fill", "outline", "wheels", "kept")}
        expected[f"/{scene.ROBOTS}/{number}/velocity"] = {"vectors"}
        expected[f"/{scene.ROBOTS}/{number}/point"] = {"positions", "labels"}
    for entity, components in expected.items():
        assert components <= columns.get(entity, {}).keys(), entity


def test_scalars_are_bit_for_bit_the_numbers_of_the_trajectory(run: Path, columns: Columns) -> None:
    with np.load(run / run_folder.TRAJECTORY) as data:
        assert np.array_equal(of_states(columns, f"{plots.ANGLES}/value", data["t"]), data["angle_errors"])
        wheels = scalars(columns, f"{plots.WHEELS}/value")
        assert np.array_equal(wheels.reshape(data["wheel_speeds"].shape), data["wheel_speeds"])


def test_times_are_simulation_time_to_the_nanosecond(run: Path, columns: Columns) -> None:
    with np.load(run / run_folder.TRAJECTORY) as data:
        times = columns[f"/{plots.WHEELS}/value"]["scalars"][0]
        np.testing.assert_allclose(times, data["t"] * 1e9, atol=0.5 + 1e-6, rtol=0)


def test_robots_are_where_they_are_and_point_where_they_point(run: Path, columns: Columns) -> None:
    with np.load(run / run_folder.TRAJECTORY) as data:
        poses = data["poses"]
    for row in range(6):
        parts = columns[f"/{scene.ROBOTS}/{numbering.number(row)}"]
        places = np.array(parts["translation"][1]).reshape(-1, 3)
        np.testing.assert_array_equal(places[:, :2], poses[:, row, :2].astype(np.float32))
        _, _, z, w = np.array(parts["quaternion"][1]).reshape(-1, 4).T
        turn = np.stack([w**2 - z**2, 2.0 * w * z], axis=-1)
        heading = np.stack([np.cos(poses[:, row, 2]), np.sin(poses[:, row, 2])], axis=-1)
        np.testing.assert_allclose(turn, heading, atol=1e-6)


def test_the_world_is_mirrored_so_that_y_points_up(columns: Columns) -> None:
    matrix = np.array(columns[f"/{scene.WORLD}"]["mat3x3"][1]).reshape(3, 3)
    np.testing.assert_array_equal(matrix, np.diag([1.0, -1.0, 1.0]))


def test_sensing_arrows_lie_on_the_lines_from_observer_to_observed(run: Path, columns: Columns, shape) -> None:
    with np.load(run / run_folder.TRAJECTORY) as data:
        points = data["points"]
    observer, observed = shape.graph.edges.T
    parts = columns[f"/{scene.SENSING}"]
    vectors, origins = (np.array([v for v in parts[name][1] if v is not None]) for name in ("vectors", "origins"))
    e = points[:, observed] - points[:, observer]
    across = vectors[..., 0] * e[..., 1] - vectors[..., 1] * e[..., 0]
    np.testing.assert_allclose(across, 0.0, atol=1e-6)
    assert ((vectors * e).sum(axis=-1) >= -1e-9).all()
    middle = (points[:, observed] + points[:, observer]) / 2.0
    np.testing.assert_allclose(origins + vectors / 2.0, middle, atol=1e-6)


def test_the_ghost_is_the_predicted_end_of_each_phase(moving: Callable[[str], Experiment], tmp_path: Path) -> None:
    experiment = moving("displacement")
    path, trajectory, _ = encoded(experiment, tmp_path / "run.rrd")
    found = read(path)
    times, rings = found[f"/{scene.PREDICTION}/rings"]["strips"]
    np.testing.assert_array_equal(times, [0, 2_000_000_000])
    centres = np.array(rings)[:, :, :-1].mean(axis=2)
    np.testing.assert_allclose(centres, predicted_ends(experiment, trajectory.points[0]), atol=1e-6)
    times, phases = found[f"/{timeline.PHASE}"]["state"]
    assert [list(each) for each in phases] == [["up"], ["right"]]
    np.testing.assert_array_equal(times, [0, 2_000_000_000])


def test_an_own_law_has_no_ghost_and_its_scale_nothing_beside_it(tmp_path: Path) -> None:
    """Nothing is predicted of it."""
    path, *_ = encoded(open_experiment("own-law", ("plant.name=unicycle",), 1.0), tmp_path / "recording.rrd")
    columns = read(path)
    assert "scalars" in columns[f"/{plots.SCALE}/measured"]
    for absent in (f"/{plots.SCALE}/ideal", f"/{plots.DISTANCE}/value"):
        assert "scalars" not in columns.get(absent, {})
    moving = [entity for entity in columns if entity.startswith(f"/{scene.PREDICTION}") and "strips" in columns[entity]]
    assert moving == []


def test_the_filter_is_recorded_where_there_is_one_and_only_there(columns: Columns, tmp_path: Path) -> None:
    path, trajectory, _ = encoded(open_experiment("shape", ("safety.filter=decentralised",), 5.0), tmp_path / "run.rrd")
    found = read(path)
    assert np.array_equal(scalars(found, f"{plots.INTERVENTIONS}/value"), trajectory.intervention)
    acts = (trajectory.intervention > NOTICEABLE).any(axis=1)
    relaxed = (trajectory.relaxation > 0.0).any(axis=1)
    state = np.where(relaxed, "relaxed", np.where(acts, "acting", "idle"))
    rows = np.flatnonzero(np.append(True, state[1:] != state[:-1]))
    assert [value[0] for value in found[f"/{timeline.SAFETY}"]["state"][1]] == state[rows].tolist()
    assert "acting" in state
    assert "scalars" not in columns[f"/{plots.INTERVENTIONS}/value"]


def test_obstacles_stand_where_they_are(tmp_path: Path) -> None:
    disc = "obstacles=[{vertices_m = [[1.0, 0.8]], radius_m = 0.1}]"
    experiment = open_experiment("shape", (disc,), 0.5)
    path, *_ = encoded(experiment, tmp_path / "run.rrd")
    (strips,) = read(path)[f"/{obstacles.OBSTACLES}"]["strips"][1]
    np.testing.assert_allclose(strips[0], experiment.arena.obstacles[0].outline, atol=1e-6)


@given(st.integers(3, 12), st.floats(0.02, 1.0), st.floats(0.0, 0.3))
def test_hatching_lies_inside_its_obstacle(corners: int, size: float, radius: float) -> None:
    turn = 2.0 * np.pi * np.arange(corners) / corners
    obstacle = Obstacle(size * np.stack([np.cos(turn), np.sin(turn)], axis=-1), radius)
    strokes = obstacles.hatching(obstacle.outline)
    assert len(strokes)
    assert (obstacle.distance(strokes.reshape(-1, 2)) < 1e-6).all()


def test_a_segment_without_a_radius_has_no_hatching() -> None:
    assert obstacles.hatching(Obstacle(np.array([[0.0, 0.0], [1.0, 0.0]])).outline).shape == (0, 2, 2)


def test_arcs_go_from_ray_to_ray_and_say_the_angle_and_its_error(run: Path, columns: Columns) -> None:
    read_back = run_folder.read(run)
    experiment, trajectory = read_back.experiment, read_back.trajectory
    times, strips = columns[f"/{angles.MEASURED}"]["strips"]
    rows = np.flatnonzero(np.isin(np.round(trajectory.t * 1e9).astype("int64"), times))
    points = trajectory.points[rows]
    vertex, first, second = experiment.angles.triples.T
    arcs = np.array([each for each in strips if each is not None]) + points.mean(axis=1)[:, None, None]
    spokes = arcs - points[:, vertex, None]
    for end, neighbour in ((0, first), (-1, second)):
        ray = points[:, neighbour] - points[:, vertex]
        across = spokes[:, :, end, 0] * ray[..., 1] - spokes[:, :, end, 1] * ray[..., 0]
        np.testing.assert_allclose(across / np.linalg.norm(ray, axis=-1), 0.0, atol=1e-6)
        assert ((spokes[:, :, end] * ray).sum(axis=-1) > 0.0).all()
    said = [text for text in columns[f"/{angles.WORDS}"]["labels"][1] if text is not None]
    for row, texts in zip(rows.tolist(), said, strict=True):
        errors = np.degrees(experiment.angles.errors(trajectory.points[row], experiment.target_angles))
        left = iter(f"({error:+z.1f})" for error in errors)
        assert all(text.split(" ")[1] in left for text in texts)  # in order; some have no room
    assert max(map(len, said)) > len(vertex) / 2


@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.integers(1, 8))
def test_words_stand_apart_or_not_at_all(seed: int, m: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    places, points = rng.uniform(-1.0, 1.0, (3, 5, m, 2)), rng.uniform(-1.0, 1.0, (5, n, 2))
    sizes = rng.uniform(0.05, 0.6, (1 + n, 2))
    chosen, shown = angles.apart(places, points, sizes)

    def free(place: NDArray[np.float64], state: int, row: int) -> bool:
        others = chosen[state, :row][shown[state, :row]]
        words = (np.abs(others - place) < sizes[0]).all(axis=-1)
        labels = (np.abs(points[state] - place) < (sizes[0] + sizes[1:]) / 2.0).all(axis=-1)
        return not (words.any() or labels.any())

    for state, row in np.ndindex(5, m):
        best = [place for place in places[:, state, row] if free(place, state, row)]
        assert shown[state, row] == bool(best)
        if best:
            assert np.array_equal(chosen[state, row], best[0])


@pytest.mark.parametrize(("slope", "beside"), [(1.0, ("RightTop", "LeftBottom")), (-1.0, ("RightBottom", "LeftTop"))])
def test_a_legend_keeps_out_of_the_way_of_its_curves(slope: float, beside: tuple[str, str]) -> None:
    experiment = open_experiment("shape")
    ramp = np.linspace(-1.0, 1.0, 50)[:, None, None]
    points = experiment.initial_points(0) + slope * ramp
    assert plots.corners(experiment, points, {})[plots.CENTROID].name not in beside


def test_a_curve_that_jumps_by_a_turn_has_a_gap_there_and_nowhere_else(run: Path, columns: Columns) -> None:
    with np.load(run / run_folder.TRAJECTORY) as data:
        t, errors = data["t"], data["angle_errors"]
    jumps = np.argwhere(np.abs(np.diff(errors, axis=0)) > np.pi)
    assert len(jumps)
    times, _ = columns[f"/{plots.ANGLES}/value"]["scalars"]
    values = scalars(columns, f"{plots.ANGLES}/value")
    between = ~np.isin(times, np.round(t * 1e9).astype("int64"))
    assert np.isfinite(values[~between]).all()
    assert np.count_nonzero(np.isnan(values[between])) == len(jumps)
    assert np.count_nonzero(between) == len(np.unique(jumps[:, 0]))


def test_arrows_tell_the_velocity_before_and_after_the_filter(tmp_path: Path) -> None:
    experiment = open_experiment("shape", (), 6.0)
    path, trajectory, _ = encoded(experiment, tmp_path / "run.rrd")
    found = read(path)
    differs = 0
    for row in range(experiment.n):
        times, vectors = found[f"/{scene.ROBOTS}/{numbering.number(row)}/velocity"]["vectors"]
        rows = np.flatnonzero(np.isin(np.round(trajectory.t * 1e9).astype("int64"), times))
        for at, (before, after) in zip(rows.tolist(), [v for v in vectors if v is not None], strict=True):
            for drawn, told in ((before, trajectory.wish[at, row]), (after, trajectory.command[at, row])):
                arrow = filtering.AHEAD * told
                longest = max(np.linalg.norm(arrow) / filtering.LONGEST, 1.0)
                np.testing.assert_allclose(drawn, arrow / longest, atol=1e-6)
            differs += not np.allclose(before, after, atol=1e-3)
    assert differs


def test_a_crowd_has_dots_and_no_arcs_ranges_or_arrows(recorded: Callable[..., Any], tmp_path: Path) -> None:
    experiment = open_experiment("random-50")
    points = experiment.target.positions + np.zeros((3, 1, 1))
    poses = np.concatenate([points, np.zeros((3, 50, 1))], axis=-1)
    trajectory = recorded(np.array([0.0, 0.5, 1.0]), poses, points)
    metrics = measure(experiment, trajectory)
    path = tmp_path / "run.rrd"
    write(path, encode(experiment, trajectory, metrics, result(experiment, 0, trajectory, metrics)))
    found = read(path)
    assert experiment.n > style.CROWD
    for absent in (angles.MEASURED, angles.WORDS, f"{scene.ROBOTS}/3/sensing", f"{scene.ROBOTS}/3/velocity"):
        assert f"/{absent}" not in found
    said = {number: found[f"/{scene.ROBOTS}/{number}/point"].get("labels", (None, [None]))[1] for number in (1, 2, 3)}
    assert said == {1: [["1 leader"]], 2: [["2 first follower"]], 3: [None]}


def test_the_camera_goes_with_the_centroid(run: Path, columns: Columns) -> None:
    with np.load(run / run_folder.TRAJECTORY) as data:
        centre = data["points"].mean(axis=1)
    places = np.array(columns[f"/{scene.CAMERA}"]["translation"][1]).reshape(-1, 3)
    np.testing.assert_allclose(places[:, :2], centre * [1.0, -1.0], atol=1e-6)


def test_the_view_from_near_by_is_in_front_where_the_formation_leaves(shape: Experiment) -> None:
    start = shape.initial_points(0)
    there = start + np.linspace(0.0, 1.0, 5)[:, None, None] * np.array([3.0, 3.0])
    fronts = [blueprint.scenery(shape, points).active_tab for points in (start[None], there)]
    assert fronts == [0, 1]


def test_a_plant_without_wheels_has_no_wheel_speeds(moving: Callable[[str], Experiment], tmp_path: Path) -> None:
    path, *_ = encoded(moving("displacement"), tmp_path / "run.rrd")
    assert "scalars" not in read(path)[f"/{plots.WHEELS}/value"]


def test_states_change_exactly_where_the_limit_is_crossed(run: Path, columns: Columns) -> None:
    near = measure(*(lambda r: (r.experiment, r.trajectory))(run_folder.read(run))).separation.distance
    close = near < COLLISION_DISTANCE
    assert close.any()
    assert len(columns[f"/{timeline.DISTANCE}"]["state"][1]) == 1 + np.count_nonzero(close[1:] != close[:-1])
    assert len(columns[f"/{timeline.EVENTS}/separation"]["text"][1]) == np.count_nonzero(close[1:] & ~close[:-1])


def test_every_two_agents_that_begin_to_touch_are_one_event(run: Path, columns: Columns) -> None:
    touched = run_folder.read(run).trajectory.contact
    expected = set()
    for row, agent in np.argwhere((touched[1:] != touched[:-1]) & (touched[1:] != NOTHING)).tolist():
        one, other = sorted((agent, int(touched[row + 1, agent])))
        expected.add((row + 1, f"agents {one + 1} and {other + 1} touch"))
    assert expected
    assert [text for (text,) in columns[f"/{timeline.EVENTS}/contacts"]["text"][1]] == [t for _, t in sorted(expected)]


def test_who_touches_a_wall_is_an_event(tmp_path: Path) -> None:
    experiment = open_experiment("shape", ("arena={x_m=[-1.0, 0.5], walls=true}", "safety.filter=none"), 10.0)
    path, trajectory, _ = encoded(experiment, tmp_path / "run.rrd")
    (agent, *_) = np.flatnonzero((trajectory.contact == experiment.n).any(axis=0))
    texts = [text for (text,) in read(path)[f"/{timeline.EVENTS}/contacts"]["text"][1]]
    assert f"{numbering.name(agent)} touches a wall or an obstacle" in texts


def test_a_run_that_diverges_is_recorded_up_to_its_last_finite_state(shape: Experiment, tmp_path: Path) -> None:
    trajectory = simulate(shape, 0).until(100)
    for states in (trajectory.poses, trajectory.points):
        states[-1] = np.nan
    metrics = measure(shape, trajectory)
    path = tmp_path / "diverged.rrd"
    write(path, encode(shape, trajectory, metrics, result(shape, 0, trajectory, metrics)))
    assert damage(path) is None
    assert len(read(path)[f"/{scene.ROBOTS}/1"]["translation"][1]) == 99


def test_two_runs_with_one_seed_have_the_same_chunk_data(tmp_path: Path) -> None:
    chunks = []
    for name in ("a.rrd", "b.rrd"):
        path, *_ = encoded(open_experiment("shape", (), 5.0), tmp_path / name, seed=3)
        chunks.append([data(chunk.to_record_batch()) for chunk in RrdReader(str(path)).stream()])
    assert chunks[0] == chunks[1]


def test_pieces_of_a_run_tell_what_the_whole_tells(tmp_path: Path) -> None:
    experiment = open_experiment("shape", (), 6.0)
    trajectory = simulate(experiment, 0)
    cuts = [0, 1, 2, 50, 90, 91, len(trajectory.t) - 1]
    parts = [rows(experiment, trajectory, first, last + 1) for first, last in pairwise(cuts)]
    found = []
    for name, pieces in (
        ("pieces", parts),
        ("whole", [whole(experiment, trajectory, measure(experiment, trajectory))]),
    ):
        stream = open_stream(name)
        memory = stream.memory_recording()
        send_setup(Recorder(stream), experiment)
        for piece in pieces:
            send_motion(Recorder(stream), piece)
        write(tmp_path / name, memory.drain_as_bytes())
        found.append(read(tmp_path / name))
    assert found[0].keys() == found[1].keys()
    for entity, components in found[1].items():
        if entity == f"/{scene.TRAILS}" or entity.endswith(("/limit", "/goal")):
            continue  # cut elsewhere, same lines
        for component, (times, values) in components.items():
            some_times, some_values = found[0][entity][component]
            if not len(times):
                continue
            given = {
                int(t): str(v) for t, v in zip(some_times, [v for v in some_values if v is not None], strict=False)
            }
            wanted = {int(t): str(v) for t, v in zip(times, [v for v in values if v is not None], strict=False)}
            assert given == wanted, (entity, component)


@given(place=st.integers(min_value=0), flip=st.integers(1, 255))
def test_every_flipped_byte_is_noticed(tmp_path_factory: pytest.TempPathFactory, place: int, flip: int) -> None:
    path = tmp_path_factory.mktemp("flip") / "recording.rrd"
    content = bytearray(b"any content of some length")
    write(path, bytes(content))
    assert damage(path) is None
    content[place % len(content)] ^= flip
    path.write_bytes(content)
    assert damage(path) == "damaged"


@pytest.mark.parametrize("cut", ["missing", "truncated", "flipped"])
def test_a_lost_or_damaged_recording_is_rebuilt_as_it_was(run: Path, tmp_path: Path, cut: str) -> None:
    folder = tmp_path / "run"
    shutil.copytree(run, folder)
    path = folder / run_folder.RECORDING
    original = read(path)
    content = bytearray(path.read_bytes())
    if cut == "missing":
        path.unlink()
    else:
        content[len(content) // 2] ^= 0xFF
        path.write_bytes(content[:-1000] if cut == "truncated" else content)
    console = Console(record=True, file=io.StringIO(), width=400)
    assert recording_of(folder, tmp_path, console) == path
    assert "rebuilt" in console.export_text()
    assert damage(path) is None
    assert str(read(path)) == str(original)


def test_a_folder_that_cannot_be_written_is_replayed_from_a_copy(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "run"
    shutil.copytree(run, folder, ignore=shutil.ignore_patterns("*.rrd"))
    whole_write = write

    def refuse(path: Path, content: bytes) -> None:
        if path.parent == folder:
            raise PermissionError(13, "Permission denied")
        whole_write(path, content)

    monkeypatch.setattr(file, "write", refuse)
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    path = recording_of(folder, scratch, Console(quiet=True))
    assert path.parent == scratch
    assert damage(path) is None


def test_a_full_disk_costs_the_recording_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, content: bytes) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(file, "write", full)
    console = Console(record=True, file=io.StringIO(), width=400)
    run_to_folder(open_experiment("shape", (), 1.0), 0, tmp_path / "run", console)
    assert "recording: cannot be written: No space left on device" in console.export_text()
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert names >= {run_folder.RESULT, run_folder.SCENARIO, run_folder.TRAJECTORY}
    assert run_folder.RECORDING not in names


RUN_WITH = """
import sys
from pathlib import Path
from rich.console import Console
import scenarios.one_run
from scenarios.definition.experiment import open_experiment
{}
scenarios.one_run.run_to_folder(open_experiment("shape", (), 1.0), 0, Path(sys.argv[1]), Console(width=400))
"""
"""A run in a process of its own, which alone may have a child: this one has threads, and may have loaded rerun."""

KILL = """
import os, signal
draw, enter, children = scenarios.one_run._draw_overview, scenarios.one_run.aside.Encoder.__enter__, []
def remembered(encoder):
    enter(encoder)
    children.append(encoder._child)
    return encoder
def kill(*arguments):
    os.kill(children[0], signal.SIGKILL)
    draw(*arguments)
scenarios.one_run.aside.Encoder.__enter__, scenarios.one_run._draw_overview = remembered, kill
"""


def run_with(changes: str, folder: Path) -> str:
    code = [sys.executable, "-c", RUN_WITH.format(changes), str(folder)]
    done = subprocess.run(code, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.skipif(sys.platform != "linux", reason="encodes in a child on Linux only")
def test_a_killed_encoder_costs_the_recording_and_nothing_else(tmp_path: Path) -> None:
    told = run_with(KILL, tmp_path / "run")
    assert "recording: cannot be written: the process that encodes it ended with code -9" in told
    assert damage(recording_of(tmp_path / "run", tmp_path, Console(quiet=True))) is None


def test_a_run_leaves_nothing_out_of_its_recording(tmp_path: Path) -> None:
    """What rerun cannot convert it leaves out, with a warning."""
    told = run_with("import warnings; warnings.simplefilter('error')", tmp_path / "run")
    assert "recording: cannot be written" not in told
    assert "run folder: " in told


def test_a_recording_that_cannot_be_made_costs_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*arguments: Any) -> bytes:
        raise ValueError("no such component")

    monkeypatch.setattr("scenarios.recording.encode.encode", broken)  # loaded by now, so that this process encodes
    console = Console(record=True, file=io.StringIO(), width=400)
    run_to_folder(open_experiment("shape", (), 1.0), 0, tmp_path / "run", console)
    assert "recording: cannot be written: ValueError: no such component; replay will" in console.export_text()
    monkeypatch.undo()
    assert damage(recording_of(tmp_path / "run", tmp_path, Console(quiet=True))) is None


def test_a_child_encodes_what_the_process_itself_would(tmp_path: Path) -> None:
    assert "recording" not in run_with("", tmp_path / "child")
    run_to_folder(open_experiment("shape", (), 1.0), 0, tmp_path / "itself", Console(quiet=True))  # rerun is loaded
    sizes = [(tmp_path / name / run_folder.RECORDING).stat().st_size for name in ("child", "itself")]
    assert sizes[0] == pytest.approx(sizes[1], rel=0.01)  # the time of writing is in it
    assert damage(tmp_path / "child" / run_folder.RECORDING) is None


def test_an_encoder_ends_with_the_run_that_started_it() -> None:
    code = """
import os, sys, time
from scenarios.recording.aside import Encoder
try:
    with Encoder(lambda: time.sleep(60)) as encoder:
        child = encoder._child
        raise KeyboardInterrupt
except KeyboardInterrupt:
    pass
try:
    os.kill(child, 0)
    sys.exit("it lives")
except ProcessLookupError:
    pass
Encoder(lambda: time.sleep(1)).__enter__()
os._exit(9)
"""
    orphaned = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert (orphaned.returncode, orphaned.stderr) == (9, "")  # and returned: nobody holds its output open


def test_a_folder_of_the_users_named_like_a_package_is_not_imported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "scenarios").mkdir()
    (tmp_path / "scenarios" / "__init__.py").write_text("raise RuntimeError", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    run_to_folder(open_experiment("shape", (), 0.1), 0, tmp_path / "run", Console(quiet=True))
    assert damage(tmp_path / "run" / run_folder.RECORDING) is None


def test_writing_leaves_no_scratch_file_when_the_place_is_taken(tmp_path: Path) -> None:
    (tmp_path / "recording.rrd").mkdir()
    with pytest.raises(OSError):
        write(tmp_path / "recording.rrd", b"content")
    assert [path.name for path in tmp_path.iterdir()] == ["recording.rrd"]


def test_replay_of_something_else_is_refused_on_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="not a run folder"):
        recording_of(tmp_path, tmp_path, Console(quiet=True))


def test_two_runs_share_a_recording_side_by_side(run: Path, tmp_path: Path) -> None:
    path = tmp_path / "pair.rrd"
    write(path, encode_pair([run_folder.read(run)] * 2))
    found = read(path)
    assert damage(path) is None
    for entity in (f"{scene.ROBOTS}/1", f"{plots.ERROR_SUM}/value", timeline.PHASE, "summary"):
        assert str(found[f"/A/{entity}"]).splitlines()[0] == str(found[f"/B/{entity}"]).splitlines()[0]


def test_a_recording_made_from_the_run_folder_equals_the_one_made_of_the_states_in_memory(
    run: Path, tmp_path: Path
) -> None:
    read_back = run_folder.read(run)
    path, *_ = encoded(read_back.experiment, tmp_path / "again.rrd", read_back.result["seed"])
    assert str(read(path)) == str(read(run / run_folder.RECORDING))


def test_the_summary_page_states_the_result(run: Path, columns: Columns) -> None:
    (text,) = columns["/summary"]["text"][1]
    summary = json.loads((run / run_folder.RESULT).read_text(encoding="utf-8"))
    assert summary["outcome"].replace("_", " ") in text[0]
    assert all(angle["name"] in text[0] for angle in summary["angles"])


def test_nothing_of_rerun_is_imported_before_a_recording_is_asked_for() -> None:
    modules = "sys, scenarios.cli, scenarios.one_run, scenarios.replay"
    code = f"import {modules}; print([m for m in sys.modules if m == 'rerun'])"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout.strip() == "[]"


def test_events_are_in_the_log_and_on_the_floor_and_lost_edges_have_no_arrow(tmp_path: Path) -> None:
    events = (
        "events=[{t_s=1.0, kind='edge-loss', edge=[4, 3], until_s=2.0}, {t_s=1.5, kind='stop', agent=5}, "
        "{t_s=2.5, kind='obstacle', vertices_m=[[1.2, 0.8]], radius_m=0.1}]"
    )
    experiment = open_experiment("shape", (events,), 4.0)
    path, trajectory, _ = encoded(experiment, tmp_path / "events.rrd")
    found = read(path)
    times, texts = found[f"/{timeline.EVENTS}/happenings"]["text"]
    assert dict(zip([str(*text) for text in texts], (times / 1e9).tolist(), strict=True)) == {
        "agent 4 does not sense agent 3 until 2 s": 1.0,
        "agent 4 senses agent 3": 2.0,
        "agent 5 stops for good": 1.5,
        "an obstacle appears at (1.2, 0.8) m for good": 2.5,
    }
    signs = {entity for entity in found if entity.startswith(f"/{happenings.SIGNS}")}
    assert signs == {f"/{happenings.SIGNS}/{each}" for each in ("1", "2", "3", "3/outline")}
    times, arrows = found[f"/{scene.SENSING}"]["vectors"]
    lengths = np.linalg.norm(np.array(arrows)[:, 4], axis=-1)
    lost = (times / 1e9 >= 1.0 - 1e-6) & (times / 1e9 < 2.0 - 1e-6)
    np.testing.assert_allclose(lengths[lost], 0.0, atol=1e-7)
    assert (lengths[~lost] > 0.01).all()
    assert isinstance(trajectory, Trajectory)
    place = np.array(found[f"/{happenings.SIGNS}/2"]["positions"][1][0])[0]
    np.testing.assert_allclose(place, trajectory.points[np.searchsorted(trajectory.t, 1.5), 4], atol=1e-6)


def test_arrows_follow_the_graph_of_the_shape_of_the_time(tmp_path: Path) -> None:
    experiment = open_experiment("reshape", ("safety.filter=none",), 41.0)
    path, trajectory, _ = encoded(experiment, tmp_path / "reshape.rrd")
    assert isinstance(trajectory, Trajectory)
    times, arrows = read(path)[f"/{scene.SENSING}"]["vectors"]
    assert len(times) == len(trajectory.t)
    for row in (0, len(times) - 1):
        shaped = experiment.of_phase(int(trajectory.phase[row]))
        observer, observed = shaped.graph.edges.T
        e = trajectory.points[row, observed] - trajectory.points[row, observer]
        vectors = np.array(arrows[np.argsort(times)[row]])
        np.testing.assert_allclose(vectors[:, 0] * e[:, 1] - vectors[:, 1] * e[:, 0], 0.0, atol=1e-6)
