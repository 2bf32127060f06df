"""The paper's figures from a run. Importing this package loads matplotlib; nothing else in the project does."""

from scenarios.figures.catalogue import FIGURES as FIGURES
from scenarios.figures.catalogue import OVERVIEW as OVERVIEW
from scenarios.figures.catalogue import draw as draw
from scenarios.figures.catalogue import names_for as names_for
from scenarios.figures.catalogue import plot as plot
from scenarios.figures.films.encode import animate as animate
from scenarios.figures.films.layout import Frame as Frame
from scenarios.figures.style import FORMATS as FORMATS

__all__ = ["FIGURES", "FORMATS", "Frame", "OVERVIEW", "animate", "draw", "names_for", "plot"]
