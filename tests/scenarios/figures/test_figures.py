"""What the figures show is what was run."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch

from robots import Arena
from robots.testbed import COLLISION_DISTANCE
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.errors import InputError
from scenarios.figures import FIGURES, draw, names_for
from scenarios.figures.decay import places
from scenarios.figures.floor import limits, placed
from scenarios.figures.labels import Labels
from scenarios.figures.motion import rows_at, snapshot_rows
from scenarios.figures.style import COLUMN, FORMATS, print_style, render
from scenarios.figures.timelines import unwrapped, written
from scenarios.measures.metrics import Metrics, measure
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory


@dataclass(frozen=True)
class Ran:
    experiment: Experiment
    trajectory: Trajectory
    metrics: Metrics

    def draw(self, name: str) -> Figure:
        with print_style():
            return FIGURES[name](self.experiment, self.trajectory, self.metrics)


def ran(scenario: str, *changes: str, duration: float | None = None) -> Ran:
    experiment = open_experiment(scenario, changes, duration)
    trajectory = simulate(experiment, 0)
    return Ran(experiment, trajectory, measure(experiment, trajectory))


@pytest.fixture(scope="module")
def shape() -> Ran:
    return ran("shape", "plant.name=saturated")


@pytest.fixture(scope="module")
def maneuver() -> Ran:
    return ran("maneuver", "plant.name=saturated")


def texts(figure: Figure) -> list[str]:
    with print_style():
        figure.canvas.draw()
        labels = [text.get_text() for axes in figure.axes for text in axes.texts]
        legends = [*figure.legends, *(a.get_legend() for a in figure.axes if a.get_legend() is not None)]
        return labels + [text.get_text() for legend in legends for text in legend.get_texts()]


def lines(axes: Axes) -> dict[str, np.ndarray]:
    return {str(line.get_label()): np.asarray(line.get_xydata()) for line in axes.lines}


def test_trails_are_the_recorded_points(shape: Ran) -> None:
    drawn = lines(shape.draw("motion").axes[0])
    for row in range(6):
        np.testing.assert_array_equal(drawn[f"trail {row}"], shape.trajectory.points[:, row])


def test_bodies_are_drawn_at_start_and_at_the_end_with_their_corners_where_the_chassis_has_them(shape: Ran) -> None:
    axes = shape.draw("motion").axes[0]
    quads = [
        np.array([path.vertices[:4] for path in c.get_paths()])
        for c in axes.collections
        if isinstance(c, PolyCollection) and len(c.get_paths()[0].vertices) == 5
    ]
    outline = shape.experiment.robot.chassis.outline
    for corners, row in zip(quads, (0, -1), strict=True):
        np.testing.assert_allclose(corners, placed(outline, shape.trajectory.poses[row]), atol=1e-12)


def test_a_placed_outline_is_turned_counter_clockwise_and_then_moved() -> None:
    np.testing.assert_allclose(placed(np.array([[1.0, 0.0]]), np.array([[2.0, 3.0, np.pi / 2]])), [[[2.0, 4.0]]])


def test_y_points_up_and_a_metre_is_as_long_in_x_as_in_y(shape: Ran, maneuver: Ran) -> None:
    for run in (shape, maneuver):
        axes = run.draw("motion").axes[0]
        assert axes.get_ylim()[0] < axes.get_ylim()[1]
        low, high = axes.transData.transform([[0.0, 0.0], [1.0, 1.0]])
        assert high[0] - low[0] == pytest.approx(high[1] - low[1], rel=1e-6)


def test_limits_show_the_whole_floor_and_every_robot_and_ignore_what_is_not_finite() -> None:
    arena = Arena((-1.6, 1.6), (-1.0, 1.0))
    x0, x1, y0, y1 = limits(arena, np.array([[5.0, 0.0, 0.0], [np.nan, 9.0, 0.0]]))
    assert x0 < -1.6
    assert x1 > 5.0
    assert y0 < -1.0
    assert 1.0 < y1 < 9.0


def test_a_maneuver_is_shown_at_its_start_and_at_the_end_of_each_phase(maneuver: Ran) -> None:
    rows = snapshot_rows(maneuver.experiment, maneuver.trajectory, maneuver.metrics)
    assert maneuver.trajectory.t[rows].tolist() == [0.0, 50.0, 90.0, 120.0]
    figure = maneuver.draw("motion")
    assert {"0 s", "50 s", "90 s", "120 s"} <= set(texts(figure))
    edges = [c for c in figure.axes[0].collections if type(c) is LineCollection]
    sensed = [
        np.array(c.get_segments()) for c in edges if len(c.get_segments()) == len(maneuver.experiment.graph.edges)
    ]
    for row, segments in zip(rows, sensed, strict=True):
        np.testing.assert_allclose(segments, maneuver.trajectory.points[row][maneuver.experiment.graph.edges])


@pytest.mark.parametrize("name", ["shape", "maneuver"])
def test_the_panels_of_the_overview_are_drawn_by_themselves(name: str, request: pytest.FixtureRequest) -> None:
    ran: Ran = request.getfixturevalue(name)
    arguments = ran.experiment, ran.trajectory, ran.metrics
    whole, floor, errors = (draw(*arguments, figure) for figure in ("motion", "floor", "errors"))
    below = [axes.get_ylabel() for axes in whole.axes[1:]]
    assert [axes.get_ylabel() for axes in floor.axes] == [whole.axes[0].get_ylabel()]
    assert [axes.get_ylabel() for axes in errors.axes] == below
    assert set(texts(floor)) | set(texts(errors)) == set(texts(whole))
    assert floor.get_figheight() + errors.get_figheight() < whole.get_figheight() + 0.5


def test_robots_are_shown_at_the_times_that_are_asked_for(shape: Ran) -> None:
    figure = draw(shape.experiment, shape.trajectory, shape.metrics, "motion", (30.0, 0.0, 7.02))
    times = ("0 s", "7 s", "30 s")
    assert set(times) <= set(texts(figure))
    polygons = [c for c in figure.axes[0].collections if isinstance(c, PolyCollection)]
    bodies = [c.get_paths() for c in polygons if c.get_zorder() == 4]  # below are arrows on edges, above noses
    for row, drawn in zip(rows_at(shape.trajectory, (0.0, 7.02, 30.0)), bodies, strict=True):
        assert abs(shape.trajectory.t[row] - round(shape.trajectory.t[row])) < 0.03
        expected = placed(shape.experiment.fleet.outlines, shape.trajectory.poses[row])
        np.testing.assert_allclose([path.vertices[:4] for path in drawn], expected)
    assert {"start", "later"} <= set(texts(figure))
    assert "start" not in texts(draw(shape.experiment, shape.trajectory, shape.metrics, "motion", (5.0,)))


def test_a_time_stands_at_a_robot_that_is_elsewhere_at_the_other_times(shape: Ran) -> None:
    """Agent 1 is the highest and never moves."""
    figure = draw(shape.experiment, shape.trajectory, shape.metrics, "motion", (0.0, 60.0))
    for text in figure.axes[0].texts:
        if text.get_text().endswith(" s"):
            state = shape.trajectory.points[0 if text.get_text() == "0 s" else -1]
            assert np.linalg.norm(state - text.get_position(), axis=1).argmin() > 1


@pytest.mark.parametrize("time", [-0.1, 60.5, np.nan])
def test_a_time_that_the_run_does_not_have_is_refused(shape: Ran, time: float) -> None:
    with pytest.raises(InputError, match="at: expected seconds of the run, 0 to 60, got"):
        draw(shape.experiment, shape.trajectory, shape.metrics, "motion", (1.0, time))


def test_phase_boundaries_are_marked_on_both_error_panels(maneuver: Ran) -> None:
    for axes in maneuver.draw("motion").axes[1:]:
        vertical = [line.get_xdata()[0] for line in axes.lines if len(set(np.asarray(line.get_xdata()).tolist())) == 1]
        assert {50.0, 90.0} <= {float(x) for x in vertical}


def test_error_lines_are_the_errors_of_the_run_named_as_in_the_paper(shape: Ran) -> None:
    figure = shape.draw("motion")
    each, total = lines(figure.axes[1]), lines(figure.axes[2])
    np.testing.assert_array_equal(total["projected points"][:, 1], shape.metrics.error_sum)
    np.testing.assert_array_equal(total["axle centres"][:, 1], shape.metrics.axle_error_sum)
    for column, name in enumerate(shape.experiment.angles.names):
        drawn = each[written(name)][:, 1]
        kept = np.isfinite(drawn)
        np.testing.assert_array_equal(drawn[kept], shape.metrics.angle_errors[kept, column])
    assert written("alpha(3;2,4)") in texts(figure)


def test_no_error_line_crosses_from_pi_to_minus_pi() -> None:
    broken = unwrapped(np.array([3.0, 3.1, -3.1, -3.0]))
    assert np.isnan(broken[2])
    np.testing.assert_array_equal(broken[[0, 1, 3]], [3.0, 3.1, -3.0])


def test_arrows_point_from_the_observer_to_the_observed(shape: Ran) -> None:
    left = shape.draw("graph").axes[0]
    ends = [patch._posA_posB for patch in left.patches if isinstance(patch, FancyArrowPatch)]
    positions = shape.experiment.target.positions
    np.testing.assert_array_equal(ends, positions[shape.experiment.graph.edges])


def test_the_edge_between_agents_1_and_4_is_the_only_dashed_one(shape: Ran) -> None:
    right = shape.draw("graph").axes[1]
    solid, dashed = (c for c in right.collections if type(c) is LineCollection)
    assert len(solid.get_segments()) == 9
    assert [sorted(map(tuple, s)) for s in dashed.get_segments()] == [[(0.0, 0.0), (1.0, 1.0)]]
    assert dashed.get_linestyles()[0][1] is not None


def test_predicted_decay_starts_at_the_measured_distance_and_ends_at_the_slowest_rate_upstream(shape: Ran) -> None:
    drawn = lines(shape.draw("decay").axes[0])
    for row in shape.experiment.graph.followers.tolist():
        measured, predicted = drawn[f"measured {row}"], drawn[f"predicted {row}"]
        np.testing.assert_allclose(predicted[0], measured[0], atol=1e-12)
        late = slice(700, 900)
        slope = np.polyfit(predicted[late, 0], np.log(predicted[late, 1]), 1)[0]
        assert slope == pytest.approx(-0.5, rel=0.05)


@pytest.mark.parametrize("scenario", ["shape", "scale-only", "orientation-only"])
def test_without_limits_the_dashed_lines_lie_on_the_measured_ones(scenario: str) -> None:
    run = ran(scenario, "plant.name=single_integrator")
    for axes in run.draw("decay").axes:
        drawn = lines(axes)
        for row in run.experiment.graph.followers.tolist():
            np.testing.assert_allclose(drawn[f"measured {row}"][:, 1], drawn[f"predicted {row}"][:, 1], atol=1e-6)


def test_followers_that_wait_have_no_exact_solution_drawn() -> None:
    run = ran("sequential", "plant.name=single_integrator", duration=5.0)
    assert not any(label.startswith("predicted") for label in lines(run.draw("decay").axes[0]))


def test_places_move_with_the_reference_velocity_and_end_where_the_pair_puts_them(maneuver: Ran) -> None:
    moving = places(maneuver.experiment, maneuver.trajectory, 1)
    np.testing.assert_allclose(moving[-1] - moving[0], np.broadcast_to([0.05 * 40.0, 0.0], (6, 2)), atol=1e-9)
    row = maneuver.metrics.phases[1].row
    np.testing.assert_allclose(moving[-1, :2], maneuver.trajectory.points[row, :2], atol=1e-12)


def test_each_phase_has_its_own_decay_panel(maneuver: Ran) -> None:
    assert len(maneuver.draw("decay").axes) == 3


def test_separation_shows_the_closest_pair_and_both_limits(shape: Ran) -> None:
    axes = shape.draw("separation").axes[0]
    drawn = lines(axes)
    np.testing.assert_array_equal(drawn["closest pair"][:, 1], shape.metrics.separation.distance)
    heights = {float(np.asarray(line.get_ydata())[0]) for line in axes.lines}
    assert {COLLISION_DISTANCE, shape.experiment.robot.chassis.width} <= heights
    assert axes.get_ylim()[0] == 0.0


def test_a_run_cut_short_by_a_state_that_is_not_finite_is_drawn_up_to_it(shape: Ran) -> None:
    t = shape.trajectory.until(200)
    poses, points = t.poses.copy(), t.points.copy()
    poses[-1, 2], points[-1, 2] = np.nan, np.nan
    cut = replace(t, poses=poses, points=points)
    run = Ran(shape.experiment, cut, measure(shape.experiment, cut))
    assert snapshot_rows(run.experiment, cut, run.metrics) == [0, 198]
    for name in FIGURES:
        with print_style():
            assert render(run.draw(name), "png")


@pytest.mark.parametrize("plant", ["single_integrator", "unicycle", "pymunk"])
def test_every_figure_that_makes_sense_is_drawn_for_every_plant(plant: str) -> None:
    run = ran("shape", f"plant.name={plant}", duration=3.0)
    names = names_for(run.experiment)
    assert ("separation" in names) == (plant != "single_integrator")
    for name in names:
        figure = run.draw(name)
        assert figure.get_figwidth() == COLUMN
        with print_style():
            assert render(figure, "png").startswith(b"\x89PNG")


def test_fifty_robots_are_drawn() -> None:
    run = ran("random-50", "plant.name=saturated", duration=2.0)
    for name in names_for(run.experiment):
        with print_style():
            assert render(run.draw(name), "png")


def test_a_law_without_decay_rates_gets_no_decay_figure() -> None:
    experiment = open_experiment("shape", ("law.name=displacement",))
    assert "decay" not in names_for(experiment)


@pytest.mark.parametrize("form", FORMATS)
def test_two_drawings_of_one_run_are_the_same_bytes(shape: Ran, form: str) -> None:
    with print_style():
        assert render(shape.draw("graph"), form) == render(shape.draw("graph"), form)


@pytest.mark.parametrize("form", FORMATS)
def test_files_carry_neither_dates_nor_versions(shape: Ran, form: str) -> None:
    with print_style():
        content = render(shape.draw("separation"), form)
    for mark in (b"CreationDate", b"<dc:date>", b"Matplotlib v", b"matplotlib.org", b"Software"):
        assert mark not in content


def test_labels_lie_inside_the_sheet(shape: Ran, maneuver: Ran) -> None:
    for run in (shape, maneuver):
        for name in FIGURES:
            figure = run.draw(name)
            with print_style():
                figure.canvas.draw()
                sheet = figure.bbox
                for axes in figure.axes:
                    box = axes.get_tightbbox()
                    assert box.x0 >= sheet.x0 - 1.0
                    assert box.x1 <= sheet.x1 + 1.0
                    assert box.y0 >= sheet.y0 - 1.0
                    assert box.y1 <= sheet.y1 + 1.0


def test_labels_do_not_overlap_each_other_nor_what_they_name(shape: Ran, maneuver: Ran) -> None:
    for run, at in ((shape, ()), (maneuver, ()), (shape, (0.0, 3.0, 6.0, 10.0, 60.0))):
        figure = draw(run.experiment, run.trajectory, run.metrics, "motion", at)
        axes = figure.axes[0]
        with print_style():
            figure.canvas.draw()
            boxes = [text.get_window_extent().shrunk(1.0, 0.75) for text in axes.texts]  # figures have no descent
        rows = rows_at(run.trajectory, at or (0.0, run.trajectory.t[-1]))
        robots = axes.transData.transform(run.trajectory.points[rows].reshape(-1, 2))
        for i, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[:i])
            assert not any(box.contains(*robot) for robot in robots)


def test_a_label_that_is_led_back_does_not_cross_what_is_solid() -> None:
    figure = Figure(figsize=(2.0, 2.0))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    crowd = 0.5 + 0.2 * np.random.default_rng(0).uniform(-1.0, 1.0, (4000, 2))  # no room near the middle
    wall = np.stack([np.linspace(0.4, 0.6, 50), np.full(50, 0.62)], axis=1)
    labels = Labels(axes, crowd, wall)
    labels.put(np.array([0.5, 0.5]), "7", 8.0)
    (line,) = axes.lines
    x, y = np.asarray(line.get_xydata()).T
    at_wall = np.interp(0.62, np.sort(y), x[np.argsort(y)])
    assert y.max() < 0.62 or not 0.39 < at_wall < 0.61
    assert axes.texts[0].get_text() == "7"


def test_a_run_that_leaves_every_scale_has_all_its_figures() -> None:
    slow = ("plant.name=single_integrator", "plant.control_period_s=100", "safety.filter=none")
    lost = ran("shape", *slow, duration=10_000.0)
    assert np.abs(lost.trajectory.points[np.isfinite(lost.trajectory.points)]).max() > 1e160
    for name in names_for(lost.experiment):
        for axes in draw(lost.experiment, lost.trajectory, lost.metrics, name).axes:
            assert np.isfinite([*axes.get_xlim(), *axes.get_ylim()]).all()
