"""A matplotlib backend without a screen: figures are drawn when something looks at them, and ``show`` is silent."""

from __future__ import annotations

import warnings
from typing import Any

from matplotlib._pylab_helpers import Gcf
from matplotlib.backend_bases import FigureManagerBase, TimerBase
from matplotlib.backends.backend_agg import FigureCanvasAgg

UNSEEN = "off screen an animation does not play: call its function in a loop, or start with --show"


class FigureManager(FigureManagerBase):
    """Shows nothing, and does not complain about it."""

    def show(self) -> None:
        """Show nothing."""

    @classmethod
    def pyplot_show(cls, *, block: bool | None = None) -> None:
        """Return at once, as if each window had been closed."""
        for manager in Gcf.get_all_fig_managers():
            if getattr(manager.canvas, "timed", False):
                manager.canvas.draw()  # which an animation takes for having been seen
                warnings.warn(UNSEEN, stacklevel=3)
                return


class FigureCanvas(FigureCanvasAgg):
    """Agg's, but that ``draw_idle`` waits until someone looks."""

    manager_class = FigureManager
    timed = False

    def new_timer(self, *args: Any, **kwargs: Any) -> TimerBase:
        """A timer that never fires: nobody waits for it."""
        self.timed = True
        return super().new_timer(*args, **kwargs)

    def draw_idle(self, *args: Any, **kwargs: Any) -> None:
        """Do nothing: nobody looks."""

    def start_event_loop(self, timeout: float = 0.0) -> None:
        """Return at once: there are no events to wait for."""
