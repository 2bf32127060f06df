"""Figures of many robots: labels that cover nothing, and what hundreds of angles have in common."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from scenarios.definition.experiment import open_experiment
from scenarios.figures import FIGURES, labels
from scenarios.figures.labels import Labels
from scenarios.figures.style import print_style
from scenarios.measures.metrics import measure
from scenarios.simulation.loop import simulate


def clearances(occupied: np.ndarray) -> np.ndarray:
    """How empty 400 places are for a label of three figures, points of type."""
    axes = Figure(figsize=(3.0, 3.0)).add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(-1.0, 1.0), ylim=(-1.0, 1.0))
    places = np.random.default_rng(1).uniform(-80.0, 80.0, (400, 2))
    return Labels(axes, occupied)._clearance(places, 3.4, 4.5)


def test_the_places_found_free_in_a_crowd_are_those_that_looking_at_all_of_it_finds(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    occupied = np.random.default_rng(0).uniform(-1.0, 1.0, (800, 2))
    exact = clearances(occupied)
    monkeypatch.setattr(labels, "_SEARCHED", 0)
    found = clearances(occupied)
    assert (found >= exact - 1e-9).all()
    assert (found**2 - np.maximum(exact, 0.0) ** 2).max() <= (3.4 / 4.0) ** 2  # half of what lies between two places


def test_of_hundreds_of_angles_the_median_and_the_largest_error_are_drawn() -> None:
    experiment = open_experiment("random-50", ("plant.name=saturated",), 2.0)
    trajectory = simulate(experiment, 0)
    metrics = measure(experiment, trajectory)
    with print_style():
        figure = FIGURES["motion"](experiment, trajectory, metrics)
    [axes] = [axes for axes in figure.axes if axes.get_ylabel() == "|angle error| (rad)"]
    lines = {line.get_label(): line.get_ydata() for line in axes.lines}
    errors = np.abs(metrics.angle_errors)
    np.testing.assert_allclose(lines["median"], np.median(errors, axis=1))
    np.testing.assert_allclose(lines["largest"], errors.max(axis=1))
    assert any("96 angles: median" in text.get_text() for text in figure.texts)
