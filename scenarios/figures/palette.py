"""The colours of agents in figures; :mod:`scenarios.recording.views.style` has the same hues for a dark ground.

Okabe and Ito's colours, which stay apart for all common kinds of colour blindness, but for their yellow, which drowns
on white paper, and their black, which is kept for text: a dark purple and a khaki take their places.
"""

from __future__ import annotations

AGENT_COLOURS = (
    "#0072B2",  # blue
    "#D55E00",  # vermilion
    "#009E73",  # bluish green
    "#CC79A7",  # reddish purple
    "#E69F00",  # orange
    "#56B4E9",  # sky blue
    "#882255",  # dark purple
    "#A8A060",  # khaki
)
"""Colours of the agents 1 to 8 as #RRGGBB; the agents after them begin again with the first."""

INK = "#222222"
"""Text, axes and what belongs to no agent."""

FAINT = "#B0B0B0"
"""What must not draw the eye: grids, ghosts, limits."""

ALARM = "#A50026"
"""The testbed's limits."""


def agent_colour(row: int) -> str:
    """The colour #RRGGBB of the agent in array row ``row``."""
    return AGENT_COLOURS[row % len(AGENT_COLOURS)]


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of a colour #RRGGBB.

    >>> rgb("#0072B2")
    (0, 114, 178)
    """
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
