"""A matplotlib backend without a screen: figures are drawn when something looks at them, and ``show`` is silent."""

from __future__ import annotations

from typing import Any

from matplotlib.backend_bases import FigureManagerBase
from matplotlib.backends.backend_agg import FigureCanvasAgg


class FigureManager(FigureManagerBase):
    """Shows nothing, and does not complain about it."""

    def show(self) -> None:
        """Show nothing."""

    @classmethod
    def pyplot_show(cls, *, block: bool | None = None) -> None:
        """Return at once, as if each window had been closed."""


class FigureCanvas(FigureCanvasAgg):
    """Agg's, but that ``draw_idle`` waits until someone looks."""

    manager_class = FigureManager

    def draw_idle(self, *args: Any, **kwargs: Any) -> None:
        """Do nothing: nobody looks."""

    def start_event_loop(self, timeout: float = 0.0) -> None:
        """Return at once: there are no events to wait for."""
