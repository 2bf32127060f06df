"""The figure and the film of a script's run, whose robots follow no law that figures could know."""

__all__ = ["film", "overview"]
