"""Progress: a bar where somebody watches, a line now and then where nobody does, nothing where nothing may be said."""

import io
from collections.abc import Callable

import pytest
from rich.console import Console

from scenarios import terminal


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The time, which the test sets."""
    now = [0.0]
    monkeypatch.setattr(terminal, "monotonic", lambda: now[0])
    return now


def work(console: Console, clock: list[float], until: float) -> None:
    """A hundred steps that take so many seconds."""
    with terminal.progress_bar(console, "sweep") as advance:
        for done in range(101):
            clock[0] = until * done / 100.0
            advance(done, 100)


def test_work_of_a_minute_into_a_file_says_every_ten_seconds_how_far_it_is(
    clock: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    work(Console(file=io.StringIO()), clock, 60.0)
    out, err = capsys.readouterr()
    assert out == ""
    lines = err.splitlines()
    assert lines[0] == "sweep: 17 of 100, 17 %, about 50 s left"
    assert len(lines) == 5


def test_short_work_and_a_quiet_console_say_nothing(clock: list[float], capsys: pytest.CaptureFixture[str]) -> None:
    work(Console(file=io.StringIO()), clock, 9.0)
    clock[0] = 0.0
    work(Console(quiet=True), clock, 60.0)
    assert capsys.readouterr() == ("", "")


def test_colours_that_are_forced_into_a_file_make_no_bar(
    clock: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    file = io.StringIO()
    work(Console(file=file, force_terminal=True), clock, 60.0)
    assert file.getvalue() == ""
    assert len(capsys.readouterr().err.splitlines()) == 5


def test_work_without_a_known_end_says_what_there_is_to_say(
    clock: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    with terminal.open_ended(Console(file=io.StringIO()), "script") as say:
        tell: Callable[[str], None] = say
        for second in range(25):
            clock[0] = float(second)
            tell(f"{second} s")
    assert capsys.readouterr().err == "script: 10 s\nscript: 20 s\n"
