"""One run of somebody's script for the Robotarium, to its run folder: what ``one_run`` is for a scenario.

How a script is executed and drawn is not here but in ``simulation`` and ``figures``; this room calls them in order.
"""

__all__ = ["one_script"]
