"""Recordings for the rerun viewer. Nothing here is imported before a recording is asked for: rerun takes its time."""
