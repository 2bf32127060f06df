"""This project's processor time beside an older version's: ``python tests/benchmarks/beside.py OTHER_PYTHON``.

OTHER_PYTHON is the interpreter of an environment that holds the other version. Both do the same work in processes of
their own, in turns, so that both see the same machine; the median of the ratios counts. What is to compile is compiled
before anything is measured.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
from collections.abc import Iterator

BOTH = """
import sys, time
try:
    from scenarios.definition.experiment import open_experiment
    from scenarios.simulation.loop import simulate
except ImportError:
    from scenarios.experiment import open_experiment
    from scenarios.simulation import simulate
name, duration, repeats, *changes = sys.argv[1:]
experiment = open_experiment(name, tuple(changes), float(duration))
simulate(experiment, 0)
begun = time.process_time()
for seed in range(int(repeats)):
    trajectory = simulate(experiment, seed)
print((time.process_time() - begun) / int(repeats) / (len(trajectory.t) - 1))
"""

SWEEP = """
import resource, subprocess, sys, tempfile
plant, safety, seeds = sys.argv[1:]
def spent(count):
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = ["-m", "scenarios", "sweep", "shape", "--plant", plant, "--set", f"safety.filter={safety}"]
        command += ["--seeds", f"0:{count}", "--workers", "1", "--out", folder + "/sweep"]
        subprocess.run([sys.executable, *command], stdout=subprocess.DEVNULL, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
print((spent(2 * int(seeds)) - spent(int(seeds))) / int(seeds))
"""

PLAIN, FILTERED = "safety.filter=none", "safety.filter=decentralised"
STEPS = {
    "a control period of shape, saturated, no filter": ("shape", "20", "20", "plant.name=saturated", PLAIN),
    "a control period of shape, saturated, filter": ("shape", "20", "20", "plant.name=saturated", FILTERED),
    "a control period of shape, pymunk, no filter": ("shape", "20", "10", "plant.name=pymunk", PLAIN),
    "a control period of shape, pymunk, filter": ("shape", "20", "10", "plant.name=pymunk", FILTERED),
    "a control period of 50 robots, pymunk, filter": ("random-50", "3", "4", "plant.name=pymunk", FILTERED),
}
SWEEPS = {
    "one more run of a sweep, saturated, no filter": ("saturated", "none", (60, 3000)),
    "one more run of a sweep, saturated, filter": ("saturated", "decentralised", (60, 1500)),
    "one more run of a sweep, pymunk, filter": ("pymunk", "decentralised", (20, 100)),
}


def seconds(python: str, code: str, *arguments: str) -> float:
    """What the code says, run by an interpreter."""
    done = subprocess.run([python, "-c", code, *arguments], capture_output=True, text=True, check=True, cwd="/")
    return float(done.stdout.split()[-1])


def pairs(other: str, what: str, count: int) -> Iterator[tuple[float, float]]:
    """Seconds of the other version and of this one, pair by pair."""
    for _ in range(count):
        if what in STEPS:
            yield seconds(other, BOTH, *STEPS[what]), seconds(sys.executable, BOTH, *STEPS[what])
        else:
            plant, safety, (few, many) = SWEEPS[what]
            yield (
                seconds(other, SWEEP, plant, safety, str(few)),
                seconds(sys.executable, SWEEP, plant, safety, str(many)),
            )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("other")
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--only", default="", help="part of the names of what to measure")
    options = parser.parse_args()
    for what in (name for name in (*STEPS, *SWEEPS) if options.only in name):
        seconds(sys.executable, BOTH, *STEPS.get(what, ("shape", "1", "1")))
        found = list(pairs(options.other, what, options.pairs))
        before, now = (statistics.median(each) * 1e6 for each in zip(*found, strict=True))
        ratio = statistics.median(then / after for then, after in found)
        print(f"{what:50} {before:11.1f} {now:9.1f} us, {ratio:6.1f} times, {1.0 / ratio:5.3f} of it")


if __name__ == "__main__":
    main()
