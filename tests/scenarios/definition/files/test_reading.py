"""Only regular files of a sane size are read, wherever a person names one."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from scenarios.definition import load
from scenarios.definition.files import law_file
from scenarios.definition.files.reading import read_json, read_regular
from scenarios.errors import InputError
from scenarios.studies.check import baseline


def device(folder: Path) -> Path:
    return Path("/dev/zero")


def pipe(folder: Path) -> Path:
    os.mkfifo(folder / "pipe.toml")
    return folder / "pipe.toml"


def directory(folder: Path) -> Path:
    return folder


@pytest.mark.parametrize("make", [device, pipe, directory])
def test_what_is_not_a_regular_file_is_refused_at_once_by_every_reader(
    tmp_path: Path, make: Callable[[Path], Path]
) -> None:
    path = make(tmp_path)
    with pytest.raises(OSError, match=r"not a regular file|Is a directory"):
        read_regular(path)
    readers: list[Callable[[], object]] = [
        lambda: read_json(path),
        lambda: load.load(str(path)),
        lambda: law_file.read("mine.toml", path.parent, path.name),
        lambda: baseline.read(path),
    ]
    for reader in readers:
        with pytest.raises(
            InputError, match=r"cannot be read: (not a regular file|Is a directory)|: a folder, expected"
        ):
            reader()


def test_a_file_is_read_up_to_the_largest_size_and_not_a_byte_beyond(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"12345")
    assert read_regular(path, 5) == b"12345"
    with pytest.raises(OSError, match="larger than 4 bytes"):
        read_regular(path, 4)


def test_a_file_whose_size_is_a_lie_is_read_no_further_than_the_limit() -> None:
    with pytest.raises(OSError, match="larger than 10 bytes"):
        read_regular(Path("/proc/self/status"), 10)


@pytest.mark.parametrize("content", [b"[" * 100_000, b'{"a": ' * 100_000, b"1" * 5000, b"\xff\xfe", b"", b"{"])
def test_what_is_not_json_is_one_line_with_the_file(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "some.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"some\.json: not valid JSON: ") as refusal:
        read_json(path)
    assert "\n" not in str(refusal.value)


def test_a_scenario_with_a_byte_order_mark_is_the_scenario(tmp_path: Path) -> None:
    text = (load.LIBRARY / "shape.toml").read_bytes()
    (tmp_path / "shape.toml").write_bytes(b"\xef\xbb\xbf" + text.replace(b"\n", b"\r\n"))
    file = load.load(str(tmp_path / "shape.toml"))
    assert (file.sha256, file.description) == (load.load("shape").sha256, load.load("shape").description)
