from __future__ import annotations

from ur_nodes.drivers.bumper_states import HOLD, BumperStates


def test_first_call_tells_all_and_later_ones_what_changed() -> None:
    states = BumperStates(["left", "right"])
    assert states.changes(5.0) == {"left": False, "right": False}
    assert states.changes(5.1) == {}
    states.press("left", 5.2)
    assert states.changes(5.2) == {"left": True}
    states.press("left", 5.2 + HOLD)
    assert states.changes(5.3 + HOLD) == {}
    assert states.changes(5.3 + 2 * HOLD) == {"left": False}


def test_unknown_name_changes_nothing() -> None:
    states = BumperStates(["left"])
    states.changes(0.0)
    states.press("roof", 0.0)
    assert states.changes(0.0) == {}


def test_clock_that_jumps_back_releases_what_was_pressed() -> None:
    states = BumperStates(["left"])
    states.press("left", 100.0)
    assert states.changes(100.0) == {"left": True}
    assert states.changes(1.0) == {"left": False}
