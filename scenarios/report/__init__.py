"""What a person reads of scenarios, one experiment or one run. Runs nothing; studies print their own."""

__all__ = [
    "catalogue",
    "cells",
    "closed_forms",
    "course",
    "experiment",
    "foretold",
    "happenings",
    "numbers",
    "result",
    "script_printout",
]
