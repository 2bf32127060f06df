"""A sweep from its study to its folder: rows as they come, then what they say together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Any

from scenarios.definition.experiment import build
from scenarios.errors import InputError
from scenarios.simulation.compiling import compile_for
from scenarios.studies.sweep import folder as place
from scenarios.studies.sweep.row import run_batch
from scenarios.studies.sweep.study import Batch, Combination, Study
from scenarios.studies.sweep.summary import QUANTILES, Summary, Tallies
from scenarios.work.protocol import Spread

TELLING = 60.0
"""Seconds after which the summary of the rows so far is written again."""


@dataclass(frozen=True)
class Swept:
    """A finished sweep.

    Attributes:
        summaries: of each combination.
        folder: that they were written to.
        kept: runs whose rows an earlier sweep had left there.
    """

    summaries: list[Summary]
    folder: Path
    kept: int


def sweep(
    study: Study, out: Path | None, run_all: Spread, on_progress: Callable[[int, int], None], restart: bool = False
) -> Swept:
    """Run every seed and write one row per run, in order, each as soon as it is there.

    Where the folder holds rows of the same study, it goes on behind them; all files then are, bit for bit, those of a
    sweep that nothing stopped.

    Args:
        study: what to run.
        out: folder of the files; None for the default.
        run_all: what makes the runs. The rows do not depend on it.
        on_progress: called with the number of runs done and of all runs.
        restart: whether to begin anew where rows are there.

    Raises:
        InputError: the folder cannot be written, holds another study, or another sweep writes there.
    """
    folder = out or study.default_folder
    try:
        with place.claimed(folder), closing(Tallies(study.seeds.count)) as tallies:
            kept = done = place.begin(folder, study, restart)
            with closing(place.read_rows(folder)) as rows_there:
                tallies.add(rows_there)
            on_progress(done, study.runs)
            if done < study.runs:
                _compile(study)
                told = monotonic()
                for batch, rows in zip(study.batches(done), run_all(run_batch, study.batches(done)), strict=True):
                    place.append(folder, batch, rows)
                    tallies.add(rows)
                    done += len(rows)
                    on_progress(done, study.runs)
                    if monotonic() - told > TELLING:
                        place.write_summary(folder, _summary_file(study, tallies.summaries()))
                        told = monotonic()
                place.finish(folder)
            summaries = tallies.summaries()
            place.write_summary(folder, _summary_file(study, summaries))
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written: {error.strerror or error}") from error
    return Swept(summaries, folder, kept)


def _compile(study: Study) -> None:
    """Compile what the runs need before they spread over processes: each would do it again."""
    kinds = {(each.file.scenario.plant.name, each.safety): each for each in study.combinations}
    for each in kinds.values():
        short = replace(each, duration=each.file.scenario.plant.control_period_s)
        compile_for(build(each.file, short.duration), partial(run_batch, Batch(short, (study.seeds.first,))))


def _summary_file(study: Study, summaries: Sequence[Summary]) -> dict[str, Any]:
    """The content of ``summary.json``, of the combinations that have rows."""
    content = {"changes": list(study.changes), "quantiles_at": QUANTILES}
    told = [
        {
            "changes": combination.changes,
            "scenario_sha256": combination.file.sha256,
            **_with_commands(study, combination, summary),
        }
        for combination, summary in zip(study.combinations, summaries, strict=False)
    ]
    if study.variations:
        varied = {variation.key: variation.values for variation in study.variations}
        return {**content, "varied": varied, "combinations": told}
    return {**told[0], **content}


def _with_commands(study: Study, combination: Combination, summary: Summary) -> dict[str, Any]:
    """A summary, and for each cause of a miss what shows its first run."""
    content = asdict(summary)
    for misses in content["causes"]:
        misses["command"] = study.command(combination, misses["seeds"][0])
    return content
