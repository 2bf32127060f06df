"""Files that a scenario is made of, read only where they are what they should be: text, laws, robots, way-points.

Beside them the library of those that come with the project, and the text of one to begin with. What they mean is not
decided here.
"""

__all__ = ["law_file", "library", "reading", "robot_file", "starter", "way_function", "way_points"]
