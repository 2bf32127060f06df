"""Monte Carlo: rows are runs, in order, whatever makes them, and none is lost."""

import csv
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import scenarios.sweep
from scenarios.errors import InputError
from scenarios.experiment import Experiment, open_experiment
from scenarios.metrics import measure
from scenarios.simulation import simulate
from scenarios.sweep import (
    MOST_BATCHED,
    PARTIAL,
    QUANTILES,
    ROWS,
    SUMMARY,
    Batch,
    Row,
    Share,
    batch_size,
    parse_seeds,
    run_batch,
    summarise,
    sweep,
)
from scenarios.trajectory import Trajectory

SHORT = ("duration_s=2",)


def nothing(done: int, total: int) -> None:
    """A progress bar that shows nothing."""


def rows_in(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("plant", ["single_integrator", "unicycle", "saturated", "pymunk"])
def test_a_row_is_what_a_run_of_its_seed_gives(plant: str, tmp_path: Path) -> None:
    changes = (*SHORT, f"plant.name={plant}", "goal.angle_error_sum_rad=2.0")
    sweep("shape", changes, range(3, 6), tmp_path, 1, nothing)
    found = rows_in(tmp_path / ROWS)
    assert [int(row["seed"]) for row in found] == [3, 4, 5]
    experiment = open_experiment("shape", changes)
    for row in found:
        metrics = measure(experiment, simulate(experiment, int(row["seed"])))
        assert float(row["angle_error_sum_rad"]) == pytest.approx(metrics.error_sum[-1], abs=1e-9)
        assert float(row["min_separation_m"]) == pytest.approx(metrics.separation.distance.min(), abs=1e-9)
        assert row["outcome"] == metrics.outcome
        assert row["accepted"] == str(metrics.verdict.accepted)
        settled = float(row["settling_time_s"]) if row["settling_time_s"] else None
        assert settled == pytest.approx(metrics.settling_time, abs=0.05)


@pytest.mark.parametrize("plant", ["saturated", "pymunk"])
def test_rows_do_not_depend_on_the_number_of_processes(plant: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(scenarios.sweep, "MOST_BATCHED", 2)
    changes = ("duration_s=0.5", f"plant.name={plant}")
    for workers in (1, 2):
        sweep("shape", changes, range(5), tmp_path / str(workers), workers, nothing)
    assert (tmp_path / "1" / ROWS).read_bytes() == (tmp_path / "2" / ROWS).read_bytes()


def test_a_run_that_diverges_does_not_cut_the_others_of_its_batch_short(monkeypatch: pytest.MonkeyPatch) -> None:
    batch = Batch("shape", (*SHORT, "plant.name=saturated"), (0, 1, 2))
    together = run_batch(batch)

    def cut_short(experiment: Experiment, seed: int | Sequence[int]) -> Trajectory:
        trajectory = simulate(experiment, seed)
        if not isinstance(seed, int):
            trajectory.poses[5, 1] = np.nan
            return trajectory.until(6)
        return trajectory

    monkeypatch.setattr(scenarios.sweep, "simulate", cut_short)
    for a, b in zip(run_batch(batch), together, strict=True):
        assert (a.seed, a.outcome, a.settling_time_s) == (b.seed, b.outcome, b.settling_time_s)
        assert a.angle_error_sum_rad == pytest.approx(b.angle_error_sum_rad, abs=1e-12)


def test_a_sweep_that_is_stopped_keeps_every_finished_row_and_does_not_look_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped_at_three(batch: Batch) -> list[Row]:
        [seed] = batch.seeds
        # On the disk before the next run begins: a kill loses none of them.
        assert [int(row["seed"]) for row in rows_in(tmp_path / PARTIAL)] == list(range(seed))
        if seed == 3:
            raise KeyboardInterrupt
        return run_batch(batch)

    monkeypatch.setattr(scenarios.sweep, "run_batch", stopped_at_three)
    with pytest.raises(KeyboardInterrupt):
        sweep("shape", ("duration_s=0.2",), range(5), tmp_path, 1, nothing)
    assert [int(row["seed"]) for row in rows_in(tmp_path / PARTIAL)] == [0, 1, 2]
    assert not (tmp_path / ROWS).exists()
    assert not (tmp_path / SUMMARY).exists()


def test_progress_counts_runs_and_the_summary_is_of_the_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scenarios.sweep, "MOST_BATCHED", 2)
    seen: list[tuple[int, int]] = []
    changes = (*SHORT, "plant.name=unicycle")
    summary, folder = sweep("shape", changes, range(5), tmp_path, 1, lambda *counts: seen.append(counts))
    assert seen == [(2, 5), (4, 5), (5, 5)]
    sums = [float(row["angle_error_sum_rad"]) for row in rows_in(folder / ROWS)]
    assert summary.quantiles["angle_error_sum_rad"] == pytest.approx(np.quantile(sums, QUANTILES))
    assert summary.quantiles["settling_time_s"] is None
    assert json.loads((folder / SUMMARY).read_text(encoding="utf-8"))["runs"] == 5


def test_batches_fit_in_memory_and_contact_has_none(shape: Experiment) -> None:
    assert batch_size(shape) == 1
    assert batch_size(open_experiment("fastest", ("plant.name=saturated",))) == MOST_BATCHED
    assert batch_size(open_experiment("random-50", ("plant.name=saturated",))) < 5


@pytest.mark.parametrize("text", ["3", "3:3", "4:3", "-1:3", "a:b", "1:2:3", ""])
def test_seeds_that_are_no_range_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="--seeds"):
        parse_seeds(text)


def test_a_folder_that_cannot_be_written_is_named_before_anything_runs(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match=r"--out .*cannot be written"):
        sweep("shape", SHORT, range(2), tmp_path / "file", 1, nothing)


@given(st.integers(1, 10_000).flatmap(lambda total: st.tuples(st.integers(0, total), st.just(total))))
def test_a_share_lies_in_its_interval_and_the_interval_in_0_to_1(counts: tuple[int, int]) -> None:
    share = Share.of(*counts)
    assert 0.0 <= share.low <= share.share + 1e-12
    assert share.share - 1e-12 <= share.high <= 1.0
    mirrored = Share.of(counts[1] - counts[0], counts[1])
    assert share.low == pytest.approx(1.0 - mirrored.high, abs=1e-12)


@pytest.mark.slow
def test_the_interval_covers_the_true_share_as_often_as_it_says() -> None:
    counts = np.random.default_rng(1).binomial(50, 0.9, 2000)
    covered = [Share.of(int(count), 50).low <= 0.9 <= Share.of(int(count), 50).high for count in counts]
    assert np.mean(covered) == pytest.approx(0.95, abs=0.03)


def test_shares_count_converged_and_accepted_runs() -> None:
    rows = [
        Row("shape", "pymunk", seed, outcome, 0.1, 0.1, None, 0.2, accepted, "")
        for seed, (outcome, accepted) in enumerate([("converged", True), ("converged", False), ("diverged", False)])
    ]
    summary = summarise(rows)
    assert summary.converged.share == pytest.approx(2 / 3)
    assert summary.accepted.share == pytest.approx(1 / 3)
