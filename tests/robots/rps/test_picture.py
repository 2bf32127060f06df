"""The figure of the robots: its size, its arena, and rays from the sensors to what they see."""

import matplotlib as mpl
import numpy as np
import pytest

from robots.rps import constants
from robots.rps.picture import Look, Picture

POSES = np.array([[0.0, 0.5], [0.1, -0.3], [0.4, 2.0]])
LINES = np.array([[[1.0, -1.0], [1.0, 1.0]], [[-0.5, 0.0], [0.5, 0.6]]])


@pytest.fixture
def made() -> Picture:
    mpl.use("agg")
    distances = np.full((7, 2), 0.3)
    distances[5] = -1.0
    look = Look(margin=0.1, inches=2.0, endpoints=True, rays=True)
    return Picture(lambda: POSES, lambda: np.full((3, 2), 51.0), lambda: distances, LINES, look)


def test_a_figure_shows_the_arena_with_a_margin_and_so_many_inches_a_metre(made: Picture) -> None:
    import matplotlib.pyplot as plt

    np.testing.assert_allclose(made.figure.get_size_inches(), [2.0 * 3.4, 2.0 * 2.2])
    np.testing.assert_allclose([*made.axes.get_xlim(), *made.axes.get_ylim()], [-1.7, 1.7, -1.1, 1.1])
    arena = [patch for patch in made.axes.patches if hasattr(patch, "get_width")]
    assert [(*patch.get_xy(), patch.get_width(), patch.get_height()) for patch in arena] == [(-1.6, -1.0, 3.2, 2.0)]
    shown = [line.get_xydata() for line in made.axes.lines if line.get_linewidth() == 4.0]
    np.testing.assert_allclose(shown, LINES)
    plt.close(made.figure)


def test_rays_go_from_the_sensors_to_what_they_see_and_lamps_are_lit_when_the_figure_is_drawn(made: Picture) -> None:
    import matplotlib.pyplot as plt

    assert not made.used()
    made.figure.canvas.draw()
    for robot in range(2):
        x, y, theta = POSES[:, robot]
        ends = []
        for sensor, (sx, sy, turn) in enumerate(constants.DISTANCE_SENSORS_ORIENTATION.T):
            begin = complex(x, y) + complex(sx, sy) * np.exp(1j * theta)
            end = begin + 0.3 * np.exp(1j * (theta + turn))
            ray = made._rays[robot][sensor].get_xydata() @ (1.0, 1j)
            assert ray[0] == pytest.approx(begin)
            assert np.isnan(ray[1]) if sensor == 5 else ray[1] == pytest.approx(end)
            ends.append(end)
        points = made._ends[robot].get_xydata() @ (1.0, 1j)
        np.testing.assert_allclose(np.delete(points, 5), np.delete(ends, 5))
        assert made.chassis[robot]._patches[3].get_facecolor()[:3] == pytest.approx([0.2] * 3)
    made.axes.plot([0.0], [0.0])
    assert made.used()
    plt.close(made.figure)


def test_what_is_not_to_be_shown_is_not_there() -> None:
    import matplotlib.pyplot as plt

    mpl.use("agg")
    bare = Look(arena=False, robots=False, obstacles=False)
    picture = Picture(lambda: POSES, lambda: None, lambda: np.zeros((7, 2)), LINES, bare)
    picture.figure.canvas.draw()
    assert not picture.axes.lines
    assert not picture.axes.patches
    assert not picture.chassis
    np.testing.assert_allclose(picture.figure.get_size_inches(), [2.5 * 3.3, 2.5 * 2.1])
    plt.close(picture.figure)
