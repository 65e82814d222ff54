from pathlib import Path
from typing import Any

import pytest
import yaml

from ur.robot.base import list_bases, load_base
from ur.source.diagnostic import UserError
from ur_nodes.motion.mux_events import Lock, MuxSettings, Source
from ur_nodes.motion.mux_settings import read_locks, read_sources
from ur_nodes.motion.ramp import Axis

PACKAGE = Path(__file__).resolve().parents[3] / "ubiquity_launches"
GOOD = {"name": "keyboard", "topic": "key_vel", "timeout": 0.5, "priority": 90}


def test_sources_are_read_with_the_names_of_twist_mux() -> None:
    assert read_sources([GOOD], "/mux/topics") == (Source("keyboard", "key_vel", 90, 0.5),)
    assert read_sources([GOOD | {"zeros_hold": True}], "t")[0].zeros_hold is True
    assert read_sources([GOOD | {"avoids_obstacles": True}], "t")[0].avoids_obstacles is True
    assert read_locks([GOOD | {"timeout": 0}], "t") == (Lock("keyboard", "key_vel", 90, 0.0),)
    assert read_locks([], "t") == ()


def test_sources_may_be_a_mapping_by_name() -> None:
    unnamed = {key: value for key, value in GOOD.items() if key != "name"}
    assert read_sources({"keyboard": unnamed}, "t") == read_sources([GOOD], "t")


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (None, "parameter /mux/topics: None, expected a list"),
        ([], "parameter /mux/topics: no sources, expected at least one"),
        ([3], "parameter /mux/topics, item 1: 3, expected a mapping"),
        ({"keyboard": 3}, "parameter /mux/topics, item 1: 3, expected a mapping"),
        ([GOOD, {"name": "x"}], "item 2: topic is missing, expected a text"),
        ([GOOD | {"timeout": 0.0}], "timeout: 0.0, expected a number of seconds from 0.01 to 1"),
        ([GOOD | {"timeout": float("nan")}], "timeout: nan, expected"),
        ([GOOD | {"priority": 300}], "priority: 300, expected a whole number from 0 to 255"),
        ([GOOD | {"priority": True}], "priority: True, expected"),
        ([GOOD | {"timout": 1}], "timout is not known"),
        ([GOOD | {"zeros_hold": 1}], "zeros_hold: 1, expected true or false"),
        ([GOOD, GOOD], "the name 'keyboard' is given twice"),
        ([GOOD | {"name": "idle"}], "the name 'idle' means that nothing drives"),
    ],
)
def test_bad_sources_are_refused_by_name(value: Any, message: str) -> None:
    with pytest.raises(UserError) as caught:
        read_sources(value, "/mux/topics")
    assert message in str(caught.value)


def test_sources_of_the_library_put_people_before_programs() -> None:
    people = ["joystick", "keyboard", "web"]
    given = yaml.safe_load((PACKAGE / "n_cmd_vel_mux" / "params" / "sources.yaml").read_text())
    sources = sorted(read_sources(given["topics"], "topics"), key=lambda source: -source.priority)
    names = [source.name for source in sources]
    assert [name for name in names if name in people] == people
    assert names[0] == "joystick"
    assert names.index("navigation") >= len(people)
    assert len({source.priority for source in sources}) == len(sources)
    assert [source.name for source in sources if source.avoids_obstacles] == ["navigation"]
    assert read_locks(given["locks"], "locks")


@pytest.mark.parametrize("path", sorted((PACKAGE / "n_teleop_twist_joy" / "params").glob("*.yaml")), ids=str)
def test_joystick_speeds_are_those_of_the_base(path: Path) -> None:
    limits = load_base(PACKAGE, path.stem).limits
    given = yaml.safe_load(path.read_text())
    assert given["scale_linear"] <= given["scale_linear_turbo"] <= given["speed_limit"] <= limits.velocity
    assert given["scale_angular"] <= given["scale_angular_turbo"] <= given["turn_limit"] <= limits.angular_velocity


@pytest.mark.parametrize("path", sorted((PACKAGE / "n_velocity_smoother" / "params").glob("*.yaml")), ids=str)
def test_smoother_is_at_most_as_lively_as_the_base(path: Path) -> None:
    limits = load_base(PACKAGE, path.stem).limits
    given = yaml.safe_load(path.read_text())
    assert given["speed_lim_v"] <= limits.velocity
    assert given["speed_lim_w"] <= limits.angular_velocity
    assert given["accel_lim_v"] <= limits.acceleration
    assert given["accel_lim_w"] <= limits.angular_acceleration
    assert given["accel_lim_v"] * given["decel_factor"] <= limits.deceleration


@pytest.mark.parametrize("name", list_bases(PACKAGE))
def test_base_can_be_stopped_in_time(name: str) -> None:
    """Braking from full speed, the lag between mux and wheels, and a period of a commander at 20 Hz: at most 0.3 s."""
    limits = load_base(PACKAGE, name).limits
    braking = max(limits.velocity / limits.deceleration, limits.angular_velocity / limits.angular_deceleration)
    lag = MuxSettings((), Axis(1.0, 1.0, 1.0), Axis(1.0, 1.0, 1.0)).lag
    assert braking + lag + 0.05 <= 0.3, f"bases/{name}/base.yaml: expected a higher deceleration or a lower speed"
