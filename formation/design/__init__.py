"""Choosing whom each agent senses: the leader-first-follower graph that suits a target, or that a given graph holds.

Knows no sensor and no file: what can be sensed is handed in as a field of allowed edges.
"""

__all__ = ["candidates", "closure", "field", "kernel", "subgraph"]
