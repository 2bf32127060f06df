"""What to do about errors that scripts for the Robotarium run into everywhere, the testbed included."""

from __future__ import annotations

import linecache
import re
import traceback

from robots.rps.hook import MODULES, Version, names
from scenarios.errors import did_you_mean

HINTS: tuple[tuple[str, str], ...] = (
    (r"numpy.* has no attribute 'mat'|`np\.mat` was", "numpy 2 has no np.mat: write np.asmatrix, or np.array and @"),
    (r"numpy.* has no attribute '(float|int|bool|object)'", "numpy has no np.{0} any more: write {0}"),
    (r"numpy.* has no attribute '(\w+)'", "today's numpy has no np.{0}: see its migration guide"),
    (r"inhomogeneous shape", "numpy makes no arrays of lists of different lengths any more: dtype=object, or a list"),
    (r"RegularPolygon.*positional argument", "matplotlib wants RegularPolygon(xy, n, radius=..., orientation=...)"),
    (r"(cm|pyplot).* has no attribute 'get_cmap'", "matplotlib 3.9 has no cm.get_cmap: matplotlib.colormaps[NAME]"),
    (r"(Arrow|Circle|Ellipse|Rectangle|Wedge|Polygon).*positional argument", "matplotlib wants that argument by name"),
    (r"has no attribute 'set_window_title'", "write figure.canvas.manager.set_window_title(...)"),
    (r"attempted relative import", "Python starts a script outside of packages: `import x`, not `from . import x`"),
    (r"EOFError", "it asks for input: start it in a terminal, or write the answers to its input"),
    (r"No module named 'rps", "not a module of the public simulator, of neither generation"),
    (r"No module named '(\w+)'", "install it in the environment of `formation`: pip install {0}"),
    (r"(No such file|not found).*\.mat'?$", "a MATLAB file that the script reads must lie where you start it"),
    (r"No such file or directory: '(.*)'", "scripts look for files where you start them, not in their own folder"),
    (r"number_of_robots must be", "the testbed has 50 robots"),
)  # fmt: skip
"""Patterns of the last line of a traceback, and one line of advice; the first that fits is given."""


def hint(error: BaseException) -> str | None:
    """One line of advice, where there is one."""
    text = f"{type(error).__name__}: {error}"
    for pattern, advice in HINTS:
        if (found := re.search(pattern, text)) is not None:
            return advice.format(*found.groups())
    return _of_rps(text) or _of_arguments(error)


def _of_rps(text: str) -> str | None:
    """Names that ``rps`` has not, or not in the generation that the script speaks to."""
    if (found := re.search(r"cannot import name '(\w+)' from 'rps\.([\w.]+)'", text)) is not None:
        name, module = found.groups()
        if module in MODULES:
            nearest = did_you_mean(name, sorted(names(module, 2)), "and none that is near")
            return f"rps.{module} has no such name in either generation, {nearest}"
    if (found := re.search(r"'Robotarium' object has no attribute '(\w+)'", text)) is not None:
        generations: tuple[Version, ...] = (1, 2)
        for version in generations:
            if hasattr(names("robotarium", version)["Robotarium"], found[1]):
                return f"it is of generation {version} of rps: --rps {version}"
    return None


def _of_arguments(error: BaseException) -> str | None:
    if not isinstance(error, IndexError) or not (stack := traceback.extract_tb(error.__traceback__)):
        return None
    line = linecache.getline(stack[-1].filename, stack[-1].lineno or 0)
    return "arguments of the script come after --: formation script FILE.py -- ARGS" if "argv" in line else None
