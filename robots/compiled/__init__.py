"""Compiled functions: what numba makes of them, and how they run without it. Nothing here knows what they compute.

Loading numba takes as long as everything else that a short run loads. So a function is compiled when somebody asks for
it, and what Python calls in every run is kept as machine code that llvmlite alone can load. Compiled functions call
each other by names of their own modules, ``f``, not ``module.f``.
"""

from robots.compiled.functions import compiled as compiled
from robots.compiled.functions import inlined as inlined
from robots.compiled.functions import intrinsic as intrinsic
from robots.compiled.program import at_hand as at_hand
from robots.compiled.program import program as program

__all__ = ["at_hand", "compiled", "functions", "inlined", "intrinsic", "kept", "memory", "program"]
