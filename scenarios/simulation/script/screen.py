"""Where the figures of a script are drawn."""

from __future__ import annotations

import os
import sys

OFFSCREEN = "module://scenarios.simulation.script.offscreen"
"""The name of our backend for matplotlib."""


def take_the_screen_away() -> None:
    """Let matplotlib draw where nobody looks, in this process and in those that a script starts."""
    os.environ["MPLBACKEND"] = OFFSCREEN
    if "matplotlib" in sys.modules:
        import matplotlib

        matplotlib.use(OFFSCREEN)
