"""A sweep as a frame."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from scenarios.definition.load import changed
from scenarios.interactive.frames import pandas
from scenarios.studies.sweep.seeds import Seeds, parse_seeds

if TYPE_CHECKING:
    from pandas import DataFrame

TEXTS = ("scenario", "plant", "outcome", "violations", "mean_errors_rad", "rms_errors_rad", "cause", "message")
"""Columns of a sweep that may be empty without a number missing."""


def sweep(
    scenario: str | Path,
    seeds: str | int | Iterable[int],
    changes: Sequence[str] = (),
    *,
    vary: Mapping[str, Iterable[Any]] | None = None,
    plant: str | None = None,
    safety: str | None = None,
    duration: float | None = None,
    workers: int | None = 1,
    out: str | Path | None = None,
) -> DataFrame:
    """Run a scenario with many seeds, as ``formation sweep`` does: a frame with the rows and columns of ``rows.csv``.

    Args:
        scenario: a library name or a path.
        seeds: ``"0:100"`` as with ``--seeds``, a number, or numbers such as ``range(100)``.
        changes: ``key=value`` texts, as with ``--set``.
        vary: values of each key that takes several; every combination is run with every seed.
        plant, safety: instead of the scenario's own.
        duration: seconds to run instead of the scenario's own.
        workers: processes; None for one per processor. With more than one, a script calls this under
            ``if __name__ == "__main__":``, as with all of Python's process pools.
        out: folder to keep, in which a stopped sweep goes on; None for none.

    Raises:
        InputError: the scenario cannot be used, the folder cannot be written, or pandas is missing.
    """
    from scenarios.studies.project import PROJECT
    from scenarios.studies.sweep import folder as place
    from scenarios.studies.sweep.row import columns
    from scenarios.studies.sweep.study import open_study
    from scenarios.studies.sweep.sweep import sweep as run_study
    from scenarios.studies.sweep.variations import parse_variations
    from scenarios.work.spread import spread

    frames = pandas()
    changes = changed(tuple(changes), plant, safety)
    varied = [f"{key}={','.join(map(_written, values))}" for key, values in (vary or {}).items()]
    study = open_study(str(scenario), changes, parse_variations(varied, changes), _seeds(seeds), duration, safety)
    with TemporaryDirectory() as temporary, spread(workers, None, PROJECT) as run_all:
        swept = run_study(study, Path(out or Path(temporary) / "sweep"), run_all, lambda done, total: None)
        missing = {
            name: [""] for name in columns([variation.key for variation in study.variations]) if name not in TEXTS
        }
        return frames.read_csv(
            swept.folder / place.ROWS,
            keep_default_na=False,
            na_values=missing,
            dtype=dict.fromkeys(TEXTS, str),
        )


def _seeds(seeds: str | int | Iterable[int]) -> Seeds:
    """The seeds in any of the ways in which they may be given."""
    match seeds:
        case str():
            text = seeds
        case int():
            text = str(seeds)
        case range(step=1):
            text = f"{seeds.start}:{seeds.stop}"
        case _:
            text = ",".join(map(str, seeds))
    return parse_seeds(text)


def _written(value: Any) -> str:
    """A value as it is written behind ``--vary``."""
    return str(value).lower() if isinstance(value, bool) else str(value)
