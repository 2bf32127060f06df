"""The folder of a sweep: one writer at a time, one study, rows that a killed process leaves whole for the next one.

A row is a function of the study, so a row that is there need not be made again, and one that is damaged can be: of what
a killed sweep left, the longest beginning that holds rows of this study is kept, batch by batch, and the rest dropped.
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from scenarios.errors import InputError
from scenarios.storage.files import write_whole
from scenarios.storage.scratch import beside
from scenarios.studies.sweep.row import Row, columns
from scenarios.studies.sweep.study import Batch, Study

ROWS, PARTIAL = "rows.csv", "rows.partial.csv"
"""The rows, which are partial until the last run is done."""

SUMMARY, SUMMARY_SO_FAR = "summary.json", "summary.partial.json"
"""What the rows say together, and what those do that are there while others are still to come."""

STUDY = "study.json"
"""What the rows are of."""

LONGEST_LINE = 1 << 16
"""Bytes of a row; what is longer is none."""

LONGEST_SHOWN = 60
"""Characters of a value in a refusal."""


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Hold a folder for one writer; it is made where it is missing. The hold ends with its process, however that ends.

    Raises:
        InputError: another process holds it, or it cannot be one.
    """
    place = Path(os.path.realpath(folder))
    if place == place.parent:
        raise InputError(f"--out {folder}: expected a folder with a name")
    with beside(place, exclusive=True):
        place.mkdir(exist_ok=True)
        yield


def begin(folder: Path, study: Study, restart: bool) -> int:
    """Make a claimed folder ready to take rows of the study.

    Args:
        folder: of the sweep.
        study: whose rows it takes.
        restart: whether what is there of a sweep goes.

    Returns:
        The number of runs whose rows are there, in whole batches; where it is all of them, they stand in ``rows.csv``,
        else in ``rows.partial.csv``.

    Raises:
        InputError: another study is there, or files that no sweep wrote.
    """
    older = [name for name in (ROWS, PARTIAL, SUMMARY, SUMMARY_SO_FAR) if (folder / name).exists()]
    if (folder / STUDY).exists():
        if not restart:
            _require_same(folder, study)
    elif older:
        raise InputError(f"--out {folder}: holds {older[0]} without its {STUDY}, expected another folder")
    if restart:
        for name in older:
            (folder / name).unlink()
    write_whole(folder / STUDY, (json.dumps(study.manifest, indent=2) + "\n").encode())
    rows, partial = folder / ROWS, folder / PARTIAL
    if not rows.exists() and not partial.exists():
        partial.write_bytes(_header(study))
        return 0
    found = rows if rows.exists() else partial
    done, end = _kept(found, study)
    if found == rows and done == study.runs and end == rows.stat().st_size:
        return done
    (folder / SUMMARY).unlink(missing_ok=True)
    found.replace(partial)
    with partial.open("r+b") as file:
        file.truncate(end)
        if end == 0:
            file.write(_header(study))
    if done == study.runs:  # all that was missing was the name
        finish(folder)
    return done


def append(folder: Path, batch: Batch, rows: Sequence[Row]) -> None:
    """Write the rows of a batch behind the others: on their way to the disk before the next ones are waited for."""
    with (folder / PARTIAL).open("a", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(row.cells(batch.combination.values) for row in rows)


def finish(folder: Path) -> None:
    """The last row is there."""
    (folder / PARTIAL).replace(folder / ROWS)


def read_rows(folder: Path) -> Generator[Row, None, None]:
    """The rows of a sweep that are there, one at a time.

    Raises:
        ValueError, KeyError, TypeError: the file is damaged.
    """
    for cells in read_cells(folder):
        yield Row.read(cells)


def read_cells(folder: Path) -> Generator[Mapping[str, str], None, None]:
    """The same as cells by column, those of varied keys too."""
    finished = folder / ROWS
    with (finished if finished.exists() else folder / PARTIAL).open(encoding="utf-8", newline="") as file:
        yield from csv.DictReader(file)


def write_summary(folder: Path, content: Mapping[str, Any]) -> None:
    """Write what the rows say together, whole or not at all."""
    name = SUMMARY if (folder / ROWS).exists() else SUMMARY_SO_FAR
    write_whole(folder / name, (json.dumps(content, indent=2, allow_nan=False) + "\n").encode())
    if name == SUMMARY:
        (folder / SUMMARY_SO_FAR).unlink(missing_ok=True)


def _require_same(folder: Path, study: Study) -> None:
    """The study in the folder is this one."""
    ways = "--restart begins anew, another --out keeps it"
    try:
        there = json.loads((folder / STUDY).read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise InputError(f"--out {folder}: {STUDY}: cannot be read: {error}; {ways}") from error
    if not isinstance(there, dict):
        raise InputError(f"--out {folder}: {STUDY}: expected a JSON object; {ways}")
    for key, asked in study.manifest.items():
        found = there.get(key)
        if found != asked:
            was, now = _difference(found, asked)
            raise InputError(f"--out {folder}: holds another study, {key} was {was} and is now {now}; {ways}")


def _difference(found: Any, asked: Any) -> tuple[str, str]:
    """Two values that differ, or the first of their entries that do, short enough for one line."""
    if isinstance(found, dict) and isinstance(asked, dict):
        found, asked = list(found.items()), list(asked.items())
    if isinstance(found, list) and isinstance(asked, list) and len(found) == len(asked):
        found, asked = next((a, b) for a, b in zip(found, asked, strict=True) if a != b)
    return json.dumps(found)[:LONGEST_SHOWN], json.dumps(asked)[:LONGEST_SHOWN]


def _header(study: Study) -> bytes:
    return (",".join(columns([variation.key for variation in study.variations])) + "\n").encode()


def _kept(path: Path, study: Study) -> tuple[int, int]:
    """The runs in the longest beginning of a file that holds whole batches of the study: number, and end in bytes."""
    header, done = _header(study), 0
    names = header.decode().rstrip("\n").split(",")
    with path.open("rb") as file:
        if file.readline(LONGEST_LINE) != header:
            return 0, 0
        end = len(header)
        for batch in study.batches():
            size = _read_batch(file, batch, names)
            if size is None:
                break
            end += size
            done += len(batch.seeds)
    return done, end


def _read_batch(file: BinaryIO, batch: Batch, names: Sequence[str]) -> int | None:
    """The bytes of the batch's rows; None where they are not the next ones."""
    known, size = [batch.combination.file.name, batch.combination.file.scenario.plant.name], 0
    for seed in batch.seeds:
        line = file.readline(LONGEST_LINE)
        try:
            [cells] = csv.reader([line.decode("utf-8")], strict=True)
            Row.read(dict(zip(names, cells, strict=True)))
        except (ValueError, KeyError, csv.Error):
            return None
        told = [*known, str(seed), *batch.combination.values]
        if not line.endswith(b"\n") or cells[: len(told)] != told:
            return None
        size += len(line)
    return size
