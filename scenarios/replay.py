"""Open runs in the viewer; a recording that is lost or damaged is rebuilt from the run's states."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from scenarios.errors import InputError, plain
from scenarios.recording import file, viewer
from scenarios.storage import run_folder


def replay(folders: Sequence[Path], web: bool, console: Console) -> None:
    """Show one run, or two runs beside each other, and wait until the viewer is closed.

    Raises:
        InputError: a folder does not hold a run, or the viewer does not open.
    """
    with tempfile.TemporaryDirectory(prefix="formation-replay-") as scratch:
        single = len(folders) == 1
        path = recording_of(folders[0], Path(scratch), console) if single else _pair(folders, Path(scratch))
        viewer.show(path, web)


def recording_of(folder: Path, scratch: Path, console: Console) -> Path:
    """The recording of a run, rebuilt if it has to be: in its folder, or in ``scratch`` where that cannot be written.

    Raises:
        InputError: the folder does not hold a run.
    """
    path = folder / run_folder.RECORDING
    wrong = file.damage(path)
    if wrong is None and run_folder.is_run(folder):
        return path
    from scenarios.storage import script_folder  # loads numpy, which a whole recording does not wait for

    if not script_folder.is_script(folder):
        run_folder.read(folder)  # says what is wrong before rerun is loaded
    from scenarios.recording import content as encoding

    content = encoding.recording_of(folder)
    try:
        file.write(path, content)
    except OSError as error:
        kept = f"rebuilt outside the folder, which cannot be written ({error.strerror}),"
        path = scratch / run_folder.RECORDING
        file.write(path, content)
    else:
        kept = "rebuilt"
    console.print(plain(f"{folder / run_folder.RECORDING}: {wrong}, {kept} from {run_folder.TRAJECTORY}"), markup=False)
    return path


def _pair(folders: Sequence[Path], scratch: Path) -> Path:
    from scenarios.storage import script_folder

    path = scratch / run_folder.RECORDING
    of_scripts = [script_folder.is_script(folder) for folder in folders]
    if all(of_scripts):
        kept = [script_folder.read(folder) for folder in folders]
        from scenarios.recording.script import encode_scripts

        file.write(path, encode_scripts(kept))
        return path
    if any(of_scripts):
        raise InputError(
            f"{folders[of_scripts.index(True)]}: the run of a script; only another script's goes beside it"
        )
    runs = [run_folder.read(folder) for folder in folders]
    from scenarios.recording.encode import encode_pair

    file.write(path, encode_pair(runs))
    return path
