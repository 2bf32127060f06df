"""The parts of an experiment, made from a validated scenario and refused in one line where they cannot be.

No part knows another, and none of them a file.
"""

__all__ = ["course", "law", "machines"]
