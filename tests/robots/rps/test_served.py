"""What a script finds under the public simulator's names: the functions of its generation, then those of the other."""

import importlib
import inspect
import sys
from pathlib import Path
from typing import Any

import pytest

from robots.rps import hook
from robots.rps.session import Session, current, during

BOTH = ("barrier_certificates", "controllers", "graph", "misc", "transformations")
SERVED = {
    1: {f"utilities.{name}": name for name in (*BOTH, "barrier_certificates2", "uni_ekf")}
    | {"robotarium": "robotarium"},
    2: {f"utilities.{name}": name for name in (*BOTH, "sensors")}
    | {"robotarium": "robotarium", "robotarium_abc": "robotarium", "patch_creation.gternal_patch": "gternal_patch"},
}


def functions(version: int, module: str) -> dict[str, object]:
    """What a module of ours defines and does not hide."""
    ours = importlib.import_module(f"robots.rps.version{version}.{module}")
    return {
        name: value
        for name, value in vars(ours).items()
        if not name.startswith("_")
        and inspect.isroutine(value) | inspect.isclass(value)
        and value.__module__ == ours.__name__
    }


@pytest.mark.parametrize(("version", "rest"), [(version, rest) for version in SERVED for rest in SERVED[version]])
def test_a_module_has_the_functions_of_its_generation_and_the_others_that_it_has_not(version: Any, rest: str) -> None:
    served, own = hook.names(rest, version), functions(version, SERVED[version][rest])
    assert own
    assert {name: served[name] for name in own} == own
    other = 3 - version
    more = functions(other, SERVED[other][rest]) if rest in SERVED[other] else {}
    also = functions(version, "transformations") if rest in hook.ALSO else {}
    for name, value in more.items():
        if name not in own and name not in also:
            assert served[name] is value


def test_numpy_comes_along_everywhere_and_pyplot_where_scripts_of_version_one_get_it() -> None:
    import numpy as np

    for rest in hook.MODULES:
        for version in (1, 2):
            names = hook.names(rest, version)  # type: ignore[arg-type]
            assert names["np"] is np
            assert ("plt" in names) == (rest == "utilities.misc" and version == 1)
            assert not [name for name in names if name.startswith("_") and name != "_solve_qp"]


@pytest.mark.parametrize(("version", "word"), [(1, "1.0.0"), (2, "2.1.0")])
def test_the_version_is_said_by_the_package_and_by_its_module(version: Any, word: str) -> None:
    with hook.serving(version):
        assert importlib.import_module("rps").__version__ == word
        assert importlib.import_module("rps.__version__").__version__ == word
        assert importlib.import_module("rps.utilities").__path__ is not None
        assert not hasattr(importlib.import_module("rps.robotarium"), "__path__")
    assert not [name for name in sys.modules if name.split(".")[0] == "rps"]


def test_an_example_finds_the_modules_beside_it_and_a_script_elsewhere_is_told_what_is_missing(tmp_path: Path) -> None:
    folder = tmp_path / "rps" / "examples" / "one"
    folder.mkdir(parents=True)
    for name in ("rps/examples/__init__.py", "rps/examples/one/__init__.py"):
        (tmp_path / name).write_text("")
    (folder / "beside.py").write_text("VALUE = 7\n")
    with hook.serving(2, folder / "script.py"):
        assert importlib.import_module("rps.examples.one.beside").VALUE == 7
    for script in (None, tmp_path / "script.py", tmp_path / "examples" / "script.py"):
        with hook.serving(2, script), pytest.raises(ModuleNotFoundError, match="it is another example's"):
            importlib.import_module("rps.examples.one.beside")


def test_robots_belong_to_the_innermost_session_and_to_nobodys_outside() -> None:
    outside = current()
    assert (outside.plant, outside.start, outside.on_screen, outside.measured) == ("pymunk", "exact", False, None)
    one, other = Session("unicycle"), Session("saturated")
    with during(one):
        with during(other):
            assert current() is other
        assert current() is one
    assert current() is outside
