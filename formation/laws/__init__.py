"""One law a file: source, equation, what it measures, what is proved, what is known to fail. Moves no agent."""

__all__ = [
    "angle",
    "base",
    "bearing",
    "catalogue",
    "displacement",
    "distance",
    "edge_sum",
    "first_follower",
    "protocol",
]
