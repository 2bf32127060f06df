"""``make fuzz``: every case, or one: ``python -m tests.fuzz scenario 1234``."""

from __future__ import annotations

import sys

from scenarios.work.processes import available_workers, run_all
from tests.fuzz.cases import findings

WHOLE = {"scenario": 5000, "run": 1000, "option": 2000}
SHARE = 50
"""Cases of one task."""


def main(arguments: list[str]) -> int:
    """Run all cases, or the one that is named; the number of findings."""
    if arguments:
        kind, number = arguments[0], int(arguments[1])
        tasks = [(kind, number, number + 1)]
    else:
        tasks = [(kind, i, min(i + SHARE, n)) for kind, n in WHOLE.items() for i in range(0, n, SHARE)]
    total = 0
    for task, found in zip(tasks, run_all(findings, tasks, available_workers()), strict=True):
        total += len(found)
        print("\n".join([f"{task[0]} {task[1]} to {task[2] - 1}: {len(found)} findings", *found]), flush=True)
    print(f"{sum(end - first for _, first, end in tasks)} cases, {total} findings")
    return min(total, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
