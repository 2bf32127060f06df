"""Recordings for the rerun viewer, and the viewer. What they show is measured elsewhere: nothing is computed here.

Nothing that loads rerun is imported before a recording is asked for: rerun takes its time.
"""

__all__ = [
    "aside",
    "content",
    "encode",
    "file",
    "live",
    "piece",
    "recorder",
    "script",
    "script_live",
    "streams",
    "viewer",
    "views",
]
