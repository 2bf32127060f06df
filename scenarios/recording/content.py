"""The recording of a run folder, of a scenario or of a script."""

from __future__ import annotations

from pathlib import Path

from scenarios.recording.encode import encode_run
from scenarios.storage import run_folder, script_folder


def recording_of(folder: Path) -> bytes:
    """The content of the ``.rrd`` file of the run in ``folder``, which has all other files.

    Raises:
        InputError: it does not hold a run.
    """
    if script_folder.is_script(folder):
        from scenarios.recording.script import encode_script

        return encode_script(script_folder.read(folder))
    return encode_run(run_folder.read(folder))
