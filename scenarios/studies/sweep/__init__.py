"""Monte Carlo: one scenario or its variations, many seeds, one row per run, and what the rows say together.

Nothing here makes a single run worth looking at: that is :mod:`scenarios.one_run`.
"""

__all__ = ["cause", "folder", "quantiles", "row", "seeds", "sheet", "study", "summary", "sweep", "table", "variations"]
