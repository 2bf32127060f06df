"""The folder of a sweep: one writer, one study, and rows that survive whatever ended the process that wrote them."""

import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from scenarios.errors import InputError
from scenarios.studies.sweep import folder as place
from scenarios.studies.sweep import row, study
from scenarios.studies.sweep import sweep as sweeping
from scenarios.studies.sweep.folder import PARTIAL, ROWS, STUDY, SUMMARY
from scenarios.studies.sweep.seeds import parse_seeds
from scenarios.studies.sweep.study import Study, open_study
from scenarios.studies.sweep.sweep import Swept, sweep
from scenarios.studies.sweep.variations import parse_variations
from scenarios.work.processes import run_all

SHORT = ("duration_s=0.2", "safety.filter=none")


def study_of(seeds: str = "0:3", changes: tuple[str, ...] = SHORT, vary: tuple[str, ...] = (), **more: Any) -> Study:
    return open_study("shape", changes, parse_variations(vary, changes), parse_seeds(seeds), **more)


def run(what: Study, out: Path, restart: bool = False) -> Swept:
    return sweep(what, out, partial(run_all, workers=1), lambda *_: None, restart)


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, dict[str, bytes]]:
    """A study whose batches hold two runs, and the files of a sweep of it that nothing stopped."""
    folder = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patch:
        for name in ("MOST_BATCHED", "MOST_WATCHED"):
            patch.setattr(study, name, 2)
        made = study_of("4,0:4", vary=("plant.name=saturated,pymunk",))
    run(made, folder)
    return made, files(folder)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], max_examples=20)
@example(cut=1.0, torn=b"")
@example(cut=1.0, torn=b"shape,sat")
@given(cut=st.floats(0.0, 1.0), torn=st.sampled_from([b"", b"shape,sat", b"\xff\x00", b'"', b"a,b\n", b"\n"]))
def test_a_sweep_goes_on_from_any_beginning_of_its_rows_and_ends_with_the_rows_of_a_whole_one(
    whole: tuple[Study, dict[str, bytes]], tmp_path_factory: pytest.TempPathFactory, cut: float, torn: bytes
) -> None:
    """Whatever stands behind the beginning: half a row, or what a disk made of it."""
    made, wanted = whole
    folder = tmp_path_factory.mktemp("cut")
    (folder / STUDY).write_bytes(wanted[STUDY])
    there = wanted[ROWS][: int(cut * len(wanted[ROWS]))]
    (folder / PARTIAL).write_bytes(there + torn)
    swept = run(made, folder)
    assert files(folder) == wanted
    kept = there.count(b"\n") - 1
    assert kept - 1 <= swept.kept <= max(kept, 0)  # whole batches, here of two runs or of one


def test_rows_that_are_all_there_are_not_made_again(
    whole: tuple[Study, dict[str, bytes]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made, wanted = whole
    for name in (STUDY, ROWS):
        (tmp_path / name).write_bytes(wanted[name])
    monkeypatch.setattr(sweeping, "run_batch", lambda batch: pytest.fail(f"made {batch} again"))
    assert run(made, tmp_path).kept == made.runs
    assert files(tmp_path) == wanted


def test_rows_of_other_runs_are_dropped_wherever_they_begin(
    whole: tuple[Study, dict[str, bytes]], tmp_path: Path
) -> None:
    made, wanted = whole
    lines = wanted[ROWS].splitlines(keepends=True)
    for at, wrong in ((0, b"a,b\n"), (3, lines[4]), (3, lines[3].replace(b"shape", b"other", 1)), (6, b"\n")):
        (tmp_path / STUDY).write_bytes(wanted[STUDY])
        (tmp_path / ROWS).write_bytes(b"".join([*lines[:at], wrong, *lines[at + 1 :]]))
        run(made, tmp_path)
        assert files(tmp_path) == wanted


def test_restart_makes_every_row_anew(whole: tuple[Study, dict[str, bytes]], tmp_path: Path) -> None:
    made, wanted = whole
    (tmp_path / STUDY).write_bytes(wanted[STUDY])
    (tmp_path / ROWS).write_bytes(wanted[ROWS].replace(b"True", b"False"))
    assert run(made, tmp_path).kept == made.runs
    assert run(made, tmp_path, restart=True).kept == 0
    assert files(tmp_path) == wanted


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (partial(study_of, "0:4"), 'seeds was "0:3" and is now "0:4"'),
        (partial(study_of, changes=(*SHORT, "robot.tyre_friction=0.7")), "changes was"),
        (partial(study_of, vary=("robot.tyre_friction=0.7",)), "varied was"),
        (partial(study_of, changes=("duration_s=0.2",)), "changes was"),
        (partial(study_of, duration=0.3), "duration_s was null and is now 0.3"),
    ],
)
def test_another_study_in_the_folder_is_refused_and_left_as_it_is(
    other: Callable[[], Study], words: str, tmp_path: Path
) -> None:
    run(study_of(), tmp_path)
    before = files(tmp_path)
    with pytest.raises(InputError, match=r"holds another study, .*--restart begins anew") as refusal:
        run(other(), tmp_path)
    assert words in str(refusal.value)
    assert files(tmp_path) == before
    run(other(), tmp_path, restart=True)
    assert files(tmp_path) != before


@pytest.mark.parametrize("key", ["versions", "sources_sha256", "scenario_sha256", "plant", "safety", "scenario"])
def test_all_that_rows_depend_on_is_compared(key: str, tmp_path: Path) -> None:
    made = study_of()
    run(made, tmp_path)
    told = json.loads((tmp_path / STUDY).read_text(encoding="utf-8"))
    assert told == made.manifest
    (tmp_path / STUDY).write_text(json.dumps(told | {key: "another"}), encoding="utf-8")
    with pytest.raises(InputError, match=f"holds another study, {key} was"):
        run(made, tmp_path)


@pytest.mark.parametrize("content", ["", "[]", "{", "[" * 100_000, "\ufeff"])
def test_a_damaged_manifest_is_refused_in_one_line(content: str, tmp_path: Path) -> None:
    run(study_of(), tmp_path)
    (tmp_path / STUDY).write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=rf"^--out .*{STUDY}: [^\n]*--restart begins anew"):
        run(study_of(), tmp_path)


@pytest.mark.parametrize("name", [ROWS, PARTIAL, SUMMARY])
@pytest.mark.parametrize("restart", [False, True])
def test_what_no_sweep_wrote_is_never_replaced(name: str, restart: bool, tmp_path: Path) -> None:
    (tmp_path / name).write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match=f"holds {name} without its study.json, expected another folder"):
        run(study_of(), tmp_path, restart)
    assert files(tmp_path) == {name: b"mine"}


@pytest.fixture
def elsewhere(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """Another process that writes into the folder until it is told otherwise."""
    code = f"""
from pathlib import Path
from scenarios.studies.sweep.folder import claimed
with claimed(Path({str(tmp_path)!r})):
    print("holds", flush=True)
    input()
"""
    with subprocess.Popen(
        [sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "holds\n"
        yield process
        process.kill()


def test_a_second_writer_is_refused_and_a_killed_one_leaves_no_lock_behind(
    elsewhere: subprocess.Popen[str], tmp_path: Path
) -> None:
    with pytest.raises(InputError, match="another process is writing it"):
        run(study_of(), tmp_path)
    assert files(tmp_path) == {}
    elsewhere.kill()
    elsewhere.wait()
    assert run(study_of(), tmp_path).kept == 0
    assert not list(tmp_path.parent.glob(".*.unfinished"))


# Runs that fail


def test_a_run_that_raises_is_a_row_and_the_others_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("MOST_BATCHED", "MOST_WATCHED"):
        monkeypatch.setattr(study, name, 2)
    simulate, runs = row.simulate, row.Runs

    def simulate_or_raise(experiment: Any, seed: Any) -> Any:
        if seed == 3 or (not isinstance(seed, int) and 3 in seed):
            raise ZeroDivisionError("0\n/\t0, \x1b[31mred")
        return simulate(experiment, seed)

    def advance_or_raise(experiment: Any, seeds: Any) -> Any:
        if 3 in seeds:
            raise ZeroDivisionError
        return runs(experiment, seeds)

    monkeypatch.setattr(row, "simulate", simulate_or_raise)
    monkeypatch.setattr(row, "Runs", advance_or_raise)
    made = study_of("0:5", vary=("plant.name=saturated,pymunk",))
    swept = run(made, tmp_path)
    found = list(place.read_cells(tmp_path))
    assert [row["outcome"] == "failed" for row in found] == [False, False, False, True, False] * 2
    assert found[3]["message"] == found[8]["message"] == "ZeroDivisionError: 0 / 0, ?[31mred"
    assert (found[3]["seed"], found[3]["plant.name"], found[3]["accepted"]) == ("3", "saturated", "")
    assert [summary.failed for summary in swept.summaries] == [(3,), (3,)]
    assert [summary.missed for summary in swept.summaries] == [(0, 1, 2, 4)] * 2
    assert run(made, tmp_path).kept == 10


def test_a_scenario_that_cannot_be_built_again_fails_all_its_runs_and_no_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    build = row.build

    def build_or_raise(file: Any, duration: float | None) -> Any:
        if file.scenario.plant.name == "unicycle":
            raise MemoryError
        return build(file, duration)

    monkeypatch.setattr(row, "build", build_or_raise)
    summaries = run(study_of("0:2", vary=("plant.name=unicycle,pymunk",)), tmp_path).summaries
    assert [summary.failed for summary in summaries] == [(0, 1), ()]
    assert summaries[0].failure == "MemoryError:"
