"""The scenario file's keys: what each accepts."""

from typing import Any, get_args

import pytest
from pydantic import BaseModel, ValidationError

from robots import GTERNAL, ROBOTARIUM_FLOOR
from robots.model import COLLISION_CENTRE, CONTROL_PERIOD
from robots.safety.barrier import FilterSettings
from scenarios.definition.load import library, load
from scenarios.definition.schema import (
    ArenaTable,
    GoalTable,
    PhaseTable,
    PlantTable,
    RobotTable,
    SafetyTable,
    Scenario,
    SensorTable,
)


def tables(model: type[BaseModel]) -> set[type[BaseModel]]:
    """A model and all models within it."""
    found = {model}

    def visit(annotation: Any) -> None:
        if isinstance(annotation, type) and issubclass(annotation, BaseModel) and annotation not in found:
            found.update(tables(annotation))
        for argument in get_args(annotation):
            visit(argument)

    for field in model.model_fields.values():
        visit(field.annotation)
    return found


@pytest.mark.parametrize("model", sorted(tables(Scenario), key=lambda m: m.__name__))
def test_every_table_refuses_unknown_keys_and_change(model: type[BaseModel]) -> None:
    assert model.model_config["extra"] == "forbid"
    assert model.model_config["frozen"] is True


QUANTITIES = [
    (RobotTable, "projection_distance_m", False),
    (RobotTable, "wheel_speed_limit_rad_s", False),
    (RobotTable, "tyre_friction", True),
    (RobotTable, "body_friction", True),
    (PlantTable, "control_period_s", False),
    (SensorTable, "position_noise_m", True),
    (SensorTable, "bearing_noise_deg", True),
    (GoalTable, "angle_error_sum_rad", False),
]


@pytest.mark.parametrize(("model", "key", "zero"), QUANTITIES)
def test_a_quantity_is_a_number_of_the_right_sign(model: type[BaseModel], key: str, zero: bool) -> None:
    assert getattr(model(**{key: 1}), key) == 1.0
    for bad in (-1.0, float("nan"), float("inf"), 1e7, True, "1", None, [1.0], *([] if zero else [0.0])):
        with pytest.raises(ValidationError):
            model(**{key: bad})
    if zero:
        assert getattr(model(**{key: 0}), key) == 0.0


@pytest.mark.parametrize("bad", [1, "true", 0.0])
def test_a_flag_is_true_or_false_and_no_number(bad: object) -> None:
    with pytest.raises(ValidationError):
        ArenaTable(walls=bad)  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", [(1.0,), (1.0, 2.0, 3.0), ("a", "b"), (float("nan"), 0.0), 3.0])
def test_a_vector_has_two_finite_numbers(bad: object) -> None:
    with pytest.raises(ValidationError):
        PhaseTable(name="a", duration_s=1.0, velocity_m_s=bad)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", library())
def test_a_scenario_written_as_json_and_read_again_is_the_same(name: str) -> None:
    """The run folder keeps scenarios this way."""
    scenario = load(name).scenario
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


def test_defaults_are_the_constants_of_the_machines() -> None:
    """The schema repeats them so that listing scenarios loads no numpy; here they are held together."""
    robot, arena, safety, settings = RobotTable(), ArenaTable(), SafetyTable(), FilterSettings()
    assert PlantTable().control_period_s == CONTROL_PERIOD
    assert robot.projection_distance_m == COLLISION_CENTRE == GTERNAL.chassis.centre_offset
    assert robot.wheel_speed_limit_rad_s == GTERNAL.drive.wheel_speed_limit
    assert (robot.tyre_friction, robot.body_friction) == (GTERNAL.chassis.tyre_friction, GTERNAL.chassis.body_friction)
    assert (arena.x_m, arena.y_m) == (ROBOTARIUM_FLOOR.x, ROBOTARIUM_FLOOR.y)
    assert (safety.safe_distance_m, safety.sensing_range_m) == (settings.safe_distance, settings.sensing_range)
    assert (safety.clearance_m, safety.gain_per_s) == (settings.clearance, settings.gain)
    assert (safety.turn_rad, safety.stuck_time_s) == (settings.turn, settings.stuck_time)
