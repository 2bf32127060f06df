"""The notebooks run from the first cell to the last, say what they should, and are kept without outputs."""

import json
import re
import runpy
from pathlib import Path
from typing import Any

import pytest

DOCS = Path(__file__).parents[1] / "docs"
NOTEBOOKS = sorted((DOCS / "notebooks").glob("*.ipynb"))

SAID = {
    "theory-by-hand": [
        r"off the predicted end by 1\.2\d+e-05 m",
        r"agent 6: own rate 0\.64 /s, measured late 0\.4\d /s",
    ],
    "from-scenario-to-figure": ["holds, 8 agents", "outcome: .*converged", "recording.rrd", "rerun_notebook|Viewer"],
    "own-law-and-audit": ["the law passes", "<run of soft, pymunk, seed 0: converged>"],
    "sweep-to-figure": [r"\\begin\{tabular\}", r"noise/figure-sweep\.png"],
}
"""What the outputs of each have among them."""


def test_there_are_four() -> None:
    assert {path.stem for path in NOTEBOOKS} == set(SAID)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_its_outputs(path: Path) -> None:
    cells = [cell for cell in json.loads(path.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"]
    assert cells
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells)


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # of the packages that talk to the kernel; ours runs in another process
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_says_what_it_should(path: Path, tmp_path: Path) -> None:
    notebook = runpy.run_path(str(DOCS / "notebooks.py"))["executed"](path, tmp_path)
    outputs: list[Any] = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    text = "\n".join(str(output.get("data", output.get("text"))) for output in outputs)
    assert [said for said in SAID[path.stem] if not re.search(said, text)] == []
    assert text.count("smallest separation:") == (path.stem == "from-scenario-to-figure"), "a run shows itself once"
    told = {output["text"] for output in outputs if output.get("name") == "stderr"}
    assert told <= {"formation: compiling, once\n"}  # where this machine has not done so yet
