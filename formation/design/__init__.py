"""Choosing whom each agent senses: the leader-first-follower graph that suits a target, or that a given graph holds."""
