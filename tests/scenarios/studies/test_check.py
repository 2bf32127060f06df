"""The comparison with baselines: what it catches, where it is exact, what it says and what it leaves behind."""

import json
import math
import shutil
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import formation.laws.angle
import scenarios.definition.parts.law
from formation import AngleLaw, TargetFormation
from scenarios import cli
from scenarios.definition.experiment import open_experiment
from scenarios.definition.load import LIBRARY, library
from scenarios.storage.run_folder import is_run
from scenarios.studies.check import baseline as baselines
from scenarios.studies.check import command
from scenarios.studies.check.baseline import Baseline, Case, default_cases
from scenarios.studies.check.machine import fingerprint, same_bits
from scenarios.studies.check.perturbed import PERTURBATION, perturbed
from scenarios.studies.check.quantities import distance
from scenarios.studies.check.update import update
from scenarios.work.processes import run_all

SHORT = ("duration_s=20",)
CASES = tuple(Case(plant=plant, seeds=(0,), changes=SHORT) for plant in ("saturated", "pymunk"))

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs the command line in this process: exit code, stdout, stderr."""
    monkeypatch.delenv(command.STEP_SUMMARY, raising=False)

    def formation(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr("sys.argv", ["formation", *map(str, arguments)])
        code = 0
        try:
            cli.main()
        except SystemExit as end:
            code = int(end.code or 0)
        return code, *capsys.readouterr()

    return formation


def nothing(done: int, total: int) -> None:
    """A progress bar that shows nothing."""


def plan(folder: Path, name: str, scenario: str, cases: tuple[Case, ...]) -> None:
    """A baseline file that says what to run and holds no run yet."""
    empty = Baseline(schema_version=1, scenario=scenario, scenario_sha256="", machine={}, cases=cases, runs=())
    baselines.write(folder / f"{name}.json", empty)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A user's folder: a scenario of their own, and its baselines."""
    folder = tmp_path_factory.mktemp("own")
    shutil.copy(LIBRARY / "shape.toml", folder / "shape.toml")
    plan(folder / "baselines", "shape", "../shape.toml", CASES)
    update(str(folder / "shape.toml"), folder / "baselines", 1, nothing)
    return folder


@pytest.fixture
def own(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of it that a test may damage, as the working folder."""
    monkeypatch.chdir(shutil.copytree(made, tmp_path / "own"))
    return tmp_path / "own"


@pytest.fixture
def no_folders(monkeypatch: pytest.MonkeyPatch) -> None:
    """Leave out the run folders of what was missed, which take most of the time: for tests of the verdict alone."""
    monkeypatch.setattr(command, "write_folders", lambda missed, out: {})


CHECK = ("check", "--baselines", "baselines", "--workers", 1)


def edit(path: Path, change: Callable[[dict], None]) -> None:
    content = json.loads(path.read_text(encoding="utf-8"))
    change(content)
    path.write_text(json.dumps(content), encoding="utf-8")


def test_an_unchanged_scenario_is_as_before_bit_for_bit(own: Path, run: Run) -> None:
    code, out, err = run(*CHECK)
    assert (code, err) == (0, "")
    assert "2 runs, all as before" in out
    assert "bit-identical" in out


def off_by_a_thousandth(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def tilted(target: TargetFormation, first_follower: str, own_gains: np.ndarray | None) -> AngleLaw:
        positions = target.positions.copy()
        turn = np.array([[math.cos(1e-3), -math.sin(1e-3)], [math.sin(1e-3), math.cos(1e-3)]])
        positions[5] = positions[3] + turn @ (positions[5] - positions[3])  # alpha(4;1,6) grows by 0.001 rad
        return AngleLaw(TargetFormation(target.graph, positions), first_follower, own_gains)

    monkeypatch.setattr(scenarios.definition.parts.law, "AngleLaw", tilted)


def sign_flipped(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gains = formation.laws.angle.follower_gains
    monkeypatch.setattr(formation.laws.angle, "follower_gains", lambda target: -gains(target))


def edited(own: Path, text: str) -> None:
    with (own / "shape.toml").open("a", encoding="utf-8") as file:
        file.write(text)


def projection_ten_percent_longer(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    edited(own, "\n[robot]\nprojection_distance_m = 0.0275\n")


def wheels_five_percent_slower(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    edited(own, "\n[robot]\nwheel_speed_limit_rad_s = 11.875\n")


def filter_off(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = (own / "shape.toml").read_text(encoding="utf-8")
    (own / "shape.toml").write_text(text.replace('filter = "decentralised"', 'filter = "none"'), encoding="utf-8")


@pytest.mark.parametrize(
    "mutation",
    [
        off_by_a_thousandth,
        sign_flipped,
        projection_ten_percent_longer,
        wheels_five_percent_slower,
        filter_off,
    ],
)
@pytest.mark.usefixtures("no_folders")
def test_a_mutation_is_caught_even_by_what_another_machine_is_allowed(
    mutation: Callable[[Path, pytest.MonkeyPatch], None], own: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    mutation(own, monkeypatch)
    code, out, err = run(*CHECK, "--portable")
    assert (code, err) == (1, "")
    assert "2 runs, 2 missed" in out


def test_a_thousandth_of_a_radian_is_reported_as_the_worst_angle_with_a_run_folder_to_replay(
    own: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    off_by_a_thousandth(own, monkeypatch)
    monkeypatch.setenv("COLUMNS", "200")
    code, out, _ = run(*CHECK)
    assert code == 1
    misses = [line for line in out[out.index("Missed") :].splitlines() if "final_rad" in line]
    assert "alpha(4;1,6)" in misses[0] or "alpha(6;1,4)" in misses[0]
    differences = [float(line.split()[-2]) for line in misses]
    assert differences == sorted(differences, reverse=True)
    assert differences[0] == pytest.approx(1e-3, rel=0.1)
    folders = [Path(line.split()[-1]) for line in out.splitlines() if line.startswith("formation replay")]
    assert sorted(path.name.split("-")[1] for path in folders) == ["pymunk", "saturated"]
    assert all(is_run(folder) and folder.parent == Path("runs/check") for folder in folders)


@pytest.mark.usefixtures("no_folders")
def test_the_last_digit_counts_on_the_same_machine_and_not_on_another(own: Path, run: Run) -> None:
    def nudge(content: dict) -> None:
        entry = content["runs"][0]["numbers"]["alpha(4;1,6).final_rad"]
        entry[0] = math.nextafter(entry[0], math.inf)

    edit(own / "baselines/shape.json", nudge)
    assert run(*CHECK)[0] == 1
    assert run(*CHECK, "--portable")[0] == 0

    edit(own / "baselines/shape.json", lambda content: content["machine"].update(processor="another"))
    code, out, _ = run(*CHECK)
    assert code == 0
    assert "processor another, here" in out


def test_a_release_of_this_project_does_not_make_another_machine() -> None:
    here = fingerprint()
    assert same_bits(here, {**here, "angle-formation": "99"})
    assert not same_bits(here, {**here, "numpy": "99"})


@pytest.mark.usefixtures("no_folders")
def test_texts_have_to_be_equal(own: Path, run: Run) -> None:
    edit(own / "baselines/shape.json", lambda content: content["runs"][0]["texts"].update(safety="another"))
    code, out, _ = run(*CHECK, "--portable")
    assert code == 1
    assert "safety" in out


def test_reports_say_what_the_terminal_says(own: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def settle_later(content: dict) -> None:
        content["runs"][1]["numbers"]["settling_time_s"][0] += 1.0

    edit(own / "baselines/shape.json", settle_later)
    summary = own / "step-summary.md"
    summary.write_text("before\n", encoding="utf-8")
    monkeypatch.setenv(command.STEP_SUMMARY, str(summary))
    code, _, _ = run(*CHECK, "--junit", "reports/junit.xml", "--markdown", "reports/check.md")
    assert code == 1
    root = ElementTree.parse(own / "reports/junit.xml").getroot()
    assert (root.get("tests"), root.get("failures")) == ("2", "1")
    [failure] = root.iter("failure")
    assert failure.get("message", "").startswith("settling_time_s: ")
    assert "formation replay runs/check/shape-pymunk-" in (failure.text or "")
    page = (own / "reports/check.md").read_text(encoding="utf-8")
    assert "2 runs, 1 missed" in page
    assert "| settling_time_s |" in page
    assert summary.read_text(encoding="utf-8") == f"before\n{page}"


def older(path: Path) -> None:
    edit(path, lambda content: content.update(schema_version=0))


def truncated(path: Path) -> None:
    path.write_text(path.read_text(encoding="utf-8")[:500], encoding="utf-8")


def unknown_key(path: Path) -> None:
    edit(path, lambda content: content["runs"][0].update(colour="red"))


def binary(path: Path) -> None:
    path.write_bytes(b"\xff\x00")


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (older, "schema_version: expected 1, got 0"),
        (truncated, "damaged"),
        (unknown_key, "colour"),
        (binary, "damaged"),
    ],
)
def test_a_baseline_that_cannot_be_used_is_one_line_and_is_not_overwritten(
    damage: Callable[[Path], None], says: str, own: Path, run: Run
) -> None:
    path = own / "baselines/shape.json"
    damage(path)
    content = path.read_bytes()
    for arguments in (CHECK, (*CHECK, "shape.toml", "--update")):
        code, out, err = run(*arguments)
        assert (code, out) == (2, "")
        assert err.count("\n") == 1
        assert says in err
        assert "baselines/shape.json" in err
        assert path.read_bytes() == content


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("check", "shpe"), "did you mean 'shape'?"),
        (("check", "--baselines", "nowhere"), "--baselines nowhere: no such folder"),
        (("check", "maneuver", "--baselines", "baselines"), "maneuver.json: no such baseline"),
        (("check", "--baselines", "."), "holds no baseline"),
        ((*CHECK, "--junit", "shape.toml/x.xml"), "--junit shape.toml/x.xml: cannot be written"),
        ((*CHECK, "--update", "--junit", "x.xml"), "--junit: not together with --update"),
    ],
)
def test_bad_input_is_one_line_before_anything_runs(
    arguments: tuple[object, ...], says: str, own: Path, run: Run
) -> None:
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert says in err
    assert err.count("\n") == 1


def test_what_was_computed_is_printed_and_written_even_where_run_folders_cannot_be(own: Path, run: Run) -> None:
    edit(own / "baselines/shape.json", lambda content: content["runs"][0]["texts"].update(outcome="diverged"))
    code, out, err = run(*CHECK, "--out", "shape.toml", "--junit", "junit.xml")
    assert code == 2
    assert "2 runs, 1 missed" in out
    assert "--out shape.toml" in err
    assert ElementTree.parse(own / "junit.xml").getroot().get("failures") == "1"


def test_update_keeps_the_cases_shows_the_difference_and_makes_check_pass(own: Path, run: Run) -> None:
    wheels_five_percent_slower(own, pytest.MonkeyPatch())
    code, out, _ = run(*CHECK, "--update")
    assert code == 0
    assert "2 runs, 0 new, 0 unchanged, 2 changed, 0 removed" in out
    assert ".final_rad" in out
    assert baselines.read(own / "baselines/shape.json").cases == CASES
    assert run(*CHECK)[0] == 0


def test_update_makes_a_baseline_for_a_new_scenario_and_names_its_path(own: Path, run: Run) -> None:
    text = (own / "shape.toml").read_text(encoding="utf-8").replace("duration_s = 60.0", "duration_s = 1.0")
    (own / "brief.toml").write_text(text, encoding="utf-8")
    assert run(*CHECK, "brief.toml", "--update")[0] == 0
    made = baselines.read(own / "baselines/brief.json")
    assert made.scenario == "../brief.toml"
    assert {run.plant for run in made.runs} == {"single_integrator", "unicycle", "saturated", "pymunk"}
    assert run(*CHECK)[0] == 0


def test_a_run_that_rounding_decides_is_left_out_with_the_reason(tmp_path: Path) -> None:
    # From these starts the distance law leaves an unstable equilibrium in a direction that the last digits choose.
    starts = {3: [-0.7, 0.5], 4: [0.3, -0.5], 5: [-1.0, -0.3], 6: [0.9, 0.2]}
    changes = ("safety.filter=none", *(f"agents.{agent}.start={start}" for agent, start in starts.items()))
    plan(tmp_path, "law-distance", "law-distance", (Case(plant="unicycle", seeds=(0,), changes=changes),))
    made = update("law-distance", tmp_path, 1, nothing).baseline
    assert made.runs == ()
    assert "rounding" in made.left_out[0].reason


def test_copies_differ_from_the_run_in_the_twelfth_digit_and_in_nothing_else() -> None:
    experiment = open_experiment("random-50")
    points, headings = experiment.starts.draw(np.random.default_rng(3))
    for copy in (1, 2):
        others = perturbed(experiment, copy).starts.draw(np.random.default_rng(3))
        for values, nudged in zip((points, headings), others, strict=True):
            np.testing.assert_allclose(nudged, values, rtol=1.01 * PERTURBATION, atol=0.0)
            assert (nudged != values).any()


@given(st.floats(0.0, 2.0 * math.pi), st.floats(-1e-3, 1e-3))
def test_angles_are_compared_round_the_circle(angle: float, change: float) -> None:
    turned = math.fmod(angle + change + 2.0 * math.pi, 2.0 * math.pi)
    assert distance("alpha(1;2,3).final_rad", angle, turned) == pytest.approx(abs(change), abs=1e-12)


def test_every_library_scenario_has_a_baseline_on_every_plant() -> None:
    assert [path.stem for path in baselines.baselines_in(baselines.FOLDER)] == library()
    for name in library():
        baseline = baselines.read(baselines.FOLDER / f"{name}.json")
        assert {case.plant for case in baseline.cases} == {case.plant for case in default_cases(open_experiment(name))}
        planned = {(case.plant, seed, case.changes) for case in baseline.cases for seed in case.seeds}
        assert {run.key for run in (*baseline.runs, *baseline.left_out)} == planned
        assert any(run.plant == "pymunk" for run in baseline.runs)


def test_a_library_scenario_is_as_its_committed_baseline_says(run: Run, tmp_path: Path) -> None:
    code, out, _ = run("check", "fastest", "--workers", 1, "--portable", "--out", tmp_path)
    assert code == 0, out


def test_tasks_come_back_in_order_from_processes() -> None:
    assert list(run_all(abs, [-3, -1, -2, -5], 2)) == [3, 1, 2, 5]
