"""Work spread over processes, here or on other machines: results in the order of the tasks.

Knows nothing of formations, nor of the project whose functions it calls.
"""

__all__ = ["cluster", "processes", "protocol", "signals", "spread"]
