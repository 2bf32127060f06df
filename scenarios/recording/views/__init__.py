"""What a recording shows: the scene, the plots, the timeline, the summary, and how they are laid out.

Where streams go, and when, is not known here: a :class:`~scenarios.recording.recorder.Recorder` takes all.
"""

__all__ = [
    "angles",
    "blueprint",
    "filtering",
    "happenings",
    "legend",
    "obstacles",
    "plots",
    "scene",
    "style",
    "summary",
    "timeline",
]
