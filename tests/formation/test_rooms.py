"""The three rooms keep apart, and importing them stays cheap."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ALLOWED = {"formation": {"formation", "numpy"}, "robots": {"robots", "numpy", "pymunk", "numba", "daqp"}}


def imported(path: Path) -> set[str]:
    """Top-level names of all packages that a file imports anywhere."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add((node.module or "").split(".")[0])
    return found - set(sys.stdlib_module_names)


@pytest.mark.parametrize("room", ALLOWED)
def test_a_room_imports_nothing_but_what_it_may_know(room: str) -> None:
    used = {name for path in (ROOT / room).rglob("*.py") for name in imported(path)}
    assert used <= ALLOWED[room]


@pytest.mark.parametrize("module", ["formation", "robots", "scenarios.cli"])
def test_importing_loads_no_heavy_package(module: str) -> None:
    heavy = "{'matplotlib', 'rerun', 'numba', 'daqp', 'pymunk', 'pyarrow', 'dask', 'distributed'}"
    code = f"import sys, {module}; print(*({heavy} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_listing_scenarios_loads_no_numpy() -> None:
    code = "import sys, scenarios.report.catalogue; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
