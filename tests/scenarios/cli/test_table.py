"""`formation table`: the numbers of runs and sweeps in the forms that papers and programs take."""

import csv
import io
import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas
import pytest
from hypothesis import given
from hypothesis import strategies as st

import scenarios
from scenarios import documents
from scenarios.documents import Sheet

Cli = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two runs and a sweep."""
    folder = tmp_path_factory.mktemp("runs")
    for plant in ("saturated", "unicycle"):
        scenarios.run("shape", plant=plant, safety="none", duration=1.0).save(folder / plant)
    scenarios.sweep(
        "shape", range(3), vary={"plant.name": ["saturated", "unicycle"]}, safety="none", duration=1.0,
        out=folder / "sweep",
    )  # fmt: skip
    return folder


def rows_of(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_two_runs_stand_beside_each_other_with_the_second_less_the_first(cli: Cli, runs: Path) -> None:
    code, out, _ = cli("table", str(runs / "saturated"), str(runs / "unicycle"), "--format", "csv")
    assert code == 0
    results = [json.loads((runs / name / "result.json").read_text()) for name in ("saturated", "unicycle")]
    [row] = [row for row in rows_of(out) if row["quantity"] == "angle error sum"]
    first, second = (result["angle_error_sum_rad"] for result in results)
    assert (float(row["saturated"]), float(row["unicycle"])) == (first, second)
    assert float(row["difference"]) == second - first
    [never] = [row for row in rows_of(out) if row["quantity"] == "settling time"]
    assert set(never.values()) == {"settling time", "s", ""}


def test_a_series_has_every_state_with_all_its_digits(cli: Cli, runs: Path) -> None:
    code, out, _ = cli("table", str(runs / "saturated"), "--series", "--format", "csv")
    assert code == 0
    with np.load(runs / "saturated" / "trajectory.npz") as states:
        assert np.array_equal([float(row["y_4_m"]) for row in rows_of(out)], states["points"][:, 3, 1])


def test_parquet_holds_what_csv_holds(cli: Cli, runs: Path, tmp_path: Path) -> None:
    arguments = "table", str(runs / "saturated"), "--series"
    assert cli(*arguments, "--format", "parquet", "--out", str(tmp_path / "t.parquet"))[0] == 0
    assert cli(*arguments, "--format", "csv", "--out", str(tmp_path / "t.csv"))[0] == 0
    frame = pandas.read_parquet(tmp_path / "t.parquet")
    rows = rows_of((tmp_path / "t.csv").read_text())
    assert list(frame) == list(rows[0])
    assert np.array_equal(
        frame.to_numpy(float), [[float(cell or "nan") for cell in row.values()] for row in rows], True
    )


def test_a_sweep_has_a_row_per_combination_with_what_its_rows_say(cli: Cli, runs: Path) -> None:
    code, out, _ = cli("table", str(runs / "sweep"), "--format", "csv")
    assert code == 0
    found = rows_of(out)
    assert [(row["plant.name"], row["runs"]) for row in found] == [("saturated", "3"), ("unicycle", "3")]
    frame = pandas.read_csv(runs / "sweep" / "rows.csv")
    for row in found:
        own = frame[frame["plant.name"] == row["plant.name"]]["angle_error_sum_rad"]
        assert float(row["angle_error_sum_rad.q50"]) == pytest.approx(own.median(), rel=1e-12)
        assert float(row["converged"]) == 0.0 < float(row["converged.high"]) < 1.0


@pytest.mark.parametrize("damage", ["", "a,b\n1,2\n"])
def test_damaged_rows_of_a_sweep_are_refused_in_one_line(cli: Cli, tmp_path: Path, damage: str) -> None:
    (tmp_path / "rows.csv").write_text(damage)
    code, out, err = cli("table", str(tmp_path))
    assert (code, out) == (2, "")
    assert "not the rows of a sweep" in err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nowhere"], "no such run folder"),
        (["a", "b", "c"], "got 3"),
        (["a", "b", "--series"], "expected one run folder"),
        (["a", "--format", "parquet"], "needs --out"),
    ],
)
def test_what_no_table_can_be_made_of_is_refused_in_one_line(cli: Cli, arguments: list[str], said: str) -> None:
    code, out, err = cli("table", *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert said in err


@given(st.lists(st.tuples(st.text(), st.floats() | st.none() | st.integers()), min_size=1))
def test_whatever_stands_in_a_latex_table_it_has_its_columns_and_no_character_of_latex_is_left_bare(
    rows: list[tuple[str, float | int | None]],
) -> None:
    rows = [(re.sub(r"\s", " ", name), value) for name, value in rows]
    text = documents.latex(Sheet(["name_of", "value"], rows))
    body = text.split("\\midrule\n")[1].split("\\bottomrule")[0].splitlines()
    assert len(body) == len(rows)
    for line in body:
        bare = re.sub(r"\\text\w+\{\}|\\[&%$#_{}]", "", line.removesuffix(r" \\"))
        name, value = bare.split(" & ")
        assert not set(name) & set("&%$#_{}~^\\")
        assert re.fullmatch(r"--|\$-?[\d.]+( \\times 10\^\{-?\d+\})?\$", value)


def test_a_table_for_a_paper_has_the_columns_that_are_named_and_none_that_is_empty(cli: Cli, runs: Path) -> None:
    sweep, chosen = str(runs / "sweep"), "plant.name,converged,angle_error_sum_rad.q50"
    code, out, _ = cli("table", sweep, "--format", "csv", "--columns", chosen)
    whole = rows_of(cli("table", sweep, "--format", "csv")[1])
    assert code == 0
    assert rows_of(out) == [{name: row[name] for name in chosen.split(",")} for row in whole]
    empty = {name for name in whole[0] if not any(row[name] for row in whole)}
    assert "min_clearance_m.q50" in empty
    written = set(cli("table", sweep)[1].splitlines()[0].strip("| ").split(" | "))
    assert written == set(whole[0]) - empty


def test_a_column_of_an_angle_is_named_with_its_comma_and_a_misspelt_one_is_told(cli: Cli, runs: Path) -> None:
    arguments = ("table", str(runs / "saturated"), "--series", "--format", "csv", "--columns")
    code, out, _ = cli(*arguments, "t_s,alpha(1;2,3).error_rad,x_1_m")
    assert code == 0
    assert out.splitlines()[0] == 't_s,"alpha(1;2,3).error_rad",x_1_m'
    assert cli(*arguments, "x_1_n")[::2] == (2, "formation: --columns: no column 'x_1_n', did you mean 'x_1_m'?\n")


def test_a_table_replaces_a_table_and_nothing_else(cli: Cli, runs: Path, tmp_path: Path) -> None:
    mine, table = tmp_path / "mine.toml", tmp_path / "t.csv"
    for path in (mine, table):
        path.write_text("of value", encoding="utf-8")
    arguments = ("table", str(runs / "saturated"), "--format", "csv", "--out")
    assert cli(*arguments, str(table))[0] == 0
    assert table.read_text(encoding="utf-8") != "of value"
    code, _, err = cli(*arguments, str(mine))
    assert (code, err.count("\n"), mine.read_text(encoding="utf-8")) == (2, 1, "of value")
    assert "mine.toml: is there already, and by its name no table: expected .csv or .txt" in err
