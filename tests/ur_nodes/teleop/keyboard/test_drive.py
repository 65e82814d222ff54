from collections.abc import Iterable

import pytest

from ur_nodes.teleop.keyboard.drive import (
    FIRST_HOLD,
    LOST_AFTER,
    REPEAT_HOLD,
    STILL,
    ZEROS,
    DriveSettings,
    DriveState,
    KeyVelocity,
    start_drive,
    step_drive,
)
from ur_nodes.teleop.terminal.keys import FocusLost, Key, KeyEvent, KittyFlags

SETTINGS = DriveSettings(speed=0.4, turn=0.8, speed_limit=0.5, turn_limit=1.0)
TICK = 0.05


def replay(
    events: Iterable[tuple[float, KeyEvent]], until: float, state: DriveState | None = None
) -> dict[float, KeyVelocity]:
    """What is published when, with ticks in between."""
    state = state or start_drive(SETTINGS)
    waiting = sorted(events, key=lambda item: item[0])
    sent: dict[float, KeyVelocity] = {}
    for count in range(round(until / TICK) + 1):
        now = round(count * TICK, 3)
        while waiting and waiting[0][0] <= now:
            at, event = waiting.pop(0)
            state, _ = step_drive(state, event, at)
        state, motion = step_drive(state, None, now)
        if motion is not None:
            sent[now] = motion
    return sent


def held(key: str, start: float, end: float, pause: float = 0.5, every: float = 0.033) -> list[tuple[float, KeyEvent]]:
    """A held key as a terminal without release events reports it."""
    repeats = int((end - start - pause) / every) + 1 if end - start >= pause else 0
    return [(start, Key(key)), *((start + pause + i * every, Key(key)) for i in range(repeats))]


def kitty() -> DriveState:
    state, _ = step_drive(start_drive(SETTINGS), KittyFlags(15), 0.0)
    return state


def stop_time(sent: dict[float, KeyVelocity]) -> float:
    return min(at for at, motion in sent.items() if motion == STILL)


def test_nothing_is_published_before_the_first_key() -> None:
    assert replay([], 2.0) == {}


def test_held_key_drives_without_a_gap() -> None:
    sent = replay(held("i", 0.1, 3.0), 3.0)
    assert [at for at in sent if at >= 0.15] == pytest.approx([0.15 + TICK * i for i in range(len(sent) - 1)], abs=0.06)
    assert set(sent.values()) == {KeyVelocity(x=0.4)}


def test_released_key_stops_soon_after_the_last_repeat() -> None:
    assert stop_time(replay(held("i", 0.1, 2.0), 4.0)) <= 2.0 + REPEAT_HOLD + TICK


def test_tap_stops_after_the_first_hold() -> None:
    assert stop_time(replay([(0.1, Key("i"))], 4.0)) == pytest.approx(0.1 + FIRST_HOLD, abs=2 * TICK)


def test_pause_of_the_keyboard_is_learnt_for_later_taps() -> None:
    taps = [*held("i", 0.1, 1.0, pause=0.25), (2.0, Key("i"))]
    sent = {at: motion for at, motion in replay(taps, 4.0).items() if at >= 2.0}
    assert stop_time(sent) == pytest.approx(2.35, abs=2 * TICK)


def test_stop_is_said_a_few_times_and_then_nothing() -> None:
    sent = replay(held("i", 0.1, 1.0), 5.0)
    assert list(sent.values()).count(STILL) == ZEROS
    assert max(sent) < 2.0


@pytest.mark.parametrize("key", ["space", "k", "5", "escape", "enter"])
def test_other_keys_stop_at_once(key: str) -> None:
    assert stop_time(replay([(0.1, Key("i")), (0.2, Key(key))], 1.0)) == 0.2


def test_release_stops_at_once_where_it_is_reported() -> None:
    sent = replay([(0.1, Key("i")), (0.8, Key("i", "repeat")), (0.9, Key("i", "release"))], 2.0, kitty())
    assert stop_time(sent) == 0.9


def test_held_keys_add_up_where_releases_are_reported() -> None:
    events = [(0.1, Key("up")), (0.3, Key("left")), (0.6, Key("up", "release")), (0.8, Key("left", "release"))]
    sent = replay(events, 1.5, kitty())
    assert sent[0.2] == KeyVelocity(x=0.4)
    assert sent[0.4] == KeyVelocity(x=0.4, yaw=0.8)
    assert sent[0.7] == KeyVelocity(yaw=0.8)
    assert sent[0.8] == STILL


def test_opposite_keys_cancel() -> None:
    assert set(replay([(0.0, Key("up")), (0.0, Key("down"))], 0.5, kitty()).values()) == {STILL}


def test_silent_terminal_counts_as_gone() -> None:
    sent = replay([(0.1, Key("i"))], 4.0, kitty())
    assert stop_time(sent) == pytest.approx(0.1 + LOST_AFTER, abs=2 * TICK)


def test_sign_of_life_keeps_a_held_key_driving() -> None:
    events: list[tuple[float, KeyEvent]] = [(0.1, Key("i")), *((0.25 * i, KittyFlags(15)) for i in range(1, 12))]
    assert STILL not in replay(events, 3.0, kitty()).values()


def test_lost_focus_stops() -> None:
    assert stop_time(replay([(0.1, Key("i")), (0.3, FocusLost())], 1.0, kitty())) == 0.3


def test_terminal_with_only_some_of_the_protocol_uses_holds() -> None:
    state, _ = step_drive(start_drive(SETTINGS), KittyFlags(1), 0.0)
    assert stop_time(replay([(0.1, Key("i"))], 4.0, state)) == pytest.approx(0.1 + FIRST_HOLD, abs=2 * TICK)


def test_key_timeout_replaces_every_hold() -> None:
    settings = DriveSettings(0.4, 0.8, 0.5, 1.0, key_timeout=1.5)
    sent = replay([(0.1, Key("i"))], 4.0, start_drive(settings))
    assert stop_time(sent) == pytest.approx(1.6, abs=2 * TICK)


@pytest.mark.parametrize(
    ("key", "motion"),
    [
        ("i", KeyVelocity(x=0.4)),
        ("o", KeyVelocity(x=0.4, yaw=-0.8)),
        ("j", KeyVelocity(yaw=0.8)),
        ("m", KeyVelocity(x=-0.4, yaw=-0.8)),
        (".", KeyVelocity(x=-0.4, yaw=0.8)),
        ("J", KeyVelocity(y=0.4)),
        ("<", KeyVelocity(x=-0.4)),
        ("M", KeyVelocity(x=-0.4, y=0.4)),
        ("down", KeyVelocity(x=-0.4)),
        ("right", KeyVelocity(yaw=-0.8)),
    ],
)
def test_layout_is_that_of_teleop_twist_keyboard(key: str, motion: KeyVelocity) -> None:
    assert step_drive(start_drive(SETTINGS), Key(key), 0.0)[1] == motion


def test_speed_keys_change_speeds_up_to_the_limits() -> None:
    state = start_drive(SETTINGS)
    state, _ = step_drive(state, Key("w"), 0.0)
    assert (state.speed, state.turn) == pytest.approx((0.44, 0.8))
    for _ in range(20):
        state, _ = step_drive(state, Key("q"), 0.0)
    assert (state.speed, state.turn) == (0.5, 1.0)
    assert "forward speed is at its limit" in state.note
    state, _ = step_drive(state, Key("c"), 0.0)
    assert (state.speed, state.turn) == pytest.approx((0.5, 0.9))
    assert state.note == ""


def test_speed_keys_do_not_stop_the_robot() -> None:
    state, _ = step_drive(start_drive(SETTINGS), Key("i"), 0.0)
    assert step_drive(state, Key("w"), 0.1)[1] == pytest.approx((0.44, 0.0, 0.0, 0.0))


def test_speeds_at_the_start_obey_the_limits() -> None:
    state = start_drive(DriveSettings(9.0, 9.0, 0.5, 1.0))
    assert (state.speed, state.turn) == (0.5, 1.0)


@pytest.mark.parametrize("key", ["c", "d"])
def test_ctrl_c_stops_and_ends(key: str) -> None:
    state, _ = step_drive(start_drive(SETTINGS), Key("i"), 0.0)
    state, motion = step_drive(state, Key(key, ctrl=True), 0.1)
    assert state.quit
    assert motion == STILL
