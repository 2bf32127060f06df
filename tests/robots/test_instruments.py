"""What robots measure is what their law declares, with that kind's noise and no other, drawn in a fixed order."""

import numpy as np
import pytest

from robots import Imperfections, Instruments
from robots.instruments import KINDS, Disturbance

EDGES = np.array([[1, 0], [2, 0], [2, 1], [3, 1], [3, 2]])
CORNERS = np.array([[1, 2], [3, 4]])
RNG = np.random.default_rng(0)
POINTS = RNG.normal(size=(7, 4, 2))
HEADINGS = np.exp(1j * RNG.uniform(-3.0, 3.0, (7, 4, 1))).view(np.float64)


def instruments(*kinds: str, **imperfections: float) -> Instruments:
    return Instruments(EDGES, CORNERS, kinds, Imperfections(**imperfections))


def test_each_kind_is_what_it_says() -> None:
    all_kinds = instruments(*KINDS)
    relative, bearing, distance, angle, ratio = all_kinds.deliver(all_kinds.measure(POINTS, HEADINGS), None)
    np.testing.assert_allclose(bearing * distance[..., None], relative, atol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(POINTS[:, 1] - POINTS[:, 0], axis=-1), distance[:, 0])
    np.testing.assert_allclose(ratio * distance[:, [1, 3]], distance[:, [2, 4]])
    turned = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    first, second = bearing[:, [1, 3]], bearing[:, [2, 4]]
    cross = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    np.testing.assert_allclose(turned, np.stack([(first * second).sum(-1), cross], axis=-1), atol=1e-14)
    assert ((angle >= 0.0) & (angle < 2.0 * np.pi)).all()


@pytest.mark.parametrize(
    ("own", "kind"),
    [("bearing", "bearing"), ("distance", "distance"), ("angle", "angle"), ("ratio", "ratio")],
)
def test_the_noise_of_one_kind_disturbs_that_kind_alone_by_its_deviation(own: str, kind: str) -> None:
    noisy = instruments(*KINDS[1:], **{own: 0.01})
    relative = noisy.measure(POINTS, HEADINGS)
    clean = noisy.deliver(relative, None)
    rng = np.random.default_rng(1)
    draws = [noisy.deliver(relative, noisy.draw(rng)) for _ in range(200)]
    for place, name in enumerate(KINDS[1:]):
        errors = np.array([draw[place] for draw in draws]) - clean[place]
        if name == "ratio":
            errors = errors / clean[place]
        if name != kind:
            assert not errors.any()
        else:
            size = np.linalg.norm(errors, axis=-1) if name == "bearing" else errors
            assert np.sqrt((size**2).mean()) == pytest.approx(0.01, rel=0.1)


def test_an_edge_is_lost_as_often_as_told_and_a_robot_that_drops_out_loses_all_its_edges() -> None:
    rng = np.random.default_rng(0)
    losing, dropping = instruments(KINDS[0], edge_loss=0.3), instruments(KINDS[0], dropout=0.3)
    lost = np.array([losing.draw(rng).lost for _ in range(4000)])  # type: ignore[union-attr]
    np.testing.assert_allclose(lost.mean(axis=0), 0.3, atol=0.03)
    dropped = np.array([dropping.draw(rng).lost for _ in range(4000)])  # type: ignore[union-attr]
    assert (dropped[:, 1] == dropped[:, 2]).all()
    assert (dropped[:, 3] == dropped[:, 4]).all()
    np.testing.assert_allclose(dropped.mean(axis=0), 0.3, atol=0.03)


def test_a_lost_edge_is_not_a_number_in_every_kind_that_it_takes_part_in() -> None:
    every = instruments(*KINDS)
    lost = np.array([False, True, False, False, False])
    delivered = every.deliver(every.measure(POINTS, HEADINGS), Disturbance(lost=lost))
    for kind, array in zip(KINDS, delivered, strict=True):
        gone = np.isnan(array).reshape(len(POINTS), len(array[0]), -1).all(axis=(0, 2))
        assert gone.tolist() == ([True, False] if kind in ("angle", "ratio") else lost.tolist())
        assert np.isnan(array).any(axis=0).reshape(len(array[0]), -1).any(axis=1).tolist() == gone.tolist()


def test_a_batch_of_draws_is_the_draws_of_its_runs() -> None:
    noisy = instruments(*KINDS, position=0.1, bearing=0.1, distance=0.1, angle=0.1, ratio=0.1, edge_loss=0.5)
    relative = noisy.measure(POINTS[:2], HEADINGS[:2])
    draws = [noisy.draw(np.random.default_rng(seed)) for seed in (3, 4)]
    together = noisy.deliver(relative, Disturbance.stack([d for d in draws if d is not None], (2,)))
    for run, draw in enumerate(draws):
        for whole, one in zip(together, noisy.deliver(relative[run], draw), strict=True):
            np.testing.assert_array_equal(whole[run], one)


def test_perfect_instruments_draw_nothing() -> None:
    rng = np.random.default_rng(0)
    assert instruments(*KINDS).draw(rng) is None
    assert rng.random() == np.random.default_rng(0).random()


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(ValueError, match=r"measures must be among relative position, .*, got 'smell'"):
        instruments("smell")
