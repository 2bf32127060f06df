"""The interface of ``rps`` before 2.0, module by module: version 1, and the names of 2018 and 2019; nothing of 2.1."""

__all__ = [
    "barrier_certificates",
    "barrier_certificates2",
    "controllers",
    "graph",
    "misc",
    "robotarium",
    "transformations",
    "uni_ekf",
]
