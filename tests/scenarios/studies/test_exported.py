"""``export --check``: an exported script, run from the chargers on, and whether it arrives."""

from collections.abc import Callable

from scenarios.studies import exported

Cli = Callable[..., tuple[int, str, str]]
THREE = """
title = "Three"
duration_s = {duration}
agents = [
    {{ id = 1, start = [0.0, 0.5] }},
    {{ id = 2, neighbours = [1], start = [-0.6, -0.2] }},
    {{ id = 3, neighbours = [1, 2], start = [0.6, -0.3] }},
]
[target.angles_deg]
"3;2,1" = 60.0
"1;3,2" = 60.0
"""


def test_a_check_runs_the_script_on_both_plants_and_with_measured_robots_and_says_that_it_arrives(
    cli: Cli, tmp_path
) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "three.toml").write_text(THREE.format(duration=25.0))
    code, out, _ = cli("export", "three.toml", "--check", "--runs", "1")
    assert code == 0
    rows = [line.split() for line in out.splitlines() if line.startswith(("saturated", "pymunk", "measured"))]
    assert [row[:5] for row in rows] == [[plant, *"1111"] for plant in ("saturated", "pymunk", "measured")]
    assert float(rows[2][5]) > 1e-4 > float(rows[1][5])  # cameras and wheels of their own
    assert "would run it to its goal" in out


def test_a_script_that_misses_is_told_by_seed_and_exit_code(cli: Cli, tmp_path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "three.toml").write_text(THREE.format(duration=0.5))
    code, out, _ = cli("export", "three.toml", "--check", "--runs", "1", "--out", "three.py")
    assert code == 1
    assert "saturated, seed 0: the angle errors add up to" in out
    assert (tmp_path / "three.py").exists()
    assert cli("export", "three.toml", "--runs", "2")[2].endswith("formation: --runs: needs --check\n")


def test_export_tries_the_script_and_warns_where_it_misses(cli: Cli, tmp_path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "three.toml").write_text(THREE.format(duration=25.0))
    assert "may miss" not in cli("export", "three.toml")[2]
    code, out, err = cli("export", "three.toml", "--duration", "0.5")
    assert (code, out.startswith('"""Three.')) == (0, True)
    assert "note: it may miss: on saturated, from within the testbed's tolerance, the angle errors add up to" in err
    barred = "obstacles=[{vertices_m=[[0.34, -0.13]], radius_m=0.02}]"
    assert "too close to an obstacle" in cli("export", "three.toml", "--set", barred, "--safety", "none")[2]


def test_why_a_run_does_not_arrive_names_all_reasons(shape) -> None:  # type: ignore[no-untyped-def]
    missed = exported.Arrival("pymunk", 3, True, 0.5, False, False, ("collision", "actuator"), 60.0)
    assert "5.0e-01 rad" in exported.why(missed, shape)
    assert "rejected: collision" in exported.why(missed, shape)
    stuck = exported.Arrival("pymunk", 3, False, float("inf"), False, False, (), 0.0)
    assert "do not come to their start" in exported.why(stuck, shape)
    assert not stuck.arrives
