"""This project, as work that is spread over other machines has to know it."""

from scenarios.work.protocol import Code

PROJECT = Code("angle-formation", ("formation", "robots", "scenarios"))
"""What runs of a study need on a worker, in the same state as here."""
