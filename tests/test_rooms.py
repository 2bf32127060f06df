"""The house: who may know whom, where heavy packages are loaded, and how much fits into a room.

The order of the floors is a contract in ``pyproject.toml`` that ``make lint`` checks; here is what it cannot say.
"""

import ast
import graphlib
import importlib.metadata
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import scenarios

ROOT = Path(__file__).parents[1]
HOUSES = ("formation", "robots", "scenarios")
MODULES = {
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
    for house in HOUSES
    for path in sorted((ROOT / house).rglob("*.py"))
    if (path.parent / "__init__.py").is_file()
}
PACKAGES = [name for name, path in MODULES.items() if path.name == "__init__.py"]

ALLOWED = {
    "formation": {"formation", "numpy", "scipy", "numba"},
    "robots": {
        "robots",
        "numpy",
        "scipy",
        "pymunk",
        "numba",
        "llvmlite",
        "daqp",
        "matplotlib",
    },  # the last for what scripts draw
}

HEAVY_HOMES = {
    "matplotlib": ("scenarios.figures", "scenarios.simulation.script"),
    "PIL": ("scenarios.figures",),
    "rerun": ("scenarios.recording",),
    "numba": ("formation.design.kernel",),
    "pymunk": ("robots.worlds",),
    "daqp": ("robots.safety", "robots.rps"),
    **dict.fromkeys(("pyarrow", "scipy", "pandas", "dask", "distributed", "llvmlite"), ()),
}
"""Packages that take their time to load, and the rooms whose files may load them when they are imported themselves."""

GROUND = {"__init__", "__main__", "documents", "errors", "one_run", "replay", "terminal"}
"""The files of ``scenarios/`` itself."""

DENIALS = {"no", "not", "nothing", "nor"}
"""A docstring that has none of them does not say what lives elsewhere."""

MOST_FILES = 12
MOST_LINES = 300
REASON = "# Longer than 300 lines: "


@cache
def tree_of(path: Path) -> ast.Module:
    """A file's syntax."""
    return ast.parse(path.read_text(encoding="utf-8"))


def imports(path: Path, of_the_file_alone: bool = False) -> Iterator[str]:
    """All names that a file imports, with what is taken from them; not those for type checkers alone.

    Where ``of_the_file_alone``, without those that wait inside a function.
    """

    def visit(node: ast.AST) -> Iterator[str]:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            inner: list[ast.stmt] = node.orelse
        elif of_the_file_alone and isinstance(node, ast.FunctionDef):
            return
        else:
            inner = list(ast.iter_child_nodes(node))
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        for child in inner:
            yield from visit(child)

    return visit(tree_of(path))


def module_of(name: str) -> str | None:
    """The module of the house that an imported name is, or comes from."""
    return next((found for found in (name, name.rpartition(".")[0]) if found in MODULES), None)


# Who may know whom


@pytest.mark.parametrize("room", ALLOWED)
def test_a_room_imports_nothing_but_what_it_may_know(room: str) -> None:
    used = {name.split(".")[0] for path in (ROOT / room).rglob("*.py") for name in imports(path)}
    assert used - set(sys.stdlib_module_names) <= ALLOWED[room]


def test_nothing_imports_itself_in_a_circle() -> None:
    known = {
        module: {found for name in imports(path) if (found := module_of(name)) not in (None, module)}
        for module, path in MODULES.items()
    }
    graphlib.TopologicalSorter(known).prepare()  # raises CycleError, which names the circle


WRONG = {
    "scenarios.measures.metrics": "scenarios.report.result",
    "scenarios.definition.load": "scenarios.storage.files",
    "scenarios.figures.style": "scenarios.recording.views.style",
    "formation.target": "robots.drive",
    "robots.arena": "scenarios.errors",
}
"""Imports that go up a floor, to the room beside, and out of the house."""


def test_the_contracts_are_broken_by_a_floor_that_imports_what_lies_above_or_beside_it(tmp_path: Path) -> None:
    for house in HOUSES:
        shutil.copytree(ROOT / house, tmp_path / house, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    for importer, imported in WRONG.items():
        with (tmp_path / MODULES[importer].relative_to(ROOT)).open("a", encoding="utf-8") as file:
            file.write(f"\n\ndef _wrong() -> None:\n    import {imported}\n")
    command = [sys.executable, "-c", "from importlinter.cli import lint_imports_command as lint; lint()", "--no-cache"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1
    assert [pair for pair in WRONG.items() if " -> ".join(pair) not in done.stdout] == []


# Where heavy packages are loaded


@pytest.mark.parametrize("package", HEAVY_HOMES)
def test_a_heavy_package_is_imported_in_functions_or_at_home(package: str) -> None:
    loading = {
        module
        for module, path in MODULES.items()
        for name in imports(path, of_the_file_alone=True)
        if name.split(".")[0] == package
    }
    homes = HEAVY_HOMES[package]
    assert {module for module in loading if not any(f"{module}.".startswith(f"{home}.") for home in homes)} == set()


@pytest.mark.parametrize("module", ["formation", "robots", "scenarios.cli"])
def test_importing_loads_no_heavy_package(module: str) -> None:
    code = f"import sys, {module}; print(*({set(HEAVY_HOMES)} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize(
    "module", ["scenarios", "scenarios.replay", "scenarios.report.catalogue", "scenarios.studies.project"]
)
def test_what_computes_nothing_loads_no_numpy(module: str) -> None:
    code = f"import sys, {module}; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


# How much fits into a room


def test_the_ground_floor_holds_what_it_is_known_for() -> None:
    assert {path.stem for path in (ROOT / "scenarios").glob("*.py")} == GROUND


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_says_what_lives_there_what_does_not_and_what_it_offers(package: str) -> None:
    path = MODULES[package]
    tree = tree_of(path)
    assert DENIALS & set(re.findall(r"\w+", (ast.get_docstring(tree) or "").lower()))
    assert any(isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__" for node in tree.body)
    full = len([file for file in path.parent.glob("*.py") if file != path]) > MOST_FILES
    assert not full or package == "formation.laws"  # which has one law a file


@pytest.mark.parametrize("package", PACKAGES)
def test_everything_that_a_package_offers_is_there(package: str) -> None:
    tree = tree_of(MODULES[package])
    bound = {
        name.asname or name.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for name in node.names
    }
    bound |= {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
    bound |= {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    rooms = {module.removeprefix(f"{package}.") for module in MODULES if module.startswith(f"{package}.")}
    offered = importlib.import_module(package).__all__
    assert [name for name in offered if name not in bound | rooms | {"__version__"}] == []
    assert len(set(offered)) == len(offered)


@pytest.mark.parametrize("house", HOUSES)
def test_the_version_is_the_installed_one(house: str) -> None:
    assert importlib.import_module(house).__version__ == importlib.metadata.version("angle-formation")


def test_what_the_experiments_offer_is_what_their_rooms_have() -> None:
    from scenarios.definition.experiment import open_experiment
    from scenarios.measures.metrics import measure
    from scenarios.simulation.loop import simulate

    assert (scenarios.open_experiment, scenarios.simulate, scenarios.measure) == (open_experiment, simulate, measure)
    with pytest.raises(AttributeError, match="no attribute 'mesure'"):
        scenarios.mesure  # noqa: B018


def test_a_long_module_says_why() -> None:
    texts = {module: path.read_text(encoding="utf-8") for module, path in MODULES.items()}
    assert [m for m, text in texts.items() if len(text.splitlines()) > MOST_LINES and REASON not in text] == []
