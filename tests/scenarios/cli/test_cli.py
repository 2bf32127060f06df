"""The command line as a hostile user knows it: one clear line on stderr, the right exit code, nothing half-written."""

import csv
import json
import os
import re
import resource
import shlex
import signal
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pymunk
import pytest

from robots import PLANTS
from robots.worlds import chipmunk
from scenarios import one_run, open_experiment
from scenarios.cli import BAD_INPUT, DONE, MISSED
from scenarios.definition.load import LIBRARY, library


class Answer(NamedTuple):
    code: int
    out: str
    err: str


Cli = Callable[..., Answer]


@pytest.fixture
def cli(cli: Callable[..., tuple[int, str, str]]) -> Cli:
    """Runs the command in an empty folder."""
    return lambda *arguments: Answer(*cli(*arguments))


def refused(answer: Answer, *words: str) -> None:
    """Exit code 2, nothing on stdout, one line on stderr with all the words."""
    assert answer.code == BAD_INPUT, answer
    assert answer.out == ""
    assert answer.err.startswith("formation: ")
    assert answer.err.count("\n") == 1
    assert len(answer.err) < 700
    for word in words:
        assert word in answer.err


def sets(*changes: str) -> list[str]:
    return [argument for change in changes for argument in ("--set", change)]


# What it does


def test_list_names_every_scenario_of_the_library(cli: Cli) -> None:
    answer = cli("list")
    assert answer.code == DONE
    assert [name for name in library() if f"\n{name} " not in answer.out] == []


@pytest.mark.parametrize("name", library())
def test_show_prints_assumptions_rates_and_end_of_every_scenario(cli: Cli, name: str) -> None:
    answer = cli("show", name)
    assert (answer.code, answer.err) == (DONE, "")
    lff, theory = "leader-first-follower" in answer.out, open_experiment(name).predicted or name == "own-law"
    rates = ("late rate (1/s)",) if lff and theory else ("sensing graph: holds",)
    predicted = ("Predicted end", "xi (m)") if open_experiment(name).predicted else ("no closed-form prediction",)
    for word in ("Assumptions", "alpha(", *rates, *predicted):
        assert word in answer.out
    if name in ("shape", "random-50"):
        assert "late rate: of the law alone" in answer.out


@pytest.mark.parametrize("plant", PLANTS)
@pytest.mark.parametrize("name", library())
def test_every_scenario_runs_for_a_second_on_every_plant(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, plant: str
) -> None:
    whole = plant == "pymunk"  # a recording and a figure take ten times as long as the run, whatever the plant
    if not whole:
        monkeypatch.setattr(one_run, "_draw_overview", lambda *_: None)
    recorded = () if whole else ("--no-recording",)
    answer = cli("run", name, "--plant", plant, "--duration", "1", "--seed", "3", *recorded)
    assert answer.code in (DONE, MISSED), answer
    assert answer.err == ""
    found = json.loads((tmp_path / "runs" / f"{name}-{plant}-seed3" / "result.json").read_text(encoding="utf-8"))
    assert (found["scenario"], found["plant"], found["seed"], found["duration_s"]) == (name, plant, 3, 1.0)


def test_a_run_that_reaches_its_goal_answers_0_and_one_that_does_not_1(cli: Cli) -> None:
    assert cli("run", "shape", "--plant", "unicycle", "--duration", "40").code == DONE
    assert cli("run", "shape", "--plant", "unicycle", "--duration", "1").code == MISSED


def test_a_sweep_prints_a_line_per_combination_and_a_whole_summary_where_nothing_is_varied(cli: Cli) -> None:
    short = ("sweep", "shape", "--seeds", "0:2", *sets("duration_s=0.2"), "--workers", "1")
    answer = cli(*short, "--vary", "plant.name=unicycle,pymunk", "--vary", "safety.filter=none,decentralised")
    assert (answer.code, answer.err) == (DONE, "")
    assert "8 runs, 2 of each combination" in answer.out
    assert re.search(r"rows: runs/sweep-shape-plant.name-safety.filter-seeds0-1-\w{6}/rows.csv\n", answer.out)
    lines = [line.split()[:2] for line in answer.out.splitlines()]
    for combination in (["unicycle", "none"], ["unicycle", "decentralised"], ["pymunk", "none"]):
        assert combination in lines
    answer = cli(*short)
    assert "settling time (s)" in answer.out
    assert re.search(r"rows: runs/sweep-shape-pymunk-seeds0-1-\w{6}/rows.csv\n", answer.out)


def test_a_rejected_run_misses_a_goal_that_asks_for_acceptance(cli: Cli) -> None:
    rejected = ("run", "shape", "--plant", "saturated", "--safety", "none", "--no-recording")
    assert cli(*rejected).code == DONE
    answer = cli(*rejected, *sets("goal.accepted=true"))
    assert (answer.code, answer.err) == (MISSED, "")
    assert "outcome: rejected" in answer.out


def test_a_run_with_noise_says_what_it_is_judged_by(cli: Cli) -> None:
    answer = cli("run", "shape", "--duration", "1", *sets("sensor.position_noise_m=0.01"), "--no-recording")
    assert "sensors are noisy: judged by the mean of each signed error over the last 10 s" in answer.out
    assert "sensors are noisy" not in cli("run", "shape", "--duration", "1", "--no-recording").out


def test_a_bare_command_and_help_print_the_commands(cli: Cli) -> None:
    for arguments in ((), ("--help",), ("-h",)):
        answer = cli(*arguments)
        assert answer.code == DONE
        assert "\n  list " in answer.out


def test_tables_are_whole_where_there_is_no_terminal(cli: Cli) -> None:
    assert "\u2026" not in cli("run", "shape", "--duration", "1").out
    assert "\u2026" not in cli("show", "shape").out


def test_square_brackets_in_a_title_are_text_and_no_markup(cli: Cli, tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = (LIBRARY / "shape.toml").read_text(encoding="utf-8")
    path.write_text("# [/b] comment\n" + text.replace('title = "', 'title = "[/red] '), encoding="utf-8")
    answer = cli("show", "./mine.toml")
    assert answer.code == DONE
    assert "[/red] Shape" in answer.out
    assert "[/b] comment" in answer.out


def test_a_diverged_run_is_told_without_a_warning(cli: Cli) -> None:
    slow = sets("plant.control_period_s=100")  # the Runge-Kutta steps multiply an error by millions each
    answer = cli("run", "shape", "--plant", "single_integrator", "--duration", "10000", *slow)
    assert (answer.code, answer.err) == (MISSED, "")
    assert "outcome: diverged" in answer.out


# What it refuses


@pytest.mark.parametrize("law", ["angle", "own"])
def test_a_version_of_pymunk_that_lacks_what_is_used_is_one_line(
    cli: Cli, monkeypatch: pytest.MonkeyPatch, law: str
) -> None:
    monkeypatch.setattr(chipmunk, "FUNCTIONS", (*chipmunk.FUNCTIONS, "cpOfLater"))
    name = "own-law" if law == "own" else "shape"  # by Python, and compiled
    words = (f"{name}: plant.name: pymunk: pymunk {pymunk.version} has no function cpOfLater: expected 7.1 to 7.3",)
    refused(cli("run", name), *words)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["lst"], ["no command named 'lst'", "did you mean 'list'?"]),
        (["show"], ["Missing argument 'SCENARIO'"]),
        (["show", "shpae"], ["no scenario named 'shpae'", "did you mean 'shape'?"]),
        (["show", ""], ["no scenario named ''"]),
        (["show", "../shape"], ["../shape"]),
        (["show", "/"], ["/: a folder, expected a scenario's name or file"]),
        (["show", str(LIBRARY / "shpae.toml")], ["shpae.toml: no such scenario file, did you mean 'shape.toml'?"]),
        (["show", "none.toml"], ["none.toml: no such scenario file"]),
        (["show", "a" * 300], ["no scenario named"]),
        (["show", "a" * 300 + ".toml"], ["cannot be read: File name too long"]),
        (["run", "shape", "extra"], ["unexpected extra argument"]),
        (["run", "shape", "--seed", "-1"], ["--seed", "-1"]),
        (["run", "shape", "--seed", "one"], ["--seed", "'one'"]),
        (["run", "shape", "--duration", "-1"], ["--duration: expected a positive number of seconds, got -1"]),
        (["run", "shape", "--duration", "0"], ["--duration"]),
        (["run", "shape", "--duration", "nan"], ["--duration"]),
        (["run", "shape", "--duration", "1e300"], ["--duration: expected at most 1000000 control periods"]),
        (["run", "shape", "--duration", "long"], ["--duration", "'long'"]),
        (["run", "shape", "--plant", "pymnk"], ["plant.name: expected 'single_integrator'", "got 'pymnk'"]),
        (["run", "shape", "--plant", 'a"b'], ["plant.name"]),
        (["run", "shape", "--bogus"], ["--bogus"]),
        (["sweep", "shape", "--seeds", "0:2", "--vary", "duration_s"], ["--vary duration_s: expected KEY=V1,V2"]),
        (["sweep", "shape", "--seeds", "0:2", "--vary", "duration=1,2"], ["unknown key, did you mean 'duration_s'?"]),
        (["sweep", "shape", "--seeds", "0:2", "--plant", "pymunk", "--vary", "plant.name=unicycle"], ["too"]),
        (["sweep", "shape", "--seeds", "0:2", "--scheduler", "here"], ["--scheduler here: expected an address"]),
        (["sweep", "shape", "--seeds", "0:2", "--scheduler", "tcp://a:1", "--workers", "2"], ["--workers: not"]),
    ],
)
def test_wrong_arguments(cli: Cli, tmp_path: Path, arguments: list[str], words: list[str]) -> None:
    refused(cli(*arguments), *words)
    assert os.listdir(tmp_path) == []


CHANGES = {
    "nonsense": ["expected key=value"],
    "=3": ["expected key=value"],
    "a..b=1": ["expected key=value"],
    "a=" + "[" * 3000: ["not a TOML value"],
    "duration_s=" + "1" * 5000: ["not a TOML value"],
    "durations=1": ["durations: unknown key, did you mean 'duration_s'?"],
    "plnt.name=x": ["plnt: unknown key, did you mean 'plant'?"],
    "robot.saturaton=clip": ["robot.saturaton: unknown key, did you mean 'saturation'?"],
    "plant=pymunk": ["plant: expected a table, got 'pymunk'"],
    "title=3": ["title: expected a valid string, got 3"],
    "title.x=3": ["title is not a table"],
    "agents=3": ["agents: expected an array, got 3"],
    "agents=[]": ["agents: expected either agents or random_formation"],
    "agents=[1, 2, 3]": ["agents[1]: expected a table, got 1"],
    "agents.3=1": ["agents is not a table"],
    "agents.9.start=[0, 0]": ["no entry 9"],
    "agents.3.strat=[0, 0]": ["agents[id 3].strat: unknown key, did you mean 'start'?"],
    "agents.3.start=[0]": ["agents[id 3].start[2]: missing"],
    "agents.3.start=[0, 0, 0]": ["agents[id 3].start: expected 2 entries"],
    "agents.3.start=[nan, 0]": ["agents[id 3].start[1]: expected a finite number, got nan"],
    "agents.3.start=[1e200, 0]": ["agents[id 3].start[1]: expected less than or equal to 1000000"],
    "agents.3.start=here": ["agents[id 3].start: expected an array, got 'here'"],
    "agents.3.target=[2, 0]": ["triangle (1, 2, 3) is degenerate", "agent 3"],
    "agents.2.start=[0.0, 0.5]": ["leader and first follower coincide"],
    "agents.2.target=[0, 0]": ["leader and first follower coincide"],
    "agents.3.neighbours=[1]": ["clause (i)", "agent 3"],
    "agents.3.neighbours=[1, 1]": ["clause (i)", "agent 3 senses agent 1 twice"],
    "agents.3.neighbours=[1, 4]": ["clause (ii)", "agent 3 senses agent 4"],
    "agents.3.neighbours=[1, 7]": ["edge (3, 7) names an agent outside 1..6"],
    "agents.3.neighbours=[1, 99999999999999999999]": ["agents[id 3].neighbours[2]"],
    "agents.1.neighbours=[2]": ["clause (ii)", "agent 1"],
    "agents.2.neighbours=[]": ["clause (i)", "agent 2 has 0 neighbours, expected 1"],
    "agents.3.id=4": ["agent 4 is listed twice"],
    "agents.3.id=9": ["agent 3 is missing"],
    "duration_s=true": ["duration_s: expected a valid number, got True"],
    'phases=[{name="a", duration_s=1.0}]': ["expected either duration_s or phases, got both"],
    "plant.control_period_s=1e-9": ["at most 1000000 control periods"],
    "arena.walls=1": ["arena.walls: expected a valid boolean"],
    "arena.x_m=[1, -1]": ["arena: x must be (low, high)"],
    "law.first_follower=bearing": ["law.first_follower: 'bearing' needs phases"],
    'target.angles_deg={"1;2,3"=91.0}': ["the target positions have 90.0000 degrees, got 91"],
    'target.angles_deg={"1;2,9"=91.0}': ["names agent 9 outside 1..6"],
}


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: change[:40])
def test_wrong_changes(cli: Cli, tmp_path: Path, change: str) -> None:
    refused(cli("run", "shape", "--duration", "1", *sets(change)), *CHANGES[change])
    assert os.listdir(tmp_path) == []


FILES = {
    b"": ["title: missing"],
    b"\xff\xfe\x00": ["not a text file in UTF-8"],
    b"x = [": ["not valid TOML"],
    b"x=" + b"[" * 5000 + b"]" * 5000: ["not valid TOML"],
    b"x=" + b"1" * 5000: ["not valid TOML"],
    b"agents = 3": ["title: missing"],
    b'title="a"\nduration_s=1\nagents=[{id=1},{id=2,neighbours=[1]}]': ["agents: expected at least 3, got 2"],
    b'title="a"\nduration_s=1\nagents=[{id=1},{id=2},{id=3}]': ["clause (i)", "agent 2"],
    b'title="a"\nagents=[{id=1},{id=2},{id=3}]': ["expected either duration_s or phases, got neither"],
    b'title="a"\nduration_s=1\nagents=[{id=1},{id=2,neighbours=[1]},{id=3,neighbours=[1,2]}]': [
        "target.angles_deg: missing, and the agents have no target positions either"
    ],
}


@pytest.mark.parametrize("content", FILES, ids=lambda content: repr(content[:30]))
def test_wrong_files(cli: Cli, tmp_path: Path, content: bytes) -> None:
    (tmp_path / "mine.toml").write_bytes(content)
    for command in ("show", "run"):
        refused(cli(command, "mine.toml"), "mine.toml: ", *FILES[content])
    assert os.listdir(tmp_path) == ["mine.toml"]


def test_every_key_of_a_scenario_misspelt_by_one_letter_is_offered_back(cli: Cli, tmp_path: Path) -> None:
    text = (LIBRARY / "shape.toml").read_text(encoding="utf-8")
    for key in (k for k in tomllib.loads(text) if k not in ("target",)):
        misspelt = text.replace(f"{key} =", f"{key}x =", 1).replace(f"[{key}]", f"[{key}x]", 1)
        (tmp_path / "mine.toml").write_text(misspelt, encoding="utf-8")
        refused(cli("show", "mine.toml"))
        refused(cli("show", "shape", *sets(f"{key}x=1")), f"unknown key, did you mean '{key}'?")


def test_a_sweep_names_the_seeds_that_miss_and_prints_the_command_that_runs_the_first(cli: Cli, tmp_path: Path) -> None:
    settings = ("--plant", "saturated", "--set", "safety.filter=none", "--set", "duration_s=14.4")
    answer = cli("sweep", "shape", "--seeds", "0:14", *settings, "--out", "sweep")
    with (tmp_path / "sweep" / "rows.csv").open(encoding="utf-8") as file:
        missed = [row["seed"] for row in csv.DictReader(file) if row["outcome"] != "converged"]
    assert 0 < len(missed) < 10
    assert f"not converged: seeds {', '.join(missed)}\n" in answer.out
    (command,) = [line.split(": ", 1)[1] for line in answer.out.splitlines() if line.startswith("to see the first: ")]
    formation, *arguments = shlex.split(command)
    again = cli(*arguments, "--no-recording", "--out", "run")
    assert (formation, again.code) == ("formation", MISSED)
    assert json.loads((tmp_path / "run" / "result.json").read_text(encoding="utf-8"))["seed"] == int(missed[0])


def test_output_that_cannot_be_written_is_refused_before_the_run(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine", encoding="utf-8")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.tex").write_text("mine", encoding="utf-8")
    for out, words in {
        "file": "exists and is not a run folder",
        "full": "exists and is not a run folder",
        ".": "exists and is not a run folder",
        "/": "exists and is not a run folder",
        "file/run": "cannot be written",
        "a" * 300: "cannot be written: File name too long",
    }.items():
        refused(cli("run", "shape", "--out", out), f"--out {out}: ", words)
    assert sorted(os.listdir(tmp_path)) == ["file", "full"]
    assert (tmp_path / "file").read_text(encoding="utf-8") == "mine"
    assert os.listdir(tmp_path / "full") == ["thesis.tex"]


def formation(*arguments: str, folder: Path, before: str = "") -> subprocess.Popen[str]:
    """The command in a process of its own; ``before`` is Python that it runs first."""
    code = (
        f"import sys, signal; {before}; from scenarios.cli import main; sys.argv = ['formation', *sys.argv[1:]]; main()"
    )
    return subprocess.Popen(
        [sys.executable, "-c", code, *arguments], cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


def test_python_m_scenarios_is_the_same_command_with_the_same_exit_codes(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "scenarios", "show", "shpae"], cwd=tmp_path, capture_output=True, text=True
    )
    refused(Answer(done.returncode, done.stdout, done.stderr), "did you mean 'shape'?")


def test_ctrl_c_ends_a_run_without_traceback_and_leaves_nothing(tmp_path: Path) -> None:
    """The run sends the signal to itself in the middle of its loop, so that nothing depends on time."""
    interrupt = (
        "signal.signal(signal.SIGINT, signal.default_int_handler); import scenarios.one_run, os; "
        "scenarios.one_run.measure = lambda *_: os.kill(os.getpid(), signal.SIGINT)"
    )
    process = formation("run", "shape", "--duration", "1", "--out", "mine", folder=tmp_path, before=interrupt)
    _, err = process.communicate(timeout=60)
    assert process.returncode == 128 + signal.SIGINT
    assert "Traceback" not in err
    assert os.listdir(tmp_path) == []


@pytest.mark.skipif(not hasattr(resource, "RLIMIT_FSIZE"), reason="needs a limit on the size of files")
def test_a_full_disk_is_one_clear_line_and_leaves_nothing(tmp_path: Path) -> None:
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))"
    process = formation("run", "shape", "--duration", "5", "--out", "mine", folder=tmp_path, before=limit)
    out, err = process.communicate(timeout=60)
    refused(Answer(process.returncode, out.strip(), err), "--out mine: cannot be written")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(("given", "found"), [({}, "1"), ({"OMP_NUM_THREADS": "3"}, None)])
def test_numpy_has_one_thread_unless_the_user_says_otherwise(given: dict[str, str], found: str | None) -> None:
    free = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    code = (
        "import sys; sys.argv = ['formation', 'list']; from scenarios.cli.main import main\n"
        "before = 'numpy' in sys.modules\n"
        "try: main()\nexcept SystemExit: pass\n"
        "import os; print(before, os.environ.get('OPENBLAS_NUM_THREADS'), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], env=free | given, capture_output=True, text=True, timeout=60)
    assert done.stderr == f"False {found}\n"
