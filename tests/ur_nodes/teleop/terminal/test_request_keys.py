import pytest

from ur_nodes.client.mux import MuxRequest, MuxView
from ur_nodes.motion.obstacle_stop.report import ObstacleReport, State
from ur_nodes.teleop.keyboard.drive import DIRECTIONS, SPEED_KEYS
from ur_nodes.teleop.terminal.keys import FocusLost, Key, KeyEvent
from ur_nodes.teleop.terminal.raw import (
    DRIVER_KEYS,
    EMERGENCY_KEYS,
    asks_to_save,
    driver_request_of,
    mux_request_of,
    obstacle_request_of,
)


def test_keys_for_the_lease_are_no_driving_keys() -> None:
    assert not set(DRIVER_KEYS) & {*DIRECTIONS, *SPEED_KEYS, *EMERGENCY_KEYS, "k"}


def test_only_a_press_without_ctrl_requests_something() -> None:
    assert driver_request_of(Key("d")) == "take"
    assert driver_request_of(Key("d", "repeat")) is None
    assert driver_request_of(Key("d", ctrl=True)) is None
    assert driver_request_of(Key("i")) is None


@pytest.mark.parametrize(
    ("state", "expected"),
    [("none", None), ("off", "obstacles on"), ("clear", "obstacles off"), ("stopped", "obstacles off")],
)
def test_one_key_turns_the_obstacle_stop_off_and_on(state: State, expected: MuxRequest | None) -> None:
    view = MuxView(False, obstacles=ObstacleReport(state))
    assert obstacle_request_of(Key("g"), view) == expected
    assert obstacle_request_of(Key("g", "repeat"), view) is None
    assert obstacle_request_of(Key("i"), view) is None
    assert obstacle_request_of(FocusLost(), view) is None


@pytest.mark.parametrize(
    ("event", "expected"),
    [
        (Key("space"), "stop"),
        (Key("r"), "release"),
        (Key("space", "release"), None),
        (Key("space", "repeat"), None),
        (Key("r", ctrl=True), None),
        (Key("i"), None),
        (FocusLost(), None),
    ],
)
def test_keys_ask_once_as_they_are_pressed(event: KeyEvent, expected: MuxRequest | None) -> None:
    assert mux_request_of(event) == expected


def test_only_a_press_without_ctrl_asks_to_save() -> None:
    assert asks_to_save(Key("s"))
    assert not asks_to_save(Key("s", "repeat"))
    assert not asks_to_save(Key("s", ctrl=True))
