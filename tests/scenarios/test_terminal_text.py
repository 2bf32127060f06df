"""Whatever a file or an argument holds, nothing but text reaches the terminal."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from scenarios.definition.load import LIBRARY
from scenarios.errors import plain

Cli = Callable[..., tuple[int, str, str]]

RED, CLEAR = "\x1b[31m", "\x9b2J"
SHAPE = (LIBRARY / "shape.toml").read_text(encoding="utf-8")
CONTROLS = frozenset(map(chr, [*range(32), *range(127, 160)])) - {"\n"}


def quiet(answer: tuple[int, str, str]) -> tuple[int, str]:
    """The exit code and all that was printed, which is nothing but text."""
    code, out, err = answer
    assert not CONTROLS & set(out + err)
    return code, out + err


@pytest.mark.parametrize("control", [r"\u001b[31m", r"\u009b2J", r"\n", r"\u0007", r"\u007f"])
@pytest.mark.parametrize("key", ["title", "phases"])
def test_control_characters_in_a_title_or_a_phase_are_refused(cli: Cli, control: str, key: str) -> None:
    change = f'title="a{control}b"' if key == "title" else f'phases=[{{name="a{control}b", duration_s=1.0}}]'
    code, said = quiet(cli("show", "shape" if key == "title" else "maneuver", "--set", change))
    assert code == 2
    assert f"{key if key == 'title' else 'phases[1].name'}: expected a line without control characters, got" in said


@pytest.mark.parametrize("control", [RED, CLEAR, "\u202e", "\n"])
def test_control_characters_in_names_of_files_and_arguments_are_spelt_out(
    cli: Cli, tmp_path: Path, control: str
) -> None:
    path = tmp_path / f"a{control}.toml"
    path.write_text(SHAPE, encoding="utf-8")
    code, said = quiet(cli("run", str(path)))
    assert (code, "expected a file name that can be printed" in said) == (2, True)
    for arguments in (("show", f"a{control}b"), (f"sh{control}ow",), ("run", "shape", f"--{control}", "1")):
        assert quiet(cli(*arguments))[0] == 2


def test_control_characters_in_the_name_of_a_folder_are_spelt_out(
    cli: Cli, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scenarios.one_run._draw_overview", lambda *_: None)
    folder = tmp_path / f"out{RED}"
    code, said = quiet(cli("run", "shape", "--duration", "0.1", "--no-recording", "--out", str(folder)))
    assert (code, plain(str(folder)) in said.replace("\n", "")) == (1, True)
    assert folder.is_dir()


def test_a_comment_that_is_shown_controls_nothing(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(f"# A comment{CLEAR}.\n{SHAPE}", encoding="utf-8")
    code, said = quiet(cli("show", "./mine.toml"))
    assert (code, r"A comment\x9b2J." in said) == (0, True)


def test_a_name_that_is_no_text_is_spelt_out(cli: Cli, tmp_path: Path) -> None:
    name = os.fsdecode(b"\xff.toml")
    (tmp_path / name).write_text(SHAPE, encoding="utf-8")
    code, said = quiet(cli("show", f"./{name}"))
    assert (code, r"./\udcff.toml: expected a file name that can be printed" in said) == (2, True)
