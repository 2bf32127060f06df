"""Scripts for the Robotarium run unchanged, however they end, and leave a folder."""

import json
import random
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scenarios.simulation.script.execute import _children_as_python_has_them
from scenarios.storage import script_folder

Cli = Callable[..., tuple[int, str, str]]
HEAD = """
import numpy as np
import rps.robotarium as robotarium
start = np.array([[0.5, -0.5], [0.3, -0.3], [0.0, 1.0]])
r = robotarium.Robotarium(number_of_robots=2, show_figure=False, initial_conditions=start)
def go(steps, v=0.1):
    for _ in range(steps):
        r.get_poses()
        r.set_velocities(np.arange(2), np.array([[v, v], [0.0, 0.0]]))
        r.step()
"""


@pytest.fixture
def run(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[..., tuple[int, str, str, dict[str, object]]]:
    """Runs a script with these lines after the head: exit code, stdout, stderr and result.json.

    The overview is made where ``overview`` asks for it: drawing it takes five times what all else takes.
    """

    def script(
        lines: str, *options: str, head: str = HEAD, name: str = "mine", overview: bool = False
    ) -> tuple[int, str, str, dict]:
        if not overview:
            monkeypatch.setattr("scenarios.figures.scripts.overview.draw_overview", lambda *_: [])
        (tmp_path / f"{name}.py").write_text(head + lines, encoding="utf-8")
        code, out, err = cli("script", f"{name}.py", "--plant", "saturated", "--no-recording", *options)
        file = tmp_path / "runs" / f"{name}-saturated-seed0" / "result.json"
        return code, out, err, json.loads(file.read_text()) if file.exists() else {}

    return script


def test_a_script_runs_to_its_end_and_its_folder_has_what_happened(run: Callable, tmp_path: Path) -> None:
    code, out, _, result = run("go(30)\nr.debug()\n", overview=True)
    assert code == 0
    assert (result["kind"], result["outcome"], result["steps"], result["rps"]) == ("script", "ended", 30, 2)
    assert "would run this script" in out
    assert "testbed: accepted" in out
    kept = script_folder.read(tmp_path / "runs" / "mine-saturated-seed0")
    np.testing.assert_allclose(kept.record.poses[-1, 0], [0.5 + 30 * 0.0033, 0.3, 0.0], atol=1e-12)
    np.testing.assert_allclose(kept.record.commands[1:], np.tile([0.1, 0.0], (30, 2, 1)))
    assert (kept.folder / "script.py").read_bytes() == (tmp_path / "mine.py").read_bytes()
    assert (kept.folder / "figure-motion.png").exists()
    assert "rps" not in sys.modules


@pytest.mark.parametrize(
    ("lines", "code", "outcome", "words"),
    [
        ("go(5)\n1 / 0\n", 1, "raised", "ZeroDivisionError"),
        ("go(5)\nexit()\n", 0, "exited", "ended itself by exit()"),
        ("go(5)\nexit(3)\n", 1, "exited", "with code 3"),
        ("import os\ngo(5)\nos._exit(3)\n", 1, "exited", "with code 3"),
        ("go(5)\nraise SystemExit('no goal')\n", 1, "exited", "no goal"),
        ("go(5)\nraise KeyboardInterrupt\n", 130, "interrupted", "was interrupted"),
        ("import threading\nt = threading.Thread(target=go, args=(5,))\nt.start()\n", 0, "ended", "came to its end"),
        ("go(5)\nx = np.mat([1, 2])\n", 1, "raised", "hint: numpy 2 has no np.mat"),
        (
            "go(5)\nr.set_velocities([0], np.full((2, 1), np.nan))\n",
            1,
            "raised",
            "velocities of robot 0 must be finite",
        ),
        ("go(5)\nopen('gains.mat')\n", 1, "raised", "MATLAB file"),
        ("go(5)\nfrom rps.utilities.misc import at_pse\n", 1, "raised", "did you mean 'at_pose'?"),
        ("go(5)\nr.figure\n", 1, "raised", "hint: it is of generation 1 of rps: --rps 1"),
        ("go(5)\nimport sys\nsys.argv[1]\n", 1, "raised", "hint: arguments of the script come after --"),
        ("go(5)\nfrom . import helper\n", 1, "raised", "hint: Python starts a script outside of packages"),
        ("go(5)\nraise EOFError\n", 1, "raised", "hint: it asks for input"),
        ("go(5)\nr.get_poses()\nr.get_poses()\n", 1, "raised", "get_poses() was called twice"),
    ],
)
def test_however_a_script_ends_its_folder_has_what_was_done(
    lines: str, code: int, outcome: str, words: str, run: Callable
) -> None:
    found, out, _, result = run(lines)
    assert (found, result["outcome"], result["steps"]) == (code, outcome, 5)
    assert words in out
    assert "scenarios/" not in out, "the traceback is through the script's own lines"


def test_a_script_that_never_ends_is_stopped_when_its_time_is_over(run: Callable) -> None:
    code, out, _, result = run(
        "while True:\n    try:\n        go(1)\n    except Exception:\n        pass\n", "--duration", "1"
    )
    assert (code, result["outcome"], result["steps"]) == (0, "stopped", 31)
    assert "was stopped at the end of --duration" in out


def test_a_script_that_sleeps_and_steps_no_more_is_stopped_when_its_time_is_over(run: Callable) -> None:
    code, out, _, result = run("import time\ntime.sleep(0.9)\ngo(2)\nwhile True: time.sleep(0.3)\n", "--duration", "1")
    assert (code, result["outcome"], result["steps"]) == (0, "stopped", 2)
    assert "was stopped at the end of --duration" in out


def test_a_script_without_an_end_is_stopped_after_an_hour_of_its_own_time(
    run: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scenarios.simulation.script.execute.CONTROL_PERIOD", 600.0)
    code, _, _, result = run("while True:\n    go(1)\n")
    assert (code, result["outcome"], result["steps"]) == (0, "stopped", 6)


def test_an_animation_that_nobody_sees_is_told_of(run: Callable) -> None:
    lines = "import matplotlib.pyplot as plt\nfrom matplotlib.animation import FuncAnimation\ngo(2)\n"
    lines += "a = FuncAnimation(plt.figure(), lambda k: [], frames=3)\nplt.show()\nplt.close('all')\n"
    with pytest.warns(UserWarning, match="off screen an animation does not play"):
        code, _, _, result = run(lines)
    assert (code, result["steps"]) == (0, 2)


def test_processes_of_a_script_end_on_signals_as_pythons_do(monkeypatch: pytest.MonkeyPatch) -> None:
    registered: list[tuple[object, Callable[[object], None]]] = []
    monkeypatch.setattr("multiprocessing.util.register_after_fork", lambda *entry: registered.append(entry))
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}
    try:
        signal.signal(signal.SIGTERM, lambda *_: None)
        with _children_as_python_has_them():
            ((mark, forked),) = registered
            forked(mark)
        assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL
        assert signal.getsignal(signal.SIGINT) == signal.default_int_handler
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def test_more_robots_than_the_testbed_has_are_refused_in_one_line(run: Callable) -> None:
    code, _, err, result = run("", head="import rps.robotarium as r\nr.Robotarium(number_of_robots=51)\n")
    assert (code, result) == (2, {})
    assert err.count("\n") == 1
    assert "number_of_robots must be 1 to 50, got 51" in err


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("print 'hello'\n", "Python 2?"),
        ("x = (\n", "bad.py:1: not Python"),
        ("print('no robots')\n", "made no robots"),
        ("import rps.utilities.nonsense\n", "No module named 'rps.utilities.nonsense'; known: rps.robotarium"),
    ],
)
def test_what_is_no_script_for_the_testbed_is_refused(text: str, words: str, cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "bad.py").write_text(text)
    code, _, err = cli("script", "bad.py", "--no-recording")
    assert code == 2
    assert words in err
    assert not (tmp_path / "runs" / "bad-pymunk-seed0").exists()


def test_files_that_are_not_there_and_options_that_cannot_be_are_refused(cli: Cli, tmp_path: Path) -> None:
    for arguments, words in (
        (("absent.py",), "absent.py: cannot be read"),
        (("mine.m",), "MATLAB script"),
        ((".",), "a folder; expected a script in it, such as __main__.py"),
        (("mine.py", "--plant", "saturatd"), "did you mean 'saturated'?"),
        (("mine.py", "--drive-to-start", "--near-start"), "not together"),
    ):
        (tmp_path / "mine.py").write_text("")
        code, _, err = cli("script", *arguments)
        assert code == 2
        assert words in err


def test_run_points_to_where_scripts_run(cli: Cli) -> None:
    code, _, err = cli("run", "consensus.py")
    assert (code, err) == (
        2,
        "formation: consensus.py: a script, not a scenario; expected `formation script consensus.py`\n",
    )


def test_a_viewer_gets_the_robots_as_they_go(tmp_path: Path) -> None:
    import rerun as rr
    from rerun.chunk import RrdReader

    from robots.rps.version2.robotarium import Robotarium
    from scenarios.recording.script_live import ScriptView
    from scenarios.simulation.script.script_file import read

    (tmp_path / "mine.py").write_text(HEAD)
    view = ScriptView(read(tmp_path / "mine.py"), "saturated", 0, rr.FileSink(str(tmp_path / "seen.rrd")))
    robots = Robotarium(number_of_robots=2, plant="saturated", seed=0)
    view.begin(robots)
    for _ in range(3):
        robots.get_poses()
        robots.step()
        view.look(robots)
    assert view.finish()
    entities = {str(chunk.entity_path) for chunk in RrdReader(str(tmp_path / "seen.rrd")).stream()}
    assert {"/arena/world/robots/0", "/arena/world/robots/1", "/wheels/value"} <= entities


def test_a_script_gets_its_arguments_and_the_seed(run: Callable, tmp_path: Path) -> None:
    lines = "import sys, random\ngo(1)\nprint(sys.argv, __name__, np.random.rand(), random.random())\n"
    state = np.random.get_state()[1].tolist()  # noqa: NPY002
    expected = np.random.RandomState(7), random.Random(7)
    _, out, _, _ = run(lines, "--seed", "7", "--", "a", "--b")
    assert "['mine.py', 'a', '--b'] __main__" in out
    assert np.random.get_state()[1].tolist() == state  # noqa: NPY002
    expected[0].standard_normal(2 * 2 + 10 * 2)  # the sensors' noise of one step
    expected[1].sample(range(22), 2)  # the chargers
    assert f"{expected[0].rand()} {expected[1].random()}" in out


def test_names_tell_the_generation_and_so_the_wheels_base(run: Callable, tmp_path: Path) -> None:
    lines = "from rps.utilities.misc import *\nfrom rps.utilities.graph import cycle_GL\nprint('base', r.base_length)\n"
    _, out, _, result = run(lines + "go(1)\nat_pose(r.poses, r.poses)\nr.call_at_scripts_end()\n")
    assert result["rps"] == 1
    assert "base 0.105" in out
    assert "speaks rps 1, by at_pose" in out
    _, out, _, result = run("print('base', r.BASE_LENGTH)\ngo(1)\n", "--rps", "2")
    assert (result["rps"], "base 0.11" in out) == (2, True)


def test_modules_beside_a_script_are_its_own_and_tell_its_generation_too(run: Callable, tmp_path: Path) -> None:
    (tmp_path / "helper.py").write_text("from rps.utilities.controllers import create_clf_unicycle_pose_controller\n")
    _, _, _, result = run("import helper\ngo(1)\n")
    assert result["rps"] == 1
    assert "helper" not in sys.modules


def test_steps_take_their_time_on_the_scripts_clock_alone(run: Callable) -> None:
    began = time.perf_counter()
    _, out, _, _ = run(
        "import time\na = time.time()\ngo(100)\ntime.sleep(600)\nprint('took', round(time.time() - a, 2))\n"
    )
    assert "took 603.3" in out
    assert time.perf_counter() - began < 300.0
    assert abs(time.time() - time.clock_gettime(time.CLOCK_REALTIME)) < 1.0, "the clock is put back"


def test_figures_are_kept_and_over_time(run: Callable, tmp_path: Path) -> None:
    lines = "r._axes_handle.text(0, 0, 'hello')\nr._fig.canvas.draw_idle()\ngo(40)\nimport matplotlib.pyplot as plt\n"
    _, _, _, _ = run(lines + "plt.show()\nplt.figure()\nplt.plot([1, 2])\nplt.pause(5)\nplt.close('all')\n")
    folder = tmp_path / "runs" / "mine-saturated-seed0"
    assert (folder / "figure.png").read_bytes().startswith(b"\x89PNG")
    frames = script_folder.read(folder).frames
    np.testing.assert_allclose(frames.t, 0.033 * np.array([15, 30, 40]))
    assert all(picture.startswith(b"\x89PNG") for picture in frames.pictures)
    assert "hello" not in sys.modules


@pytest.mark.parametrize("option", ["--drive-to-start", "--near-start"])
def test_robots_come_to_their_start_as_the_testbed_brings_them(option: str, run: Callable, tmp_path: Path) -> None:
    _, out, _, result = run("go(1, 0.0)\n", option)
    record = script_folder.read(tmp_path / "runs" / "mine-saturated-seed0").record
    off = record.poses[0] - np.array([[0.5, 0.3, 0.0], [-0.5, -0.3, 1.0]])
    assert 1e-4 < np.hypot(*off[:, :2].T).max() <= 0.05
    assert np.abs(np.angle(np.exp(1j * off[:, 2]))).max() <= 0.2
    assert (result["steps"], result["start"]) == (1, "driven" if "drive" in option else "near")
    if result["start"] == "driven":
        assert "note: the robots came to their start in" in out


def test_a_script_that_asks_for_initialisation_is_told_once_that_it_gets_none(run: Callable) -> None:
    _, out, _, _ = run("go(1)\nrobotarium.Robotarium(number_of_robots=1)\n")
    assert out.count("note: the robots stand at their start at once") == 1
    assert "--drive-to-start" in out


def test_replay_alone_and_beside_another_plot_and_animate_work_on_the_folder(cli: Cli, tmp_path: Path) -> None:
    from rerun.chunk import RrdReader

    from scenarios.recording.content import recording_of
    from scenarios.recording.script import encode_scripts

    (tmp_path / "mine.py").write_text(HEAD + "r._axes_handle.text(0, 0, 'hi')\ngo(40)\n")
    assert cli("script", "mine.py", "--plant", "saturated", "--out", "run")[0] == 0
    chunks = RrdReader(str(tmp_path / "run" / "recording.rrd")).stream()
    entities = {str(chunk.entity_path) for chunk in chunks}
    for entity in ("/arena/world/robots/0", "/arena/world/robots/1", "/figure", "/summary", "/separation/value"):
        assert entity in entities
    assert "/arena/world/robots/2" not in entities
    written = (tmp_path / "run" / "recording.rrd").stat().st_size
    assert len(recording_of(tmp_path / "run")) == pytest.approx(written, rel=0.01)
    pair = tmp_path / "pair.rrd"
    pair.write_bytes(encode_scripts([script_folder.read(tmp_path / "run")] * 2))
    entities = {str(chunk.entity_path) for chunk in RrdReader(str(pair)).stream()}
    for entity in ("arena/world/robots/1", "figure", "summary", "separation/value"):
        assert {f"/A/{entity}", f"/B/{entity}"} < entities
    code, out, _ = cli("plot", "run", "--format", "svg")
    assert (code, out.strip()) == (0, "run/figure-motion.svg")
    code, out, _ = cli("animate", "run", "--fps", "5")
    assert (code, out.strip()) == (0, "run/animation.gif")
    assert (tmp_path / "run" / "animation.gif").read_bytes().startswith(b"GIF89a")


def test_the_verdict_tells_the_first_and_the_worst_of_each_violation(run: Callable) -> None:
    code, out, _, result = run("go(60, 0.15)\ngo(60, 0.2)\n" + "go(140, 0.2)\n")
    assert code == 1
    assert not result["testbed"]["accepted"]
    (violation,) = (each for each in result["testbed"]["violations"] if each["kind"] == "floor")
    assert violation["first"]["value"] < 0.01 < 0.1 < violation["worst"]["value"]
    assert f"leaves the floor by {violation['worst']['value']:.3f} m; worst at 8.58 s" in out


def test_the_keyboard_interrupts_a_script_and_the_folder_is_kept(run: Callable, tmp_path: Path) -> None:
    lines = "go(10)\nimport signal\nwhile True:\n    go(1, 0.0)\n    signal.raise_signal(signal.SIGINT)\n"
    code, _, _, result = run(lines)
    assert (code, result["outcome"], result["steps"]) == (130, "interrupted", 11)
    assert script_folder.read(tmp_path / "runs" / "mine-saturated-seed0").record.t[-1] == pytest.approx(11 * 0.033)
