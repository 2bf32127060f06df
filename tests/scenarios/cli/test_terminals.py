"""Any terminal: narrow, without a letter of Greek, full, gone."""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from scenarios.cli.main import cli as commands
from scenarios.terminal import Terminal, new_table, print_table

ALPHA = "\N{GREEK SMALL LETTER ALPHA}"

Cli = Callable[..., tuple[int, str, str]]

PRINTING = (
    ("list",),
    ("keys",),
    ("show", "shape"),
    ("show", "maneuver-testbed"),
    ("show", "random-50"),
    ("laws", "--starts", "1", "--law", "angle", "--law", "displacement-undirected", "--law", "triangle-angles"),
    ("audit", "shape", "--starts", "0"),
    ("run", "maneuver-testbed", "--plant", "single_integrator", "--duration", "1", "--no-recording"),
    (
        "sweep",
        "shape",
        "--seeds",
        "0:2",
        "--set",
        "duration_s=1",
        "--workers",
        "1",
        "--vary",
        "robot.tyre_friction=1,2",
    ),
)


@pytest.mark.parametrize("command", PRINTING, ids=" ".join)
def test_no_command_cuts_a_character_away_at_80_columns(
    command: tuple[str, ...], cli: Cli, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    _, out, err = cli(*command)
    assert out
    assert err == ""
    assert "…" not in out


def test_help_says_the_whole_first_sentence_of_every_command(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    _, out, _ = cli("--help")
    listed = out[out.index("Commands:") :]
    assert "..." not in listed
    assert [line for line in out.splitlines() if len(line) > 80] == []
    said = " ".join(listed.split())
    for name, command in commands.commands.items():
        sentence = " ".join((command.help or "").split("\n\n")[0].split())
        assert f" {name} {sentence.partition('. ')[0].removesuffix('.')}." in said


@pytest.mark.parametrize("terminal", ["none", "plain", "dumb"])
@pytest.mark.parametrize("width", [20, 80, 100])
def test_a_table_keeps_every_digit_whatever_shows_it(terminal: str, width: int) -> None:
    printed = io.StringIO()
    console = {
        "none": Console(file=printed, width=width),
        "plain": Console(file=printed, width=width, force_terminal=True, _environ={"TERM": "xterm"}),
        "dumb": Console(file=printed, width=width, force_terminal=True, _environ={"TERM": "dumb"}),
    }[terminal]
    table = new_table("agent", *(f"quantity {k} (m)" for k in range(12)), title="Numbers")
    numbers = [f"{k}.{'123456789' * 2}" for k in range(12)]
    table.add_row("1", *numbers)
    print_table(console, table)
    text = printed.getvalue()
    assert all(number in text for number in numbers)
    assert all(f"quantity {k} (m)" in text for k in range(12))
    assert "…" not in text
    assert console.width == (80 if terminal == "dumb" else width)


def printed(text: str, width: int, terminal: bool, **options: bool) -> str:
    """What a terminal of some width, or something else, gets of a text."""
    got = io.StringIO()
    Terminal(file=got, width=width, force_terminal=terminal, highlight=False, soft_wrap=True).print(text, **options)
    return got.getvalue()


@pytest.mark.parametrize("terminal", [True, False])
def test_a_long_line_breaks_between_words_on_a_terminal_alone(terminal: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("COLUMNS", raising=False)
    text = f"  note: {'word [bold] ' * 8}".rstrip()
    found = printed(text, 30, terminal, markup=False)
    lines = found.splitlines()
    assert found.split() == text.split()
    assert (len(lines) > 1) == terminal
    assert not terminal or (max(map(len, lines)) <= 30 and all(line.startswith("    ") for line in lines[1:]))
    assert printed(text, 30, terminal, markup=False, soft_wrap=True) == f"{text}\n"
    monkeypatch.setenv("COLUMNS", "30")
    assert printed(text, 30, False, markup=False).splitlines() == lines or not terminal


def test_what_a_label_stands_before_goes_on_under_its_first_word() -> None:
    lines = printed("Goal        all errors\n            of angles small, and no more\n[bold]a b[/bold]: c", 24, True)
    assert re.sub(r"\x1b\[\d*m", "", lines).splitlines() == [
        "Goal        all errors",
        "            of angles",
        "            small, and",
        "            no more",
        "a b: c",
    ]


@given(words=st.lists(st.text(st.sampled_from("ab]\\ "), max_size=30)), width=st.integers(20, 60))
def test_no_character_but_blanks_at_the_end_of_a_line_is_lost(words: list[str], width: int) -> None:
    text = "\n".join(words)
    found = printed(text, width, True, markup=False)
    assert found.replace(" ", "").replace("\n", "") == text.replace(" ", "").replace("\n", "")
    assert all(len(line) <= width or len(line.split()) == 1 for line in found.splitlines())


@given(widths=st.lists(st.integers(1, 30), min_size=2, max_size=12), width=st.integers(40, 200))
def test_a_wide_table_goes_on_below_beside_its_first_column(widths: list[int], width: int) -> None:
    printed = io.StringIO()
    console = Console(file=printed, width=width)
    table = new_table("agent", *(str(k) for k in range(len(widths))))
    for agent in ("one", "two"):
        table.add_row(agent, *("x" * each for each in widths))
    print_table(console, table)
    lines = printed.getvalue().splitlines()
    parts = lines.count("")
    assert sum(line.count("x") for line in lines) == 2 * sum(widths)
    assert [line.split()[0] for line in lines if line] == ["agent", "one", "two"] * (parts + 1)
    assert max(map(len, lines)) <= width
    if 5 + sum(each + 2 for each in widths) <= width - 2 * len(widths):
        assert parts == 0


@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_letters_that_a_terminal_does_not_have_become_question_marks(encoding: str) -> None:
    command = [sys.executable, "-m", "scenarios"]
    environment = os.environ | {"PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"}
    shown = subprocess.run(
        [*command, "show", "shape", "--set", f'title="{ALPHA}"'], capture_output=True, env=environment
    )
    assert shown.returncode == 0
    assert shown.stdout.decode(encoding).startswith("shape: ?\n")
    refused = subprocess.run([*command, "show", ALPHA], capture_output=True, env=environment)
    assert (refused.returncode, refused.stderr.count(b"\n")) == (2, 1)


def unheard(command: str, stdout: int) -> tuple[int, str]:
    """Exit code and complaint of a command whose output goes to a file descriptor."""
    done = subprocess.run(
        [sys.executable, "-m", "scenarios", command], stdout=stdout, stderr=subprocess.PIPE, text=True
    )
    return done.returncode, done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a file that is always full")
@pytest.mark.parametrize("command", ["list", "keys"])
def test_output_that_cannot_be_written_is_one_line(command: str) -> None:
    with open("/dev/full", "w") as full:
        told = unheard(command, full.fileno())
    assert told == (2, "formation: the output cannot be written: No space left on device\n")


@pytest.mark.parametrize("command", ["list", "--help"])
def test_a_reader_that_goes_away_is_told_nothing(command: str) -> None:
    read, write = os.pipe()
    os.close(read)
    try:
        assert unheard(command, write) == (1, "")
    finally:
        os.close(write)
