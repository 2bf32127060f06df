"""The rerun viewer inside a notebook."""

from __future__ import annotations

import os
from typing import Any

from scenarios.errors import InputError

ASSETS, FROM_HERE = "RERUN_NOTEBOOK_ASSET", "serve-local"
"""Where the viewer's program comes from: this machine, unless the user says otherwise; rerun itself asks a server."""


def widget(recording: bytes, width: int, height: int) -> Any:
    """A widget that shows the content of an ``.rrd`` file, pixels wide and high.

    Raises:
        InputError: rerun's package for notebooks is missing.
    """
    os.environ.setdefault(ASSETS, FROM_HERE)
    try:
        from rerun_notebook import Viewer  # compresses the viewer's program, for seconds
    except ImportError as error:
        raise InputError(
            f"a recording in a notebook needs rerun's package for it, the extra 'notebook' of angle-formation ({error})"
        ) from error
    viewer = Viewer(width=width, height=height)
    viewer.send_rrd(recording)
    return viewer
