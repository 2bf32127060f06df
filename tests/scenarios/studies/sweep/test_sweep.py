"""Monte Carlo: rows are runs, in order, whatever makes them, and none is lost."""

import csv
import json
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom

import scenarios.studies.sweep.row
import scenarios.studies.sweep.study
import scenarios.studies.sweep.sweep
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.load import LIBRARY
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.simulation.loop import simulate
from scenarios.simulation.trajectory import Trajectory
from scenarios.studies.sweep.folder import PARTIAL, ROWS, SUMMARY
from scenarios.studies.sweep.row import Row, run_batch
from scenarios.studies.sweep.seeds import parse_seeds
from scenarios.studies.sweep.study import MOST_WATCHED, Batch, batch_size, open_study
from scenarios.studies.sweep.summary import QUANTILES, Share, Summary, summarise
from scenarios.studies.sweep.sweep import sweep
from scenarios.studies.sweep.variations import parse_variations
from scenarios.work.processes import run_all

SHORT = ("duration_s=2",)


def nothing(done: int, total: int) -> None:
    """A progress bar that shows nothing."""


def sweep_shape(
    changes: tuple[str, ...],
    seeds: str,
    out: Path,
    workers: int = 1,
    vary: tuple[str, ...] = (),
    on_progress: Callable[[int, int], None] = nothing,
) -> list[Summary]:
    study = open_study("shape", changes, parse_variations(vary, changes), parse_seeds(seeds))
    return sweep(study, out, partial(run_all, workers=workers), on_progress).summaries


def rows_in(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("plant", ["single_integrator", "unicycle", "saturated", "pymunk"])
def test_a_row_is_what_a_run_of_its_seed_gives_bit_for_bit(plant: str, tmp_path: Path) -> None:
    changes = (*SHORT, f"plant.name={plant}", "goal.angle_error_sum_rad=2.0")
    sweep_shape(changes, "3:6", tmp_path)
    found = rows_in(tmp_path / ROWS)
    assert [int(row["seed"]) for row in found] == [3, 4, 5]
    experiment = open_experiment("shape", changes)
    for row in found:
        metrics = measure(experiment, simulate(experiment, int(row["seed"])))
        assert float(row["angle_error_sum_rad"]) == metrics.error_sum[-1]
        assert float(row["axle_angle_error_sum_rad"]) == metrics.axle_error_sum[-1]
        assert float(row["min_separation_m"]) == metrics.separation.distance.min()
        assert row["outcome"] == metrics.outcome
        assert row["accepted"] == str(metrics.verdict.accepted)
        settled = float(row["settling_time_s"]) if row["settling_time_s"] else None
        assert settled == metrics.settling_time


def test_a_row_of_noisy_sensors_has_the_mean_and_the_rms_of_every_angle(tmp_path: Path) -> None:
    changes = (*SHORT, "plant.name=saturated", "sensor.position_noise_m=0.01")
    sweep_shape(changes, "0:2", tmp_path / "noisy")
    experiment = open_experiment("shape", changes)
    for row in rows_in(tmp_path / "noisy" / ROWS):
        window = measure(experiment, simulate(experiment, int(row["seed"]))).window
        for kind, values in (("mean", window.mean[-1]), ("rms", window.rms[-1])):
            found = [float(cell) for cell in row[f"{kind}_errors_rad"].split(" ")]
            assert found == pytest.approx(values, abs=1e-9)
            assert float(row[f"{kind}_angle_error_sum_rad"]) == pytest.approx(np.abs(values).sum(), abs=1e-9)
    sweep_shape(SHORT, "0:2", tmp_path / "exact")
    for row in rows_in(tmp_path / "exact" / ROWS):
        assert not any(row[column] for column in row if column.startswith(("mean_", "rms_")))


def test_rows_of_a_goal_that_asks_for_acceptance_count_a_rejected_run_as_missed(tmp_path: Path) -> None:
    changes = ("plant.name=saturated", "safety.filter=none")
    [converged] = sweep_shape(changes, "0:2", tmp_path / "not", vary=())
    [rejected] = sweep_shape((*changes, "goal.accepted=true"), "0:2", tmp_path / "asked")
    assert (converged.converged.share, converged.missed) == (1.0, ())
    assert (rejected.converged.share, rejected.missed) == (0.0, (0, 1))
    assert [row["outcome"] for row in rows_in(tmp_path / "asked" / ROWS)] == ["rejected"] * 2


def test_rows_do_not_depend_on_the_number_of_processes(tmp_path: Path, monkeypatch) -> None:
    for name in ("MOST_BATCHED", "MOST_WATCHED"):
        monkeypatch.setattr(scenarios.studies.sweep.study, name, 2)
    for workers in (1, 2):
        plants = ("plant.name=saturated,pymunk",)
        sweep_shape(("duration_s=0.5",), "0:5", tmp_path / str(workers), workers, vary=plants)
    assert (tmp_path / "1" / ROWS).read_bytes() == (tmp_path / "2" / ROWS).read_bytes()


@pytest.mark.parametrize("plant", ["saturated", "pymunk"])
def test_rows_made_by_threads_beside_each_other_are_those_made_one_after_another(plant: str) -> None:
    """One run in one thread leaves nothing behind that another one in another thread would meet."""
    [batch] = open_study("shape", (*SHORT, "plant.name=saturated"), (), parse_seeds("0:6")).batches()
    if plant == "pymunk":
        batch = replace(batch, combination=open_study("shape", SHORT, (), parse_seeds("0")).combinations[0])
    alone = [replace(batch, seeds=(seed,)) for seed in batch.seeds]
    with ThreadPoolExecutor(3) as threads:
        assert [row for rows in threads.map(run_batch, alone) for row in rows] == run_batch(batch)


def test_a_run_that_diverges_does_not_cut_the_others_of_its_batch_short(monkeypatch: pytest.MonkeyPatch) -> None:
    [batch] = open_study("shape", (*SHORT, "plant.name=saturated"), (), parse_seeds("0:3")).batches()
    together = run_batch(batch)

    def cut_short(experiment: Experiment, seed: int | Sequence[int]) -> Trajectory:
        trajectory = simulate(experiment, seed)
        if not isinstance(seed, int):
            trajectory.poses[5, 1] = np.nan
            return trajectory.until(6)
        return trajectory

    monkeypatch.setattr(scenarios.studies.sweep.row, "simulate", cut_short)
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

    monkeypatch.setattr(scenarios.studies.sweep.study, "MOST_WATCHED", 1)
    monkeypatch.setattr(scenarios.studies.sweep.sweep, "run_batch", stopped_at_three)
    with pytest.raises(KeyboardInterrupt):
        sweep_shape(("duration_s=0.2",), "0:5", tmp_path)
    assert [int(row["seed"]) for row in rows_in(tmp_path / PARTIAL)] == [0, 1, 2]
    assert not (tmp_path / ROWS).exists()
    assert not (tmp_path / SUMMARY).exists()


def test_progress_counts_runs_and_the_summary_is_of_the_rows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("MOST_BATCHED", "MOST_WATCHED"):
        monkeypatch.setattr(scenarios.studies.sweep.study, name, 2)
    seen: list[tuple[int, int]] = []
    changes = (*SHORT, "plant.name=unicycle")
    [summary] = sweep_shape(changes, "0:5", tmp_path, on_progress=lambda *counts: seen.append(counts))
    assert seen == [(0, 5), (2, 5), (4, 5), (5, 5)]
    sums = [float(row["angle_error_sum_rad"]) for row in rows_in(tmp_path / ROWS)]
    assert summary.quantiles["angle_error_sum_rad"] == pytest.approx(np.quantile(sums, QUANTILES))
    assert summary.quantiles["settling_time_s"] is None
    assert json.loads((tmp_path / SUMMARY).read_text(encoding="utf-8"))["runs"] == 5


def test_batches_fit_in_memory_and_contact_has_none(shape: Experiment) -> None:
    assert 1 < batch_size(shape) < 20
    assert batch_size(open_experiment("shape", ("sensor.position_noise_m=0.01",))) == 1
    assert batch_size(open_experiment("fastest", ("plant.name=saturated",))) == MOST_WATCHED
    assert batch_size(open_experiment("random-50", ("plant.name=saturated", "sensor.position_noise_m=0.01"))) < 5


def test_a_folder_that_cannot_be_written_is_named_before_anything_runs(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match=r"--out .*cannot be written"):
        sweep_shape(SHORT, "0:2", tmp_path / "file")


@given(st.integers(1, 10_000).flatmap(lambda total: st.tuples(st.integers(0, total), st.just(total))))
def test_a_share_lies_in_its_interval_and_the_interval_in_0_to_1(counts: tuple[int, int]) -> None:
    share = Share.of(*counts)
    assert 0.0 <= share.low <= share.share + 1e-12
    assert share.share - 1e-12 <= share.high <= 1.0
    mirrored = Share.of(counts[1] - counts[0], counts[1])
    assert share.low == pytest.approx(1.0 - mirrored.high, abs=1e-12)


@pytest.mark.parametrize(("count", "total"), [(0, 30), (3, 30), (29, 30), (30, 30), (7, 1_000_000)])
def test_each_end_of_the_interval_is_the_share_that_makes_such_a_count_a_chance_of_one_in_forty(
    count: int, total: int
) -> None:
    """The definition of Clopper and Pearson's interval."""
    share = Share.of(count, total)
    if count:
        assert binom.sf(count - 1, total, share.low) == pytest.approx(0.025, rel=1e-9)
    if count < total:
        assert binom.cdf(count, total, share.high) == pytest.approx(0.025, rel=1e-9)


def test_shares_count_converged_and_accepted_runs() -> None:
    rows = [
        Row("shape", "pymunk", seed, outcome, accepted=accepted, min_separation_m=0.2, cause=cause, message=message)
        for seed, (outcome, accepted, cause, message) in enumerate(
            [
                ("converged", True, "", ""),
                ("converged", False, "", ""),
                ("diverged", False, "diverged", ""),
                ("failed", None, "error", "why"),
            ]
        )
    ]
    summary = summarise(rows)
    assert summary.converged.share == pytest.approx(2 / 4)
    assert summary.accepted.share == pytest.approx(1 / 4)
    assert (summary.missed, summary.failed, summary.failure) == ((2,), (3,), "why")
    assert [(misses.cause, misses.count, misses.seeds) for misses in summary.causes] == [
        ("diverged", 1, (2,)),
        ("error", 1, (3,)),
    ]
    assert summary.quantiles["min_separation_m"] == pytest.approx([0.2] * 5)
    assert summary.quantiles["settling_time_s"] is None


SUMMARY_KEYS = {
    *("runs", "converged", "accepted", "missed", "failed", "failure", "causes", "quantiles"),
    "scenario_sha256",
}

VARIED = ("plant.name=unicycle,pymunk", "robot.projection_distance_m=0.025,0.050")


def test_a_study_is_the_sweeps_of_its_combinations_one_after_another(tmp_path: Path) -> None:
    """Rows, but for the columns of the varied keys, and summaries; values stand as they were written."""
    sweep_shape(SHORT, "0:2", tmp_path / "study", vary=VARIED)
    study = rows_in(tmp_path / "study" / ROWS)
    together = json.loads((tmp_path / "study" / SUMMARY).read_text(encoding="utf-8"))["combinations"]
    assert list(study[0])[:5] == ["scenario", "plant", "seed", "plant.name", "robot.projection_distance_m"]
    for plant in ("unicycle", "pymunk"):
        for distance in ("0.025", "0.050"):
            changes = (f"plant.name={plant}", f"robot.projection_distance_m={distance}")
            folder = tmp_path / f"{plant}-{distance}"
            sweep_shape((*SHORT, *changes), "0:2", folder)
            alone = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
            found = together.pop(0)
            assert found.pop("changes") == list(changes)
            assert found == {key: alone[key] for key in found}
            assert set(found) == SUMMARY_KEYS
            for row in rows_in(folder / ROWS):
                varied = study.pop(0)
                assert (varied.pop("plant.name"), varied.pop("robot.projection_distance_m")) == (plant, distance)
                assert varied == row
    assert together == study == []


def test_every_combination_is_proved_usable_before_any_runs(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"robot.projection_distance_m: expected .* got -1"):
        sweep_shape(SHORT, "0:2", tmp_path / "out", vary=("robot.projection_distance_m=0.025,-1",))
    assert not (tmp_path / "out").exists()


def test_a_change_of_the_scenario_file_in_mid_sweep_changes_no_row(tmp_path: Path) -> None:
    own = tmp_path / "mine.toml"
    own.write_text((LIBRARY / "shape.toml").read_text(encoding="utf-8"), encoding="utf-8")
    study = open_study(str(own), SHORT, (), parse_seeds("0:3"))
    sweep(study, tmp_path / "out", partial(run_all, workers=1), lambda *_: own.unlink(missing_ok=True))
    sweep_shape(SHORT, "0:3", tmp_path / "same")
    without_name = [list(row.values())[1:] for row in rows_in(tmp_path / "out" / ROWS)]
    assert without_name == [list(row.values())[1:] for row in rows_in(tmp_path / "same" / ROWS)]
