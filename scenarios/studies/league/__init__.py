"""The league: every law on one target, from the same starts, with the same errors; its tables, page and figure.

Knows no single law, but for its citations and horizons: what it says of each is declared by the law or measured.
"""

__all__ = ["beside", "citations", "ends", "entries", "ideal", "measure", "noise", "picture", "report"]
