"""Who senses whom, and the conditions on it that laws name. Knows no place and no angle."""

__all__ = ["conditions", "constructions", "designs", "directed", "edges", "rigidity", "sensing", "stress"]
