"""Run the notebooks and write them as pages for the site: ``make docs``. They are kept without their outputs.

.venv/bin/python docs/notebooks.py build/notebooks
"""

import os
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbconvert import MarkdownExporter
from nbformat import NotebookNode

NOTEBOOKS = Path(__file__).parent / "notebooks"
LONGEST = 300.0
"""Seconds for which a cell may run."""

SURROUNDINGS = {
    "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]),
    "TTY_COMPATIBLE": "0",
    "RERUN_NOTEBOOK_ASSET": "http://localhost/widget.js",
}
"""The command line is that of this environment, and a page is no terminal. It shows no widget either: rerun need not
compress its viewer for one."""


def executed(path: Path, folder: Path) -> NotebookNode:
    """A notebook with its outputs, run in a folder."""
    notebook = nbformat.read(path, as_version=4)
    client = NotebookClient(
        notebook, timeout=LONGEST, coalesce_streams=True, resources={"metadata": {"path": str(folder)}}
    )
    client.execute(env=os.environ | SURROUNDINGS)
    return notebook


def main() -> None:
    """Write a page and its pictures for each notebook into the folder that was named."""
    out = Path(sys.argv[1])
    out.mkdir(parents=True, exist_ok=True)
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        print(path.stem, flush=True)
        with tempfile.TemporaryDirectory() as folder:
            notebook = executed(path, Path(folder))
        page, parts = MarkdownExporter().from_notebook_node(
            notebook, {"unique_key": path.stem, "output_files_dir": path.stem}
        )
        (out / f"{path.stem}.md").write_text(page, encoding="utf-8")
        for name, content in parts["outputs"].items():
            (out / name).parent.mkdir(exist_ok=True)
            (out / name).write_bytes(content)


if __name__ == "__main__":
    main()
