"""The interface of ``rps`` 2.1 (2026), module by module; nothing that only version 1 has."""

__all__ = [
    "barrier_certificates",
    "controllers",
    "graph",
    "gternal_patch",
    "misc",
    "robotarium",
    "sensors",
    "transformations",
]
