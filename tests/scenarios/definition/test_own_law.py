"""A user's own law: what a run of it keeps, what is refused in one line, and that looking at a run executes nothing."""

import csv
import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from formation import AngleLaw
from robots.worlds import NOTHING
from scenarios.cli import BAD_INPUT, DONE
from scenarios.definition.experiment import open_experiment
from scenarios.definition.load import LIBRARY, load
from scenarios.definition.own_law import NotLoaded, OwnLaw
from scenarios.errors import InputError
from scenarios.measures.metrics import measure
from scenarios.measures.predictions.forecast import forecast
from scenarios.measures.result import result
from scenarios.simulation.loop import simulate, step_by_step
from scenarios.storage import run_folder

ANGLE = """
from formation import AngleLaw

class MyLaw:
    needs_compass = False

    def __init__(self, target, gain=1.0):
        if gain <= 0.0:
            raise ValueError("gain must be positive")
        self.law, self.gain = AngleLaw(target), gain

    def __call__(self, relative, compass, delta):
        return self.gain * self.law(relative)
"""

HEAD = """
import numpy as np

class MyLaw:
    needs_compass = False

    def __init__(self, target):
        self.n = target.graph.n

"""

CALL = "    def __call__(self, relative, compass, delta):\n        "

TIRED = """
import numpy as np

class MyLaw:
    needs_compass = False

    def __init__(self, target, lasts=20):
        self.calls, self.lasts = 0, lasts

    def __call__(self, relative, compass, delta):
        self.calls += 1
        if self.calls > self.lasts:
            raise RuntimeError("too\\nmuch")
        return np.zeros((6, 2))
"""

ONE_BY_ONE = ANGLE.replace("return", "assert relative.ndim == 2; return")

Cli = Callable[..., tuple[int, str, str]]


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., str]:
    """Writes a law, and the scenario `shape` with it, into an empty working folder; returns the scenario's name."""
    monkeypatch.chdir(tmp_path)

    def write(source: str | bytes = ANGLE, table: str = 'name="own"\nfile="my_law.py"\nfactory="MyLaw"') -> str:
        (tmp_path / "my_law.py").write_bytes(source if isinstance(source, bytes) else source.encode())
        text = (LIBRARY / "shape.toml").read_text(encoding="utf-8")
        (tmp_path / "mine.toml").write_text(f"{text}\n[law]\n{table}\n", encoding="utf-8")
        return "./mine.toml"

    return write


# What it does


def test_an_own_law_that_is_the_angle_law_moves_as_the_angle_law_bit_for_bit(own: Callable[..., str]) -> None:
    mine, shape = (step_by_step(open_experiment(s, duration=1.0), 5) for s in (own(), "shape"))
    assert mine.poses.tobytes() == shape.poses.tobytes()


def test_the_law_in_the_documents_is_the_angle_law_with_a_gain(own: Callable[..., str]) -> None:
    page = (Path(__file__).parents[3] / "docs" / "own-law.md").read_text(encoding="utf-8")
    printed = page.split("```python\n")[1].split("```")[0]
    law = open_experiment(own(printed), ("law.parameters.gain=2",)).law
    relative = np.random.default_rng(0).normal(size=(4, 9, 2))
    np.testing.assert_allclose(law(relative), 2.0 * AngleLaw(open_experiment("shape").target)(relative), atol=1e-12)
    assert isinstance(law, OwnLaw)
    assert law.batched


def test_parameters_reach_the_factory_from_the_file_and_from_the_command_line(own: Callable[..., str]) -> None:
    name = own(table='name="own"\nfile="my_law.py"\nfactory="MyLaw"\nparameters={gain=2.0}')
    assert open_experiment(name).law.raw.gain == 2.0  # type: ignore[attr-defined]
    assert open_experiment(name, ("law.parameters.gain=3",)).law.raw.gain == 3.0  # type: ignore[attr-defined]


def test_a_factory_may_be_a_function_and_its_law_a_dataclass(own: Callable[..., str]) -> None:
    """A dataclass with postponed annotations looks its module up in sys.modules."""
    source = """
from __future__ import annotations
from dataclasses import dataclass
from formation import AngleLaw

@dataclass(frozen=True)
class Law:
    inner: AngleLaw
    needs_compass: bool = False

    def __call__(self, relative, compass=None, delta=None):
        return self.inner(relative)

def MyLaw(target):
    return Law(AngleLaw(target))
"""
    before = list(sys.path)
    assert isinstance(open_experiment(own(source)).law, OwnLaw)
    assert sys.path == before
    assert not Path("__pycache__").exists()


def test_the_path_of_a_law_starts_at_its_scenario_wherever_the_command_is_given(
    own: Callable[..., str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert isinstance(open_experiment("../mine.toml").law, OwnLaw)


def test_a_phase_hands_its_displacement_and_a_law_that_asks_for_one_its_compass(own: Callable[..., str]) -> None:
    source = ANGLE.replace("needs_compass = False", "needs_compass = True").replace(
        "AngleLaw(target)", 'AngleLaw(target, "displacement")'
    )
    source = source.replace("self.law(relative)", "self.law(relative, compass, delta)")
    table = '[law]\nname="own"\nfile="my_law.py"\nfactory="MyLaw"'
    text = (LIBRARY / "maneuver.toml").read_text(encoding="utf-8")
    text = text.replace('[law]\nfirst_follower = "displacement"', table)
    assert table in text
    own(source)
    Path("mine.toml").write_text(text, encoding="utf-8")
    mine, paper = (step_by_step(open_experiment(s, duration=1.0), 5) for s in ("./mine.toml", "maneuver"))
    assert mine.poses.tobytes() == paper.poses.tobytes()


def test_a_law_without_batch_dimensions_sweeps_as_one_with_them(own: Callable[..., str]) -> None:
    changes = ("plant.name=single_integrator", "duration_s=2")
    together = open_experiment(own(), changes)
    batch = simulate(together, range(3))
    apart = open_experiment(own(ONE_BY_ONE), changes)
    one_by_one = simulate(apart, range(3))
    assert isinstance(together.law, OwnLaw)
    assert isinstance(apart.law, OwnLaw)
    assert (together.law.batched, apart.law.batched) == (True, False)
    np.testing.assert_allclose(one_by_one.points, batch.points, atol=1e-12)


def test_nan_is_an_outcome_and_no_error_and_no_warning(own: Callable[..., str]) -> None:
    source = HEAD + CALL + "return np.full((self.n, 2), 1.0) / 0.0"
    experiment = open_experiment(own(source), ("plant.name=unicycle",), 1.0)
    assert measure(experiment, simulate(experiment)).outcome == "diverged"


def test_a_law_answers_with_a_copy_and_cannot_write_into_what_it_measures(own: Callable[..., str]) -> None:
    kept = HEAD + "        self.u = np.zeros((6, 2))\n" + CALL + "return self.u"
    law = open_experiment(own(kept)).law
    law(np.zeros((9, 2)))[:] = 7.0
    assert not law(np.zeros((9, 2))).any()
    writes = HEAD + CALL + "relative[0] = 0.0"
    with pytest.raises(InputError, match=r"my_law\.py:11: a call of the law raised ValueError: assignment destination"):
        open_experiment(own(writes))


# The digest and the run folder


def test_the_digest_follows_the_laws_source_and_not_its_place(own: Callable[..., str]) -> None:
    digest = load(own()).sha256
    Path("moved.py").write_text(ANGLE, encoding="utf-8")
    assert load("./mine.toml", ["law.file=moved.py"]).sha256 == digest
    assert load(own(ANGLE + "# changed\n")).sha256 != digest
    assert load(own(), ["law.parameters.gain=2"]).sha256 != digest


def test_a_run_folder_is_read_without_the_users_file_and_without_executing_anything(
    own: Callable[..., str], cli: Cli
) -> None:
    source = ANGLE + "\nimport pathlib\n\npathlib.Path('executed').touch()\n"
    code, _, err = cli("run", own(source), "--out", "run", "--duration", "1", "--plant", "unicycle")
    assert (code, err) == (1, "")
    Path("executed").unlink()
    Path("my_law.py").unlink()
    Path("mine.toml").unlink()
    assert Path("run/law.py").read_text(encoding="utf-8") == source
    again = run_folder.read(Path("run"))
    assert again.experiment.file.sha256 == again.result["scenario_sha256"]
    assert isinstance(again.experiment.law, NotLoaded)
    assert cli("plot", "run", "--format", "png")[0] == DONE
    assert not Path("executed").exists()
    with pytest.raises(InputError, match="cannot run"):
        simulate(again.experiment)


def test_a_run_that_fails_in_the_middle_is_one_line_and_leaves_nothing(own: Callable[..., str], cli: Cli) -> None:
    code, out, err = cli("run", own(TIRED), "--duration", "3", "--out", "run")
    assert (code, out) == (BAD_INPUT, "")
    assert err == "formation: my_law.py:13: a call of the law raised RuntimeError: too much\n"
    assert sorted(path.name for path in Path().iterdir()) == ["mine.toml", "my_law.py"]


def test_worker_processes_load_the_law_and_tell_its_mistakes(own: Callable[..., str], cli: Cli) -> None:
    sweep = ("sweep", own(TIRED), "--seeds", "0:2", "--set", "duration_s=1", "--workers", "2", "--out", "s")
    code, out, err = cli(*sweep, "--vary", "law.parameters.lasts=20,1000")
    assert (code, err) == (DONE, "")
    with Path("s/rows.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    found = [(row["law.parameters.lasts"], row["outcome"] == "failed") for row in rows]
    assert found == [("20", True), ("20", True), ("1000", False), ("1000", False)]
    failed = "failed with law.parameters.lasts=20: seeds 0, 1: my_law.py:13: a call of the law raised RuntimeError"
    assert f"{failed}: too much\n" in out
    again = "formation run ./mine.toml --seed 0 --set duration_s=1 --set law.parameters.lasts=20"
    assert f"to see the first: {again}  # could not be made\n" in out


def test_nothing_is_predicted_of_an_own_law(own: Callable[..., str], cli: Cli) -> None:
    experiment = open_experiment(own(), ("plant.name=unicycle",), 1.0)
    assert forecast(experiment, experiment.initial_points(0))[0].error_sum is None
    trajectory = simulate(experiment)
    phase = result(experiment, 0, trajectory, measure(experiment, trajectory))["phases"][0]
    assert [phase[key] for key in ("predicted_m", "distance_m", "scale_error", "translation_error_m")] == [None] * 4
    assert json.dumps(phase["measured_m"])
    for command in ("show", "run"):
        out = cli(command, "./mine.toml", *(["--duration", "1", "--no-recording"] if command == "run" else []))[1]
        assert "no closed-form prediction for an own law" in out
        assert "Predicted end of each phase" not in out


# What is refused

OWN = 'name="own"\nfile="my_law.py"\nfactory="MyLaw"'
SOURCES = {
    "def MyLaw(:": ["my_law.py:1: not valid Python: "],
    "\n\nx = = 1": ["my_law.py:3: not valid Python: "],
    b"x = '\xff'": ["my_law.py", "not valid Python", "utf-8"],
    b"x = 1\0": ["my_law.py", "not valid Python", "null byte"],
    "import numpyy": ["my_law.py:1: executing the file raised ModuleNotFoundError: No module named 'numpyy'"],
    "x = 1\ny = x / 0": ["my_law.py:2: executing the file raised ZeroDivisionError"],
    "import sys\nsys.exit(0)": ["my_law.py:2: executing the file raised SystemExit"],
    "": ["mine.toml: law.factory: my_law.py has no function or class 'MyLaw', it has none at all"],
    "class MyLwa: pass": ["law.factory", "did you mean 'MyLwa'?"],
    "MyLaw = 3": ["law.factory: my_law.py has no function or class 'MyLaw'"],
    "def MyLaw(): pass": ["my_law.py: MyLaw(target) raised TypeError"],
    "def MyLaw(target, gain): pass": ["mine.toml: law.parameters.gain: missing, MyLaw needs it"],
    "def MyLaw(target):\n    return target.grph": ["my_law.py:2: MyLaw(target) raised AttributeError"],
    "def MyLaw(target): return None": ["my_law.py: expected a law that can be called, got NoneType"],
    "def MyLaw(target): return lambda *_: 0": ["my_law.py: function.needs_compass: missing, expected True or False"],
    HEAD.replace("False", "0") + CALL + "pass": ["my_law.py: MyLaw.needs_compass: expected bool, got 0"],
    HEAD: ["my_law.py: expected a law that can be called, got MyLaw without __call__"],
    HEAD + CALL + "return None": ["my_law.py: expected velocities of the shape (6, 2), got ()"],
    HEAD + CALL + "return relative": ["my_law.py: expected velocities of the shape (6, 2), got (9, 2)"],
    HEAD + CALL + "return np.zeros((6, 2), complex)": ["expected velocities that are real floats, got complex128"],
    HEAD + CALL + "return np.zeros((6, 2), int)": ["expected velocities that are real floats, got int64"],
    HEAD + CALL + "return np.full((6, 2), 'a')": ["expected velocities that are real floats, got <U1"],
    HEAD + CALL + "return [[1.0], [1.0, 2.0]]": ["my_law.py", "a call of the law raised ValueError"],
    HEAD + CALL + "return relative[20]": ["my_law.py:11: a call of the law raised IndexError: index 20 is out of"],
    HEAD + CALL + "return delta[0]": ["my_law.py:11: a call of the law raised TypeError"],
    HEAD + "    def __call__(self, relative): return relative": ["my_law.py: a call of the law raised TypeError"],
    HEAD + CALL + "raise ValueError('x' * 5000)": ["my_law.py:11: a call of the law raised ValueError: xxx", "..."],
}


@pytest.mark.parametrize("source", SOURCES, ids=lambda source: repr(source[-30:]))
def test_a_mistake_in_the_file_is_one_line_with_its_place(own: Callable[..., str], cli: Cli, source: str) -> None:
    name = own(source)
    for command in (("show", name), ("run", name, "--duration", "1"), ("audit", name)):
        code, out, err = cli(*command)
        assert (code, out) == (BAD_INPUT, "")
        assert err.startswith("formation: ")
        assert err.count("\n") == 1
        assert len(err) < 400
        assert [word for word in SOURCES[source] if word not in err] == [], err
    assert sorted(path.name for path in Path().iterdir()) == ["mine.toml", "my_law.py"]


TABLES = {
    'name="own"': 'law.file: missing, the law "own" needs it',
    'name="own"\nfile="my_law.py"': 'law.factory: missing, the law "own" needs it',
    'name="own"\nfactory="MyLaw"': 'law.file: missing, the law "own" needs it',
    'file="my_law.py"': 'law.file: only for law.name = "own", got "angle"',
    'file=""': 'law.file: only for law.name = "own", got "angle"',
    'name="bearing"\nfactory="MyLaw"': 'law.factory: only for law.name = "own", got "bearing"',
    "parameters={gain=1.0}": "law.parameters.gain: not a parameter of the angle law, it takes none",
    'name="own"\nfile="none.py"\nfactory="MyLaw"': "law.file: no such file: none.py",
    'name="own"\nfile="."\nfactory="MyLaw"': "law.file: . cannot be read: Is a directory",
    'name="own"\nfile="a\\u0000"\nfactory="MyLaw"': "law.file",
    f"{OWN}\nparameters={{gian=1.0}}": "law.parameters.gian: not a parameter of MyLaw, did you mean 'gain'?",
    f'{OWN}\nparameters={{gain="1"}}': "law.parameters.gain: expected a valid number, got '1'",
    f"{OWN}\nparameters={{gain=true}}": "law.parameters.gain: expected a valid number, got True",
    f"{OWN}\nparameters={{gain=-1}}": "my_law.py:9: MyLaw(target, gain=-1) raised ValueError: gain must be positive",
    f'{OWN}\nfirst_follower="bearing"': "law.first_follower: an own law says itself what agent 2 does",
}


@pytest.mark.parametrize("table", TABLES)
def test_a_mistake_in_the_table_is_one_line_with_its_key(own: Callable[..., str], cli: Cli, table: str) -> None:
    code, out, err = cli("show", own(table=table))
    assert (code, out, err.count("\n")) == (BAD_INPUT, "", 1)
    assert TABLES[table] in err


def test_a_phase_must_not_send_agents_1_and_2_to_one_place(own: Callable[..., str]) -> None:
    own()
    phases = 'phases=[{name="a", duration_s=1.0, displacement_m=[0, 0]}]'
    text = Path("mine.toml").read_text(encoding="utf-8").replace("duration_s = 60.0", phases)
    Path("mine.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"phases\[1\]\.displacement_m: agents 1 and 2 must not be sent to one place"):
        open_experiment("./mine.toml")


# The example


def test_the_example_is_eq_u_near_the_shape_and_no_faster_than_its_bound_anywhere() -> None:
    experiment = open_experiment("own-law", ("law.parameters.v_max=0.05",))
    angle, rng = AngleLaw(experiment.target), np.random.default_rng(0)
    observer, observed = experiment.graph.edges.T
    for spread in (1e-5, 1.0, 1e3):
        p = experiment.target.positions + rng.normal(0.0, spread, (200, 6, 2))
        relative = p[:, observed] - p[:, observer]
        u, paper = experiment.law(relative), angle(relative)
        assert np.linalg.norm(u, axis=-1).max() <= 0.05 * (1.0 + 1e-12)
        cross = u[..., 0] * paper[..., 1] - u[..., 1] * paper[..., 0]
        np.testing.assert_allclose(cross, 0.0, atol=1e-12 * spread)
        assert ((u * paper).sum(axis=-1) >= 0.0).all()
        if spread < 1e-3:
            np.testing.assert_allclose(u, paper, atol=1e-9)
    assert not experiment.law(np.zeros((9, 2))).any()


@pytest.mark.slow
def test_the_example_converges_among_bodies_with_the_filter() -> None:
    experiment = open_experiment("own-law")
    for seed in range(3):
        trajectory = simulate(experiment, seed)
        assert measure(experiment, trajectory).outcome == "converged"
        assert (trajectory.contact == NOTHING).all()


def test_the_example_says_what_is_wrong_with_its_bound() -> None:
    with pytest.raises(InputError, match=r"bounded_angle_law\.py:\d+: BoundedAngleLaw\(target, v_max=0\) raised Value"):
        open_experiment("own-law", ("law.parameters.v_max=0",))


BEARINGS = '''
import numpy as np

class MyLaw:
    """Every agent goes against what is left of the wanted bearings across those that it measures."""

    needs_compass, needs_handedness = True, True
    measures = ("bearing",)
    graph = "undirected"

    def __init__(self, target):
        self.k, i = target.graph.edges.T
        e = target.positions[i] - target.positions[self.k]
        self.wanted, self.n = e / np.linalg.norm(e, axis=1, keepdims=True), target.graph.n

    def __call__(self, bearing, compass, delta):
        c, s = compass[..., self.k, 0], compass[..., self.k, 1]
        x, y = self.wanted.T
        wanted = np.stack([c * x - s * y, s * x + c * y], axis=-1)
        left = (bearing * wanted).sum(axis=-1, keepdims=True) * bearing - wanted
        u = np.zeros((*bearing.shape[:-2], self.n, 2))
        for agent in range(self.n):
            u[..., agent, :] = left[..., self.k == agent, :].sum(axis=-2)
        return u
'''


def test_an_own_law_may_measure_bearings_on_an_undirected_graph_and_is_audited_and_swept(
    own: Callable[..., str], cli: Cli
) -> None:
    name = own(BEARINGS, f"{OWN}")
    text = Path("mine.toml").read_text(encoding="utf-8")
    Path("mine.toml").write_text(
        text.replace("duration_s = 60.0", 'duration_s = 60.0\ngraph = "design"'), encoding="utf-8"
    )
    code, out, err = cli("audit", name, "--starts", "0")
    assert (code, err) == (DONE, ""), out
    assert "undirected, as declared" in out
    assert "bearing: all used" in out
    here = ("plant.name=single_integrator", "duration_s=3")
    mine, built_in = (
        simulate(open_experiment(name, (*here, *law)), range(3)).points
        for law in ((), ('law={name="bearing-undirected"}',))
    )
    np.testing.assert_allclose(mine, built_in, atol=1e-9)
    code, out, err = cli("sweep", name, "--seeds", "0:2", "--set", "duration_s=1", "--workers", "1")
    assert (code, err) == (DONE, "")


def test_a_kind_of_measurement_that_does_not_exist_is_named(own: Callable[..., str]) -> None:
    with pytest.raises(InputError, match=r"MyLaw\.measures: no such kind 'bearings', did you mean 'bearing'"):
        open_experiment(own(BEARINGS.replace('("bearing",)', '("bearings",)'), OWN), ('graph="design"',))
