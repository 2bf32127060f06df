"""A scenario as a script that the Robotarium runs."""
