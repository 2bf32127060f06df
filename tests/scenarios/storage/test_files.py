"""Files are replaced whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from scenarios.errors import InputError
from scenarios.storage.files import prove_writable, replacing, write_text, write_whole


def test_a_file_is_written_whole_with_the_folders_above_it(tmp_path: Path) -> None:
    write_text(tmp_path / "deep" / "report.md", "é\n", "--markdown")
    assert (tmp_path / "deep" / "report.md").read_text(encoding="utf-8") == "é\n"
    assert os.listdir(tmp_path / "deep") == ["report.md"]


def test_the_older_file_stands_until_the_new_one_is_whole(tmp_path: Path) -> None:
    path = tmp_path / "film.gif"
    path.write_bytes(b"old")
    with replacing(path) as new:
        new.write_bytes(b"half")
        assert path.read_bytes() == b"old"
        assert new.suffix == ".gif"
    assert path.read_bytes() == b"half"
    assert os.listdir(tmp_path) == ["film.gif"]


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError(errno.ENOSPC, "No space left on device")])
def test_an_older_file_survives_an_interrupt_and_a_full_disk(
    tmp_path: Path, error: BaseException | type[BaseException]
) -> None:
    path = tmp_path / "report.md"
    path.write_bytes(b"old")

    def write() -> None:
        with replacing(path, "--markdown") as new:
            new.write_bytes(b"half")
            raise error

    with pytest.raises((KeyboardInterrupt, InputError)) as raised:
        write()
    if isinstance(error, OSError):
        assert str(raised.value) == f"--markdown {path}: cannot be written: No space left on device"
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["report.md"]


def test_permissions_of_the_older_file_and_links_to_it_are_kept(tmp_path: Path) -> None:
    path, link = tmp_path / "report.md", tmp_path / "link.md"
    path.touch(mode=0o600)
    link.symlink_to("report.md")
    write_whole(link, b"new")
    assert link.is_symlink()
    assert path.read_bytes() == b"new"
    assert path.stat().st_mode & 0o777 == 0o600


def test_a_pipe_or_a_device_takes_a_report_as_it_is(tmp_path: Path) -> None:
    write_text(Path("/dev/null"), "report", "--markdown")
    prove_writable(Path("/dev/null"), "--markdown")
    assert Path("/dev/null").is_char_device()


@pytest.mark.parametrize("path", ["/proc/no/report.md", "file/report.md", ".", "a" * 300])
def test_what_cannot_be_written_is_known_before_and_told_in_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, path: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    for attempt in (prove_writable, lambda path, option: write_text(path, "", option)):
        with pytest.raises(InputError, match=r"^--junit .*: cannot be written: "):
            attempt(Path(path), "--junit")
    assert os.listdir(tmp_path) == ["file"]


def test_proving_that_a_file_can_be_written_leaves_it_as_it_is(tmp_path: Path) -> None:
    prove_writable(tmp_path / "report.md", "--markdown")
    assert os.listdir(tmp_path) == []
    (tmp_path / "report.md").write_text("old", encoding="utf-8")
    prove_writable(tmp_path / "report.md", "--markdown")
    assert (tmp_path / "report.md").read_text(encoding="utf-8") == "old"
