"""``make fuzz``: every case; or one, or some: ``python -m tests.fuzz scenario 1234 [1300]``."""

from __future__ import annotations

import sys

from scenarios.work.processes import available_workers, run_all
from tests.fuzz.cases import findings

WHOLE = {"scenario": 5000, "run": 1000, "option": 500}
SHARE = 50
"""Cases of one task."""


def main(arguments: list[str]) -> int:
    """Run all cases, or those that are named; 1 where anything is wrong."""
    if arguments:
        kind, first, *end = arguments
        wanted = {kind: (int(first), int(end[0]) if end else int(first) + 1)}
    else:
        wanted = {kind: (0, number) for kind, number in WHOLE.items()}
    tasks = [(kind, i, min(i + SHARE, end)) for kind, (first, end) in wanted.items() for i in range(first, end, SHARE)]
    total = 0
    for task, found in zip(tasks, run_all(findings, tasks, available_workers()), strict=True):
        total += len(found)
        print("\n".join([f"{task[0]} {task[1]} to {task[2] - 1}: {len(found)} findings", *found]), flush=True)
    print(f"{sum(end - first for _, first, end in tasks)} cases, {total} findings")
    return min(total, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
