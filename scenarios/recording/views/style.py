"""Colours and sizes of a recording, for the viewer's dark theme."""

from __future__ import annotations

Colour = tuple[int, int, int]

AGENTS: tuple[Colour, ...] = (
    (64, 150, 240),
    (240, 110, 50),
    (20, 190, 140),
    (225, 140, 190),
    (245, 190, 60),
    (120, 205, 250),
    (190, 90, 150),
    (200, 190, 120),
)
"""Colours of agents 1, 2, 3, ..., repeated from the ninth on: the hues of the figures, lighter. Red is for limits."""

BACKGROUND: Colour = (16, 18, 22)
FLOOR: Colour = (120, 125, 135)
WALL: Colour = (200, 205, 215)
HATCH: Colour = (120, 124, 134)
GRID: Colour = (32, 35, 41)
TEXT: Colour = (240, 242, 246)
"""Of labels in the arena: the light theme puts them on grey, the dark one on black."""

WHEEL: Colour = (225, 228, 235)
SENSING: Colour = (140, 147, 160)
GHOST: Colour = (74, 80, 92)
MEASURED: Colour = (85, 165, 250)
SECOND: Colour = (250, 200, 80)
LIMIT: Colour = (230, 70, 70)
PREDICTED: Colour = (150, 158, 172)
GOOD: Colour = (45, 105, 62)
BAD: Colour = (165, 50, 50)
PENDING: Colour = (135, 105, 50)
GOAL: Colour = (90, 190, 110)
PHASES: tuple[Colour, ...] = ((60, 90, 150), (120, 80, 150), (45, 115, 125), (120, 90, 70))
"""Colours of the phases, repeated from the fifth on."""

RANGE: Colour = (52, 57, 68)
"""Of the circle in which a robot senses."""

CROWD = 12
"""Agents above which a picture leaves out what it would drown in: words at each robot, arcs, arrows, ranges."""

GRID_STEPS = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Metres between two lines of the floor's grid: the first that needs no more than :data:`GRID_LINES`."""

GRID_LINES = 11

TICK_SHARE = 0.0375
"""Of the floor's longer side, between the left side and a coordinate beside it."""

MARGIN = 0.22
"""Metres of floor around everything that is shown."""

ARROW_INSET = 0.085
"""Metres of a sensing arrow that each of its two robots covers."""

TRAIL_STEP = 0.1
"""Seconds between two points of a trail."""

TRAIL_LENGTH = 20.0
"""Seconds of trail behind each robot."""


def agent_colour(row: int) -> Colour:
    """The colour of the agent in array row ``row``, in the arena and in every plot."""
    return AGENTS[row % len(AGENTS)]


def pale(colour: Colour) -> Colour:
    """The colour nearly white, for words on black and on grey."""
    red, green, blue = (round(255 - 0.45 * (255 - channel)) for channel in colour)
    return red, green, blue


def tint(colour: Colour, share: float) -> Colour:
    """The colour at ``share`` of its brightness, as a paint on the dark floor."""
    red, green, blue = (round(share * channel) for channel in colour)
    return red, green, blue
