"""What the documents tell people to type works: commands run, files are read, names of options and keys exist.

The suite runs the commands that cost little; ``make docs-check`` runs all, as they stand there. What neither can run is
listed here, with the reason.
"""

import os
import re
import shlex
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
import pytest

from robots.identification.synthetic import random_way, synthesise
from robots.measured import MEASURED
from scenarios.cli.main import cli as commands
from scenarios.definition.experiment import build, open_experiment
from scenarios.definition.keys import keys
from scenarios.definition.load import LIBRARY, ScenarioFile, validate
from scenarios.simulation.loop import simulate
from scenarios.storage.result_schema import SCHEMA_VERSION

ROOT = Path(__file__).parents[1]
GALLERY = "gallery.md"  # `formation run` of each scenario, which the baselines are of; tests/test_gallery.py
DOCUMENTS = [ROOT / "README.md", *sorted(page for page in (ROOT / "docs").glob("*.md") if page.name != GALLERY)]

NOT_RUN = {
    "make ": "a target of the Makefile; that there is one is tested",
    "formation replay": "opens the viewer",
    "formation run maneuver --live": "opens the viewer",
    "formation sweep shape --seeds 0:1000 --scheduler": "needs a scheduler; tests/scenarios/work has one",
    "_FORMATION_COMPLETE": "writes into the user's shell; tests/scenarios/cli/test_completion.py",
    "pip install": "installs",
    ".venv/bin/pip install": "installs",
    "OMP_NUM_THREADS=1 .venv/bin/pytest": "measures; `make bench` is the same",
    "dask ": "starts servers",
    "NPY_DISABLE_CPU_FEATURES": "plays an older processor; has to stand before the process begins",
    "formation check formations/": "of another repository; tests/scenarios/studies has one",
    "formation check shape --update": "writes baselines",
}
"""How lines begin that are not run, and why not."""

QUICK = (
    "formation list",
    "formation new",
    "formation show",
    "formation run RUN",
    "formation plot RUN",
    "formation animate RUN",
    "formation table RUN",
    "formation export shape --safety none",
    "formation calibrate",
    "formation keys",
)
"""How lines begin that cost a second or two; the others are for ``make docs-check``."""

EVERYTHING = "DOCUMENTS_WHOLE" in os.environ
MISSED = 1
"""The exit code of a run that does not reach its goal, and of a law that an audit finds fault with."""

FILES = {"RUN": "run", "path/to/mine.toml": "mine.toml"}
LOGS = {"identify": "drive.npz", "adopt": "six.npz"}
"""What stands for the reader's own files."""

SCRIPT = """
import numpy as np
import rps.robotarium as robotarium
r = robotarium.Robotarium(number_of_robots=4, show_figure=False)
for _ in range(60):
    x = r.get_poses()
    r.set_velocities(np.arange(4), np.full((2, 4), 0.05))
    r.step()
"""


class Block(NamedTuple):
    """A piece of a document that is no prose.

    Attributes:
        page: its file's name.
        kind: the language of a fence, "" for an indented block.
        text: without fence and indentation.
    """

    page: str
    kind: str
    text: str


def blocks(document: Path) -> Iterator[Block]:
    """All fenced and indented blocks of a page."""
    fence = r"^```(?P<kind>\w*)\n(?P<fenced>.*?)^```$"
    indented = r"(?<=\n\n)(?P<indented>(?: {4}[^\n]*\n|\n(?= {4}))+)"
    for found in re.finditer(f"{fence}|{indented}", document.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
        if found["indented"] is None:
            yield Block(document.name, found["kind"], found["fenced"])
        else:
            yield Block(document.name, "", re.sub(r"^ {4}", "", found["indented"], flags=re.MULTILINE))


def _of(page: str, kind: str) -> list[str]:
    return [block.text for block in BLOCKS if (block.page, block.kind) == (page, kind)]


BLOCKS = [block for document in DOCUMENTS for block in blocks(document)]
IS_COMMAND = re.compile(r"""(?:[A-Z_]+=(?:"[^"]*"|\S+) )*(?:\.venv/bin/)?(?:formation|make|pip|dask|pytest) """)
LINES = list(
    dict.fromkeys(
        (block.page, line)
        for block in BLOCKS
        if not block.kind
        for line in re.sub(r" *\\\n *", " ", block.text).splitlines()
        if IS_COMMAND.match(line)
    )
)
RUN = [(page, line) for page, line in LINES if not line.startswith(tuple(NOT_RUN))]
CHEAP = [(page, line) for page, line in RUN if line.startswith(QUICK)]


def words(line: str) -> list[str]:
    """What a shell makes of a line behind ``formation``, with files that are there in place of RUN and LOG."""
    bare = re.sub(r"\[[A-Z-].*?\]$|\[--.*?\]", "", line.split("  #")[0].split(" # ")[0])
    found = shlex.split(bare)[1:]
    return [FILES.get(word, LOGS.get(found[0], word) if word == "LOG" else word) for word in found]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A reader's folder: a run, an own law and its scenario, as the pages have them, a script, logs."""
    from scenarios.interactive.single import run

    where = tmp_path_factory.mktemp("reader")
    run("shape", plant="saturated", duration=3.0).save(where / "run")
    [law] = _of("own-law.md", "python")
    (where / "my_law.py").write_text(law, encoding="utf-8")
    triangle, table = _of("README.md", "toml")
    (where / "mine.toml").write_text(f"{triangle}\n{table}", encoding="utf-8")
    for name, block in zip(("eight.toml", "laws.toml"), _of("afternoon.md", "toml"), strict=True):
        (where / name).write_text(block, encoding="utf-8")
    (where / "consensus.py").write_text(SCRIPT, encoding="utf-8")
    if EVERYTHING:
        rng = np.random.default_rng(1)
        poses, counts = synthesise(random_way(rng, 900), MEASURED.numbers, rng)
        np.savez(where / "drive.npz", poses=poses, counts=counts)
        trajectory = simulate(open_experiment("shape", ("robot.model=measured",), duration=40.0), 3)
        np.savez(where / "six.npz", poses=np.moveaxis(trajectory.poses, 0, 2).swapaxes(0, 1), t=trajectory.t)
    return where


@pytest.mark.parametrize(("page", "line"), RUN if EVERYTHING else CHEAP)
def test_a_command_of_a_page_works_as_it_stands_there(
    page: str,
    line: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    cli: Callable[..., tuple[int, str, str]],
) -> None:
    if words(line)[0] == "new":
        monkeypatch.chdir(folder.parent)  # it keeps what is there
    else:
        monkeypatch.chdir(folder)
    code, _, err = cli(*words(line))
    assert code in (0, MISSED), err


def test_what_is_not_run_is_there_and_no_command_is_heavy_for_nothing() -> None:
    assert [start for start in NOT_RUN if not any(line.startswith(start) for _, line in LINES)] == []
    assert [start for start in QUICK if not any(line.startswith(start) for _, line in CHEAP)] == []


def test_every_target_that_is_named_is_one() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set()
    for document in [*DOCUMENTS, ROOT / "CONTRIBUTING.md", ROOT / "docs" / GALLERY]:
        named |= set(re.findall(r"(?:`|^ {4})make (\w[\w-]*)", document.read_text(encoding="utf-8"), re.MULTILINE))
    assert named
    assert sorted(target for target in named if not re.search(rf"^{target}:", makefile, re.MULTILINE)) == []


# What stands in the middle of a sentence: names alone


def mentions() -> Iterator[str]:
    """Commands and options in the text of all documents, blocks and comments included."""
    for document in [*DOCUMENTS, ROOT / "CONTRIBUTING.md"]:
        text = document.read_text(encoding="utf-8")
        yield from re.findall(r"`((?:formation |--)[^`]+)`", text)
        yield from (line for line in text.splitlines() if line.startswith("    formation "))


def test_every_command_and_option_that_is_mentioned_exists() -> None:
    known = {name: _options(command) for name, command in commands.commands.items()}
    anywhere = set().union(*known.values())
    wrong = []
    for text in mentions():
        command = re.match(r" *formation ([a-z]+)", text)
        if command is not None and command[1] not in known and not text.strip().endswith("/"):
            wrong.append(text)
        bare = re.sub(r"-- ARGS|  #.*", "", text)
        options = known.get(command[1], set()) if command is not None else anywhere
        wrong += [text for option in re.findall(r"(?<![\w-])--[a-z-]+", bare) if option not in options]
    assert [text for text in wrong if text not in OF_OTHERS] == []


OF_OTHERS = ("--enable-unsafe-swiftshader",)
"""Options of other programs."""


def _options(command: click.Command) -> set[str]:
    own = {name for parameter in command.params for name in (*parameter.opts, *parameter.secondary_opts)}
    return own | {"--help", "--version"}


def test_every_key_that_is_set_in_a_command_exists() -> None:
    known = {re.sub(r"\[\]", "", key.name) for key in keys()}
    wrong = []
    for text in mentions():
        for key in re.findall(r"--(?:set|vary) '?([a-z][\w.]*)=", text):
            bare = re.sub(r"\.\d+", "", key)
            parents = {name for name in known if name.startswith(f"{bare}.")}
            if bare not in known and not parents and not bare.startswith(("law.parameters.", "agents.", "key")):
                wrong.append(text)
    assert wrong == []


# Blocks of TOML, JSON and Python


TOML = [block for block in BLOCKS if block.kind == "toml" or (not block.kind and re.match(r"\[\[|\{ id", block.text))]


@pytest.mark.parametrize("block", TOML, ids=lambda block: block.page)
def test_a_piece_of_a_scenario_is_one_that_a_scenario_may_have(block: Block, folder: Path) -> None:
    text = f"agents = [{block.text}]" if block.text.startswith("{") else block.text
    data: dict[str, Any] = tomllib.loads(text)
    if data.get("law", {}).get("name") == "own":
        [triangle, _] = _of("README.md", "toml")
        (folder / "piece.toml").write_text(f"{triangle}\n{block.text}", encoding="utf-8")
        open_experiment(str(folder / "piece.toml"))
        return
    whole = tomllib.loads((LIBRARY / "shape.toml").read_text(encoding="utf-8"))
    if "agents" in data and "title" not in data:
        agents = {agent["id"]: agent for agent in whole["agents"]}
        data = {"agents": [agents[agent["id"]] | agent for agent in data["agents"]]}
        data["agents"] += [agent for at, agent in agents.items() if at not in {a["id"] for a in data["agents"]}]
    whole = data if "title" in data else whole | {"safety": {"filter": "decentralised"}} | data
    build(ScenarioFile("piece", "piece", "", validate(whole, block.page)))


def test_each_kind_of_block_has_a_test_of_its_own() -> None:
    tested = {"python.md": "test_docs.py", "own-law.md": "here", "sweep.md": "here"}
    assert {block.page for block in BLOCKS if block.kind == "python"} == set(tested)
    others = {(block.page, block.kind) for block in BLOCKS if block.kind not in ("", "toml", "python")}
    assert others == {("comparison.md", "json"), ("comparison.md", "yaml")}


def test_the_frame_of_a_sweep_is_read_as_the_page_says(
    folder: Path, monkeypatch: pytest.MonkeyPatch, cli: Callable[..., tuple[int, str, str]]
) -> None:
    monkeypatch.chdir(folder)
    vary = ("--vary", "robot.tyre_friction=0.2,0.8", "--vary", "safety.filter=none,decentralised")
    arguments = ("sweep", "shape", "--seeds", "0:2", "--plant", "saturated", "--duration", "2", "--workers", "1")
    assert cli(*arguments, *vary, "--out", ".sweep")[0] == 0
    [block] = _of("sweep.md", "python")
    monkeypatch.chdir(folder / ".sweep")
    names: dict[str, Any] = {}
    exec(block, names)
    assert len(names["rows"]) == 8


def test_the_cases_of_the_page_are_those_of_a_baseline() -> None:
    import json

    from scenarios.studies.check.baseline import Case

    [block] = [block.text for block in BLOCKS if block.kind == "json"]
    assert [Case.model_validate(case).plant for case in json.loads(f"{{{block}}}")["cases"]] == ["pymunk", "pymunk"]


def test_the_workflow_of_the_page_is_yaml_whose_commands_exist() -> None:
    import yaml

    [block] = [block.text for block in BLOCKS if block.kind == "yaml"]
    steps = [step.get("run", "") for step in yaml.safe_load(block)["jobs"]["check"]["steps"]]
    [check] = [step for step in steps if step.startswith("formation ")]
    name, *rest = check.split()[1:]
    assert {word for word in rest if word.startswith("--")} <= _options(commands.commands[name])


def test_the_page_of_the_run_folder_names_its_schema_and_its_arrays(folder: Path) -> None:
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    assert f"`schema_version` {SCHEMA_VERSION}," in page
    with np.load(folder / "run" / "trajectory.npz") as arrays:
        assert [name for name in arrays if f"`{name}`" not in page] == []
    kinds = [re.sub(r"^figure-.*", "figure-*.png", path.name) for path in (folder / "run").iterdir()]
    assert [kind for kind in kinds if f"`{kind}`" not in page and not kind.startswith("animation")] == []
