"""Processes of this machine end with whoever wants their results."""

import multiprocessing
import time

from scenarios.work.processes import run_all


def test_workers_whose_results_nobody_waits_for_any_more_end_at_once() -> None:
    results = run_all(time.sleep, [0.0, 1e6, 1e6], workers=2)
    assert next(iter(results)) is None
    results.close()  # as an interrupt or a failed task does
    assert multiprocessing.active_children() == []
