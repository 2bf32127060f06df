"""What tests of exported scripts share: running one with our Robotarium in the place of the public one."""

import sys
import types
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from robots.robotarium import Robotarium, create_si_barrier_certificate_with_boundary
from robots.rps.version2.barrier_certificates import _solve_qp
from scenarios.definition.experiment import Experiment
from scenarios.export.script import script
from scenarios.simulation.loop import simulate

Runner = Callable[[str, str], Robotarium]
Names = dict[str, Any]


@pytest.fixture
def public(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], list[Robotarium]]:
    """Puts our Robotarium in the place of the public one, on a plant; the list gets what a script makes."""

    def install(plant: str) -> list[Robotarium]:
        made: list[Robotarium] = []

        def robotarium(**arguments: Any) -> Robotarium:
            made.append(Robotarium(plant=plant, **arguments))
            return made[-1]

        simulator, certificates = types.ModuleType("simulator"), types.ModuleType("certificates")
        vars(simulator)["Robotarium"] = robotarium
        vars(certificates)["_solve_qp"] = _solve_qp
        vars(certificates)["create_si_barrier_certificate_with_boundary"] = create_si_barrier_certificate_with_boundary
        for name in ("rps", "rps.utilities"):
            monkeypatch.setitem(sys.modules, name, types.ModuleType(name))
        monkeypatch.setitem(sys.modules, "rps.robotarium", simulator)
        monkeypatch.setitem(sys.modules, "rps.utilities.barrier_certificates", certificates)
        return made

    return install


@pytest.fixture
def on_testbed(public: Callable[[str], list[Robotarium]]) -> Runner:
    """Runs a script on a plant; its robots."""

    def run(text: str, plant: str) -> Robotarium:
        made, text = public(plant), text.replace("SHOW_FIGURE = True", "SHOW_FIGURE = False")
        exec(compile(text, "script", "exec"), {"__name__": "__main__"})
        (only,) = made
        return only

    return run


@pytest.fixture
def functions(public: Callable[[str], list[Robotarium]]) -> Callable[[str], Names]:
    """What a script defines, without running it."""

    def names(text: str) -> Names:
        public("saturated")
        found: Names = {"__name__": "script"}
        exec(compile(text, "script", "exec"), found)
        return found

    return names


@pytest.fixture
def moves_as_the_run(on_testbed: Runner) -> Callable[[Experiment, int, str, float], None]:
    """Same poses at every step. Rounding alone differs: the script computes in the common frame, not in each robot's,
    and from wrapped headings, and leaves a billionth of the wheels' speed unused."""

    def check(experiment: Experiment, seed: int, plant: str, atol: float) -> None:
        t, poses, _ = on_testbed(script(experiment, seed), plant).recorded()
        run = simulate(experiment, seed)
        assert len(t) == len(run.t)
        np.testing.assert_allclose(t, run.t, atol=1e-9)
        np.testing.assert_allclose(poses, run.poses, atol=atol)
        final, expected = (experiment.nid.project(p) for p in (poses[-1], run.poses[-1]))
        errors = [experiment.angles.errors(points, experiment.target_angles) for points in (final, expected)]
        np.testing.assert_allclose(*errors, atol=1e-7)

    return check
