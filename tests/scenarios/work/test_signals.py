"""A command that is asked to end does so in order: its exit code, no traceback, nothing left behind."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from scenarios.definition.load import LIBRARY
from scenarios.work.signals import INTERRUPTED, TERMINATED

CODES = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}

ENTRY = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); import os; "
"""What runs first: test runners in the background of a script ignore interrupts, and so would the command."""


def formation(*arguments: str, folder: Path, before: str) -> subprocess.CompletedProcess[str]:
    """The command as it is installed, after some Python in its process."""
    code = f"{ENTRY}{before}; from scenarios.__main__ import main; sys.argv = ['formation', *sys.argv[1:]]; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], cwd=folder, capture_output=True, text=True, timeout=300, check=False
    )


@pytest.mark.parametrize("number", CODES)
def test_a_run_that_is_asked_to_end_in_its_middle_leaves_nothing(tmp_path: Path, number: signal.Signals) -> None:
    """The run sends the signal to itself, so that nothing depends on time."""
    before = f"import scenarios.one_run; scenarios.one_run.measure = lambda *_: signal.raise_signal({int(number)})"
    done = formation("run", "shape", "--duration", "1", "--out", "mine", folder=tmp_path, before=before)
    assert (done.returncode, "Traceback" in done.stderr) == (CODES[number], False), done
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("number", CODES)
def test_a_signal_while_a_command_is_loaded_ends_it_without_a_word(tmp_path: Path, number: signal.Signals) -> None:
    finder = (
        "sys.meta_path.insert(0, type('Finder', (), {'find_spec': staticmethod(lambda name, *_: "
        f"os.kill(os.getpid(), {int(number)}) if name == 'click' else None)}}))"
    )
    done = formation("list", folder=tmp_path, before=finder)
    assert (done.returncode, done.stdout, done.stderr) == (CODES[number], "", "")


def test_a_users_law_cannot_swallow_the_request_to_end(tmp_path: Path) -> None:
    source = (LIBRARY / "bounded_angle_law.py").read_text(encoding="utf-8")
    call = "os.kill(os.getpid(), 15)\n        time.sleep(60)"
    head, body = source.split("def __call__", 1)
    signature, rest = body.split(":\n", 1)
    mine = f'{head}def __call__{signature}:\n        """Ends."""\n        import os, time\n        {call}\n{rest}'
    (tmp_path / "bounded_angle_law.py").write_text(mine, encoding="utf-8")
    shutil.copy(LIBRARY / "own-law.toml", tmp_path / "mine.toml")
    done = formation("run", "mine.toml", folder=tmp_path, before="pass")
    assert (done.returncode, "Traceback" in done.stderr) == (TERMINATED, False), done
    assert sorted(os.listdir(tmp_path)) == ["bounded_angle_law.py", "mine.toml"]


def test_an_interrupt_that_the_shell_ignores_is_ignored(tmp_path: Path) -> None:
    before = "signal.signal(signal.SIGINT, signal.SIG_IGN); import threading; os.kill(os.getpid(), 2)"
    done = formation("list", folder=tmp_path, before=before)
    assert done.returncode == 0


LOST = """
import scenarios.one_run, weakref
class Thing: pass
def lose(*_):
    thing = Thing()
    lost = weakref.ref(thing, lambda _: signal.raise_signal({number}))
    del thing
    import time
    time.sleep(60)
scenarios.one_run.measure = lose
"""


@pytest.mark.parametrize("number", CODES)
def test_a_request_that_falls_where_nothing_can_be_raised_is_made_again(tmp_path: Path, number: signal.Signals) -> None:
    before = f"exec({LOST.format(number=int(number))!r})"
    arguments = ("run", "shape", "--duration", "0.1", "--no-recording", "--out", "mine")
    done = formation(*arguments, folder=tmp_path, before=before)
    assert (done.returncode, "Traceback" in done.stderr) == (CODES[number], False), done
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("number", CODES)
@pytest.mark.parametrize("moment", ["_make", "_remove"])
def test_a_request_while_scratch_is_made_or_removed_waits_until_that_is_done(
    tmp_path: Path, number: signal.Signals, moment: str
) -> None:
    before = (
        f"from scenarios.storage import scratch; whole = scratch.{moment}; "
        f"scratch.{moment} = lambda *a: (signal.raise_signal({int(number)}), whole(*a))[1]"
    )
    done = formation("keys", "--markdown", "keys.md", folder=tmp_path, before=before)
    assert (done.returncode, done.stderr.strip()) == (CODES[number], "")
    assert os.listdir(tmp_path) == (["keys.md"] if moment == "_remove" else [])
