from dataclasses import replace

from ur_nodes.exploration.navigation import MuxMessages, note_time, reason_to_pause
from ur_nodes.motion.lease.text import Lease

BEGUN = note_time(MuxMessages(), 0.0)


def test_nobody_else_drives() -> None:
    for active in ("", "idle", "navigation"):
        assert reason_to_pause(replace(BEGUN, active=active), 1.0, 5.0) == ""


def test_driver_with_the_keys_pauses_it_and_it_goes_on_after_a_while() -> None:
    driven = note_time(replace(BEGUN, active="keyboard"), 10.0)
    assert reason_to_pause(driven, 10.0, 5.0).startswith("the keyboard drives")
    after = note_time(replace(driven, active="idle"), 12.0)
    assert reason_to_pause(after, 12.0, 5.0) == "another client drove the robot; it goes on in 3 s"
    assert reason_to_pause(after, 15.1, 5.0) == ""


def test_emergency_stop_pauses_until_it_is_released() -> None:
    assert reason_to_pause(replace(BEGUN, stopped=True), 100.0, 5.0).startswith("the emergency stop is on")
    assert reason_to_pause(BEGUN, 100.0, 5.0) == ""


def test_client_that_takes_the_lease_pauses_it_and_the_one_of_the_begin_does_not() -> None:
    ours = note_time(MuxMessages(lease=Lease("held", "a", "laptop")), 0.0)
    assert reason_to_pause(ours, 1.0, 5.0) == ""
    theirs = replace(ours, lease=Lease("held", "b", "desk"))
    assert reason_to_pause(theirs, 1.0, 5.0).startswith("desk drives")
    assert reason_to_pause(replace(theirs, lease=Lease("lost", "b", "desk")), 1.0, 5.0).startswith("desk drives")


def test_goal_of_another_program_pauses_it() -> None:
    assert "another program" in reason_to_pause(replace(BEGUN, foreign=True), 1.0, 5.0)
