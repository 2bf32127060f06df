"""``make pairs``: two of every writing command into one place at once.

One of them is refused in one line, or what both wrote is whole.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

from PIL import Image

from scenarios.storage import run_folder
from scenarios.studies.check import baseline
from tests.fuzz.kills import SCENARIO, complained, start, whole

RUN = ("run", "./three.toml", "--no-recording", "--out", "run")

COMMANDS: dict[str, tuple[tuple[str, ...], Callable[[Path], object]]] = {
    "run": (("run", "./three.toml", "--out", "other"), lambda at: run_folder.read(at / "other")),
    "run again": (("run", "run", "--no-recording", "--out", "run"), lambda at: run_folder.read(at / "run")),
    "plot": (("plot", "run", "--format", "png"), lambda at: Image.open(at / "run/figure-decay.png").load()),
    "animate": (("animate", "run", "--fps", "5"), lambda at: Image.open(at / "run/animation.gif").load()),
    "sweep": (
        ("sweep", "./three.toml", "--seeds", "0:6", "--workers", "1", "--out", "sweep"),
        lambda at: (len((at / "sweep/rows.csv").read_text().splitlines()) == 7) or 1 / 0,
    ),
    "check --update": (
        ("check", "./three.toml", "--update", "--baselines", "new", "--workers", "1"),
        lambda at: baseline.read(at / "new/three.json"),
    ),
    "check --junit": (
        ("check", "./three.toml", "--baselines", "base", "--workers", "1", "--junit", "junit.xml"),
        lambda at: ElementTree.parse(at / "junit.xml"),
    ),
    "check --markdown": (
        ("check", "./three.toml", "--baselines", "base", "--workers", "1", "--markdown", "check.md"),
        lambda at: (at / "check.md").read_text().index("Every case"),
    ),
    "export": (
        ("export", "maneuver-testbed", "--out", "script.py", "--force"),
        lambda at: compile((at / "script.py").read_text(), "script.py", "exec"),
    ),
    "keys": (("keys", "--markdown", "keys.md"), lambda at: (at / "keys.md").read_text().index("radius_m")),
    "laws": (("laws", "--starts", "5", "--markdown", "laws.md"), lambda at: (at / "laws.md").read_text().index("|")),
    "audit": (
        ("audit", "./three.toml", "--starts", "0", "--markdown", "audit.md"),
        lambda at: (at / "audit.md").read_text().index("|"),
    ),
}
"""Each command, and how what it wrote is read whole; ``reproduce --markdown`` writes as the last three do."""


def main() -> int:
    """Run the pairs; 1 where anything is wrong."""
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="formation-pairs-") as name:
        folder = Path(name).resolve()
        (folder / "three.toml").write_text(SCENARIO, encoding="utf-8")
        whole(RUN, folder)
        whole(("check", "./three.toml", "--update", "--baselines", "base", "--workers", "1"), folder)
        for key, (arguments, read) in COMMANDS.items():
            ended = [
                (complained(p.communicate()[1]), p.returncode) for p in [start(arguments, folder) for _ in range(2)]
            ]
            refused = [(err, code) for err, code in ended if code == 2]
            found = [f"{code}: {err}" for err, code in ended if code not in (0, 1, 2) or err.count("\n")]
            found += ["both are refused"] if len(refused) == 2 else []
            try:
                read(folder)
            except Exception as error:
                found.append(f"what was written is not whole: {error!r}")
            found += [f"scratch is left: {path}" for path in folder.rglob(".*.unfinished")]
            verdict = f"one refused: {refused[0][0]}" if refused else "both whole"
            print(f"{key}: {json.dumps(found) if found else verdict}", flush=True)
            wrong += len(found)
    print(f"{len(COMMANDS)} pairs, {wrong} findings")
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
