"""Our time beside that of other simulators, in one run: `make peers` writes docs/performance.md.

    make peers RPS=FOLDER RPS_JAX=FOLDER

RPS and RPS_JAX are checkouts of github.com/robotarium/robotarium_python_simulator and of
github.com/shalin-jain/robotarium_python_simulator (JaxRobotarium's simulator), which no registry has. Every peer gets
an environment of its own in .venv-peers; one that cannot be had is named with the reason. What is timed is the
processor time of one thread, the least of five after a first one, so that other work on the machine hardly counts.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

from scenarios.documents import markdown_table

HERE = Path(__file__).parent
PAGE = HERE.parent / "performance.md"
ENVIRONMENTS = Path(".venv-peers")
INSTALLING, WORKING = 600, 300  # seconds

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
    "MPLBACKEND": "agg",
}


@dataclass(frozen=True)
class Peer:
    """One line of the tables.

    Attributes:
        name: of the line.
        script: and its arguments.
        requirements: of its environment; none where our own has all.
        variable: that names the folder of its sources; empty where a registry has them.
        guarded: whether something keeps robots apart.
    """

    name: str
    script: tuple[str, ...]
    requirements: tuple[str, ...] = ()
    variable: str = ""
    guarded: bool = False

    @property
    def environment(self) -> Path:
        return ENVIRONMENTS / self.script[0].removeprefix("with_").removesuffix(".py")


_RPS = ("numpy==2.4.6", "scipy==1.17.1", "cvxopt==1.3.3", "matplotlib==3.11.2")
_JAX = ("jax==0.10.2", "jaxlib==0.10.2", "jaxopt==0.8.5")
PEERS = (
    Peer("ours, `saturated`", ("with_ours.py", "saturated", "none")),
    Peer("ours, `saturated`, decentralised filter", ("with_ours.py", "saturated", "decentralised"), guarded=True),
    Peer("ours, `pymunk`", ("with_ours.py", "pymunk", "none")),
    Peer("ours, `pymunk`, decentralised filter", ("with_ours.py", "pymunk", "decentralised"), guarded=True),
    Peer("bare Chipmunk: no law, no wheels", ("with_chipmunk.py",)),
    Peer("rps", ("with_rps.py", "none"), _RPS, "RPS"),
    Peer("rps, barrier certificate", ("with_rps.py", "certificate"), _RPS, "RPS", True),
    Peer("JaxRobotarium (rps_jax), all steps in one scan", ("with_rps_jax.py", "none"), _JAX, "RPS_JAX"),
    Peer("JaxRobotarium (rps_jax), barrier certificate", ("with_rps_jax.py", "certificate"), _JAX, "RPS_JAX", True),
    Peer("VMAS, with contact", ("with_vmas.py",), ("torch==2.13.0", "vmas==1.5.2")),
    Peer("ir-sim", ("with_irsim.py",), ("ir-sim==2.12.0",)),
)


@dataclass
class Outcome:
    """Seconds a step of all runs, by the number of runs; or why there are none."""

    version: str = ""
    seconds: dict[int, float] = field(default_factory=dict)
    reason: str = ""


def main() -> None:
    outcomes = {peer: measured(peer) for peer in PEERS}
    PAGE.write_text("\n".join(page(outcomes)) + "\n", encoding="utf-8")
    print(f"wrote {PAGE}")


def measured(peer: Peer) -> Outcome:
    """Make the environment of a peer where it is missing, and let it work."""
    folder = os.environ.get(peer.variable, "") if peer.variable else ""
    if peer.variable and not folder:
        return Outcome(reason=f"not in a registry, and {peer.variable} names no folder with its sources")
    try:
        python = _environment(peer) if peer.requirements else Path(sys.executable)
        path = os.pathsep.join([folder] if folder else [str(HERE.parents[1])])
        done = subprocess.run(
            [python, HERE / peer.script[0], *peer.script[1:]],
            env={**os.environ, **ONE_THREAD, "PYTHONPATH": path},
            capture_output=True, text=True, timeout=WORKING, check=True,
        )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        return Outcome(reason=f"not done within {error.timeout:g} s")
    except subprocess.CalledProcessError as error:
        said = [line for line in (error.stderr or "").splitlines() if line.strip()]
        return Outcome(reason=said[-1].strip() if said else f"ended with code {error.returncode}")
    found = json.loads(done.stdout.splitlines()[-1])
    print(f"{peer.name}: {found}", flush=True)
    seconds = {row["runs"]: row["seconds_a_step"] for row in found["rows"]}
    return Outcome(f"{found['package']} {found['version']}", seconds)


def _environment(peer: Peer) -> Path:
    """The interpreter of the peer's environment."""
    python = peer.environment / "bin" / "python"
    stamp = peer.environment / ".installed"
    if not stamp.exists():
        subprocess.run([sys.executable, "-m", "venv", peer.environment], check=True, capture_output=True, text=True)
        command = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *peer.requirements]
        subprocess.run(command, check=True, capture_output=True, text=True, timeout=INSTALLING)
        stamp.touch()
    return python.absolute()


def page(outcomes: dict[Peer, Outcome]) -> list[str]:
    """The lines of docs/performance.md."""
    there = {peer: outcome for peer, outcome in outcomes.items() if outcome.seconds}
    missing = {peer: outcome for peer, outcome in outcomes.items() if not outcome.seconds}
    return [
        "# Performance, beside other simulators",
        "",
        "<!-- Written by `make peers`; edit docs/peers. -->",
        "",
        "Six robots form the shape of `shape`: the same law, the same near-identity map, a control period of 0.033 s.",
        "Processor time of one thread, the least of five, all in one run: ratios hold better than figures. Each peer",
        "has an environment of its own; what it adds besides stands in its line. Ours measures what a row of a sweep",
        "holds in its thousand runs; the others only advance. Of a single run, ours keeps the trajectory. VMAS and",
        "rps_jax compute in single precision, as they do unless told; ours in double.",
        "",
        "    make peers RPS=FOLDER RPS_JAX=FOLDER",
        "",
        "## One run, microseconds a step of six robots",
        "",
        *_table(there, 1, 1e6, "us a step"),
        "",
        "## A thousand runs, nanoseconds a robot and step",
        "",
        *_table(there, 1000, 1e9 / 6000.0, "ns a robot-step"),
        "",
        "## Not measured",
        "",
        *[f"- {peer.name}: {outcome.reason}" for peer, outcome in missing.items()],
        *([] if missing else ["Nothing: all peers could be had."]),
        "",
        "## Versions",
        "",
        *sorted({f"- {outcome.version}" for outcome in there.values()}),
    ]


def _table(there: dict[Peer, Outcome], runs: int, unit: float, title: str) -> list[str]:
    """A line a peer, each with its ratio to ours that keeps robots apart, or does not, as it does."""
    found = {peer: outcome.seconds[runs] * unit for peer, outcome in there.items() if runs in outcome.seconds}
    ours = {peer.guarded: value for peer, value in found.items() if peer.script[:2] == ("with_ours.py", "saturated")}
    lines = [
        (peer.name, _digits(value), _digits(value / ours[peer.guarded]) if peer.guarded in ours else "-")
        for peer, value in found.items()
    ]
    return markdown_table(("simulator", title, "of ours on `saturated`"), lines, numbers=2)


def _digits(value: float) -> str:
    """Three digits that count."""
    return f"{float(f'{value:.3g}'):g}"


if __name__ == "__main__":
    main()
