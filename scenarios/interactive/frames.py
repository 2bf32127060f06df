"""Frames, where their package is installed."""

from __future__ import annotations

from typing import Any

from scenarios.documents import Sheet
from scenarios.errors import InputError


def pandas() -> Any:
    """The package, loaded when the first frame is asked for.

    Raises:
        InputError: it is missing.
    """
    try:
        import pandas as package
    except ImportError as error:
        raise InputError(
            f"tables need the package pandas, the extra 'notebook' of angle-formation ({error})"
        ) from error
    return package


def parquet(sheet: Sheet) -> bytes:
    """A sheet as a Parquet file.

    Raises:
        InputError: pandas is missing.
    """
    content: bytes = pandas().DataFrame(sheet.rows, columns=list(sheet.columns)).to_parquet()
    return content
