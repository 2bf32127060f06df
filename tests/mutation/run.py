"""`make mutants`: does a test notice when the theory or the machines are changed?

Of all mutants of ``formation/`` and of ``robots/`` a sample is drawn, by a hash of each and a seed: a line that is
written anew leaves the rest of the sample as it is. Each is made in a copy of the project, and the
tests of that floor which run the changed line are run on it, the quickest first, until one fails. A mutant that all of
them pass has survived. Of a line that only an import runs, a constant, they are the tests that run the rest of its
file.

Which lines a test runs is found with the compiler off. A mutant of a compiled function meets the quick tests that way
too, which spares most of them the compiler, and only then the others as machine code. A test that fails with the
compiler off, where a division by zero raises, is one of the others.

Neither mutmut nor cosmic-ray does this: the first wraps every function in one that numba cannot compile, the second
runs one command, the same for each mutant. So the choice is ours; coverage.py finds the lines and pytest runs.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import importlib
import json
import math
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import tomllib
import traceback
from collections import Counter
from collections.abc import Callable
from itertools import accumulate
from pathlib import Path
from typing import Any

import coverage
import numba
import pytest
from mutate import Mutant, mutants

ROOT = Path(__file__).parents[2]
FLOORS = ("formation", "robots")
SEED = 57
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
PATIENCE, LONGER = 30.0, 10.0
"""Seconds of processor time, and how many times its own, after which a test that has not ended counts as failed."""

COMPILATION = 90.0
"""Seconds that a test may have more where there is a compiler."""

COMPILED = re.compile(r"^@_?(compiled|inlined)$", re.MULTILINE)
PYTHON = ["-W", "ignore::RuntimeWarning"]
"""Uncompiled, a division by zero says what it does not say compiled."""

PLUGINS = ("_", "pytest", "xdist", "execnet", "hypothesis")
"""Modules that pytest wants to load itself."""

QUIET = ["-q", "--no-header", "-p", "no:cacheprovider", "-m", "not slow"]
WITHOUT_COMPILER = 10.0
"""Seconds for which the tests of a compiled function run uncompiled, before they are worth a compilation."""


class Watch:
    """A pytest plugin: how long each test takes, and under whose name lines are covered."""

    def __init__(self, cover: coverage.Coverage | None = None) -> None:
        self.cover = cover
        self.seconds: dict[str, float] = {}
        self.failed: set[str] = set()

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """A test begins."""
        if self.cover is not None:
            self.cover.switch_context(nodeid)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """A part of a test has ended."""
        self.seconds[report.nodeid] = self.seconds.get(report.nodeid, 0.0) + report.duration
        if report.failed:
            self.failed.add(report.nodeid)


class Limit:
    """A pytest plugin: a process whose test takes far longer than it should is ended, as it may never end itself."""

    def __init__(self, seconds: dict[str, float], more: float) -> None:
        self._seconds, self._more = seconds, more

    def pytest_sessionstart(self) -> None:
        """All is about to be imported."""
        self._allow(PATIENCE)

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """A test begins."""
        self._allow(PATIENCE + LONGER * self._seconds.get(nodeid, 0.0) + self._more)

    def _allow(self, seconds: float) -> None:
        used = resource.getrusage(resource.RUSAGE_SELF)
        limit = int(used.ru_utime + used.ru_stime + seconds) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))


def forked(work: Callable[[], int], log: Path) -> int:
    """The exit code of ``work``, done in a process of its own; -1 where that was ended."""
    child = os.fork()
    if child == 0:
        signal.signal(signal.SIGXCPU, signal.SIG_DFL)
        to = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(to, 1)
        os.dup2(to, 2)
        code = 1
        try:
            code = work()
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(code)
    _, status = os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status) if os.WIFEXITED(status) else -1


def survey(copy: Path, floor: str, log: Path) -> None:
    """Run a floor's tests once and write beside the copy which of them runs which line, and how long each takes."""

    def work() -> int:
        numba.config.DISABLE_JIT = True
        os.chdir(copy)
        sys.path.insert(0, str(copy))
        cover = coverage.Coverage(data_file=None, source=[floor])
        watch = Watch(cover)
        cover.start()
        code = pytest.main([*QUIET, *PYTHON, f"tests/{floor}", floor], [watch])
        cover.stop()
        data = cover.get_data()
        lines = {
            str(Path(file).relative_to(copy)): {str(n): c for n, c in data.contexts_by_lineno(file).items()}
            for file in data.measured_files()
        }
        found = {"lines": lines, "seconds": watch.seconds, "failed": sorted(watch.failed), "modules": foreign()}
        (copy / f"{floor}.json").write_text(json.dumps(found))
        return 0 if code in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED) else 1

    if forked(work, log) != 0:
        sys.exit(f"the tests of {floor} do not run without a mutant: {log.read_text()[-2000:]}")


def foreign() -> list[str]:
    """The loaded modules that are neither the project's nor pytest's."""
    return sorted(
        name
        for name, module in sys.modules.items()
        if "site-packages" in (getattr(module, "__file__", None) or "") and not name.startswith(PLUGINS)
    )


def load(modules: list[str]) -> None:
    """Import what no mutant changes once, before the processes of the mutants part from this one."""
    for name in modules:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


def choose(mutant: Mutant, seen: dict[str, Any]) -> list[str]:
    """The tests that run a mutant's line, where an import does its file, or else all of them; the quickest first.

    A line that none of them runs may be machine code: then also those that do not work without the compiler.
    """
    lines = seen["lines"].get(mutant.path, {})
    named = {name for name in lines.get(str(mutant.line), []) if name}
    named = named or {name for names in lines.values() for name in names if name}
    if str(mutant.line) not in lines:
        named |= set(seen["failed"])
    return sorted(named or seen["seconds"], key=seen["seconds"].__getitem__)


def survives(mutant: Mutant, copy: Path, tests: list[str], seen: dict[str, Any], log: Path, kept: Path) -> bool:
    """Whether all ``tests`` pass with a mutant in the copy; machine code is kept in the folder ``kept``."""
    file = copy / mutant.path
    source, stamp = file.read_text(encoding="utf-8"), file.stat()
    file.write_text(mutant.applied(source), encoding="utf-8")

    def passes(some: list[str], compiler: bool) -> bool:
        def work() -> int:
            numba.config.DISABLE_JIT = not compiler
            numba.config.CACHE_DIR = str(kept)
            os.chdir(copy)
            sys.path.insert(0, str(copy))
            sys.dont_write_bytecode = True
            limit = Limit(seen["seconds"], COMPILATION if compiler else 0.0)
            return int(pytest.main([*QUIET, "-x", *(() if compiler else PYTHON), *some], [limit]))

        return forked(work, log) == 0

    quick = []
    if COMPILED.search(source):
        able = [name for name in tests if name not in seen["failed"]]
        sums = accumulate(seen["seconds"][name] for name in able)
        quick = [name for name, total in zip(able, sums, strict=True) if total < WITHOUT_COMPILER]
    rest = [name for name in tests if name not in quick]
    try:
        return (not quick or passes(quick, False)) and (not rest or passes(rest, True))
    finally:
        file.write_text(source, encoding="utf-8")
        os.utime(file, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))


def drawn(every: list[Mutant], number: int, seed: int) -> list[Mutant]:
    """A sample of the mutants, in their order; a change of the source elsewhere leaves each in it or out of it."""
    alike: Counter[tuple[str, str, str]] = Counter()
    ranked = []
    for mutant in every:
        name = mutant.path, mutant.before, mutant.after
        alike[name] += 1
        digest = hashlib.sha256(repr((seed, *name, alike[name])).encode()).digest()
        ranked.append((digest, mutant))
    return sorted(mutant for _, mutant in sorted(ranked)[:number])


def interval(killed: int, of: int, z: float = 1.96) -> tuple[float, float]:
    """Wilson's interval of a share, 95 % for this z."""
    share, spread = killed / of, z * z / of
    middle = share + spread / 2.0
    half = math.sqrt(share * (1.0 - share) * spread + spread * spread / 4.0)
    return (middle - half) / (1.0 + spread), (middle + half) / (1.0 + spread)


def main() -> None:
    """Make the sample, run it, print the survivors and the score."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sample", type=int, default=150, help="mutants of each floor")
    parser.add_argument("--seed", type=int, default=SEED, help="of the sample")
    parser.add_argument("--floor", choices=FLOORS, action="append", help="only this one")
    parser.add_argument("--again", type=Path, metavar="FILE", help="only the survivors that an earlier --report lists")
    parser.add_argument("--report", type=Path, metavar="FILE", help="write survivors here, one JSON object a line")
    chosen = parser.parse_args()
    known = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))["equivalent"]
    equivalent = {(entry["path"], entry["before"], entry["after"]) for entry in known}
    again = None
    if chosen.again is not None:
        again = {tuple(json.loads(line).values()) for line in chosen.again.read_text().splitlines()}
    with tempfile.TemporaryDirectory() as folder:
        copy, log, compiled = Path(folder, "project"), Path(folder, "log"), Path(folder, "compiled")
        kept = shutil.ignore_patterns(".*", "__pycache__", "runs", "*.egg-info", "build")
        shutil.copytree(ROOT, copy, ignore=kept)
        for floor in chosen.floor or FLOORS:
            started = time.monotonic()
            survey(copy, floor, log)
            seen = json.loads((copy / f"{floor}.json").read_text())
            load(seen["modules"])
            every = [
                mutant
                for path in sorted((copy / floor).rglob("*.py"))
                for mutant in mutants(str(path.relative_to(copy)), path.read_text(encoding="utf-8"))
            ]
            sample = drawn(every, chosen.sample, chosen.seed)
            if again is not None:
                sample = [m for m in every if (m.path, m.before, m.after) in again]
            idle = sum(str(m.line) not in seen["lines"].get(m.path, {}) for m in every)
            alike = [m for m in sample if (m.path, m.before, m.after) in equivalent]
            tried = [m for m in sample if m not in alike]
            killed = 0
            for mutant in tried:
                if not survives(mutant, copy, choose(mutant, seen), seen, log, compiled):
                    killed += 1
                    continue
                print(f"{mutant.path}:{mutant.line}\n  - {mutant.before}\n  + {mutant.after}", flush=True)
                if chosen.report is not None:
                    with chosen.report.open("a") as report:
                        row = {"path": mutant.path, "before": mutant.before, "after": mutant.after}
                        report.write(json.dumps(row) + "\n")
            low, high = interval(killed, len(tried))
            print(
                f"{floor}: {killed} of {len(tried)} noticed, {killed / len(tried):.1%} "
                f"(95 % interval {low:.1%} to {high:.1%}); {len(alike)} more of the sample change nothing; of "
                f"{len(every)} mutants in all {idle} are on lines that no test of {floor}/ runs; "
                f"{(time.monotonic() - started) / 60.0:.0f} min",
                flush=True,
            )


if __name__ == "__main__":
    main()
