"""Files that a scenario is made of, read only where they are what they should be: text, laws, robots, way-points.

What they mean is not decided here.
"""

__all__ = ["law_file", "reading", "robot_file", "way_function", "way_points"]
