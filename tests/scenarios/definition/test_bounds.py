"""Sizes beyond the bounds are refused before anything is allocated."""

import tracemalloc
from collections.abc import Callable, Iterator
from typing import Any, get_args

import pytest
from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from scenarios.definition.bounds import MOST_BYTES, MOST_STARTS, STATE_BYTES
from scenarios.definition.experiment import Experiment, open_experiment
from scenarios.definition.schema import Scenario
from scenarios.errors import InputError
from scenarios.studies.shares import share_reaching


@pytest.mark.parametrize(
    ("scenario", "changes", "message"),
    [
        (
            "random-50",
            ["random_formation.agents=1000000000000"],
            "random_formation.agents: expected less than or equal",
        ),
        ("random-50", ["random_formation.seed=-1"], "random_formation.seed: expected greater than or equal to 0"),
        ("shape", ["sensor.delay_periods=1000000000000"], "sensor.delay_periods: expected less than or equal to"),
        ("shape", ["duration_s=1e-300"], "duration_s: expected greater than or equal to 0.000000001"),
        ("shape", ["duration_s=33001"], "duration_s: expected at most 1000000 control periods"),
        (
            "random-50",
            ["random_formation.agents=5000"],
            "duration_s: 5000 robots for .* need .* GB, expected at most 4 GB",
        ),
        (
            "random-50",
            ["random_formation.agents=1000", "obstacles=[{vertices_m=[[9,9],[9,8]]}]", "plant.control_period_s=0.001"],
            "duration_s: 1000 robots for .* control periods among 2 vertices of obstacles need",
        ),
    ],
)
def test_a_size_beyond_its_bound_is_one_line_and_no_memory(scenario: str, changes: list[str], message: str) -> None:
    open_experiment(scenario)  # modules are loaded
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match=f"^{scenario}: {message}"):
            open_experiment(scenario, tuple(changes))
        assert tracemalloc.get_traced_memory()[1] < 5e6
    finally:
        tracemalloc.stop()


def test_robots_and_periods_count_together() -> None:
    """As many robot-periods fit, whether of few robots for long or of many for a short time."""
    for robots in (50, 100):
        period = 240.0 / (MOST_BYTES / STATE_BYTES / robots)
        changes = (f"random_formation.agents={robots}", f"plant.control_period_s={period}")
        assert open_experiment("random-50", changes, 239.9).n == robots
        with pytest.raises(InputError, match=rf"--duration: {robots} robots for .* need 4.04 GB"):
            open_experiment("random-50", changes, 242.4)


def test_a_phase_shorter_than_a_period_counts_as_one(varied: Callable[..., Experiment]) -> None:
    with pytest.raises(InputError, match="1000 robots for 800 control periods among 100 vertices"):
        varied(
            without="duration_s",
            agents=[],
            target={},
            random_formation={"agents": 1000, "seed": 0},
            phases=[{"name": "a", "duration_s": 1e-6}] * 800,
            obstacles=[{"vertices_m": [[9, k]]} for k in range(100)],
        )


@pytest.mark.parametrize("starts", [0, MOST_STARTS + 1, 10**9])
def test_more_random_starts_than_can_be_run_are_refused(starts: int) -> None:
    with pytest.raises(InputError, match=f"--starts: expected 1 to {MOST_STARTS}, got {starts}"):
        share_reaching(open_experiment("shape"), starts, lambda *_: None)


def numbers(model: type[BaseModel], name: str = "") -> Iterator[tuple[str, list[Any]]]:
    """Every number of the schema by its key, with the constraints on it."""

    def visit(annotation: Any, metadata: list[Any], key: str) -> Iterator[tuple[str, list[Any]]]:
        if isinstance(annotation, FieldInfo):
            annotation, metadata = annotation.annotation, [*annotation.metadata, *metadata]
        extra = getattr(annotation, "__metadata__", ())
        flat = [part for item in extra for part in (item.metadata if isinstance(item, FieldInfo) else [item])]
        if annotation in (int, float):
            yield key, metadata
        elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
            yield from numbers(annotation, f"{key}.")
        for argument in get_args(annotation)[: 1 if flat else None]:
            yield from visit(argument, [*flat], key) if flat else visit(argument, [], key)

    for field, info in model.model_fields.items():
        yield from visit(info, [], f"{name}{field}")


def test_every_number_of_the_schema_has_a_lower_and_an_upper_bound() -> None:
    found = dict(numbers(Scenario))
    assert {"random_formation.agents", "agents.start", "sensor.delay_periods", "obstacles.vertices_m"} <= set(found)
    for key, metadata in found.items():
        assert any(isinstance(part, Ge | Gt) for part in metadata), key
        assert any(isinstance(part, Le | Lt) for part in metadata), key
