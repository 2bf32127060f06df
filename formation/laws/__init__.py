"""One law a file: source, equation, what it measures, what is proved, what is known to fail. Moves no agent."""

__all__ = [
    "affine",
    "angle",
    "area",
    "base",
    "bearing",
    "bisector",
    "catalogue",
    "cosine",
    "displacement",
    "distance",
    "edge_sum",
    "first_follower",
    "laplacian",
    "persistent",
    "protocol",
    "ratio",
    "redundant",
    "triangle",
    "triangles",
    "triangular",
]
