"""Plain commands: a steady rhythm drives, what a network has held back does not."""

from itertools import accumulate

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.motion.admission.probation import (
    CLUSTER,
    PROOF,
    TOO_CLOSE,
    LockRelease,
    Probation,
    describe_slow,
    rate_needed,
    step_lock_release,
    step_probation,
    too_slow,
)

TIMEOUT = 0.15


def hear(
    times: list[float], state: Probation | None = None, *, motion: bool = True, aged: bool = False
) -> tuple[Probation, list[bool]]:
    state, accepted = state or Probation(TIMEOUT), []
    for at in times:
        state = step_probation(state, at, motion=motion, aged=aged)
        accepted.append(state.accepted)
    return state, accepted


def steady(count: int, rate: float = 30.0, begin: float = 0.0) -> list[float]:
    return [begin + n / rate for n in range(count)]


@pytest.mark.parametrize("rate", [7.0, 10.0, 30.0, 100.0])
def test_steady_publisher_drives_from_its_fifth_command_on(rate: float) -> None:
    _, accepted = hear(steady(20, rate))
    assert accepted == [False] * (PROOF - 1) + [True] * (20 - PROOF + 1)


@pytest.mark.parametrize("rate", [0.5, 5.0, 6.5])
def test_publisher_slower_than_the_timeout_allows_never_drives(rate: float) -> None:
    _, accepted = hear(steady(50, rate))
    assert not any(accepted)


def test_gap_puts_a_publisher_on_probation_again() -> None:
    state, _ = hear(steady(20))
    _, accepted = hear(steady(6, begin=20 / 30.0 + TIMEOUT), state)
    assert accepted == [False] * (PROOF - 1) + [True] * 2


def test_burst_after_a_gap_never_drives() -> None:
    state, _ = hear(steady(20))
    _, accepted = hear([10.0 + n * 0.0001 for n in range(251)], state)
    assert not any(accepted)


def test_burst_in_several_segments_never_drives() -> None:
    state, _ = hear(steady(20))
    segments = [10.0 + segment * 0.012 + n * 0.0001 for segment in range(12) for n in range(20)]
    _, accepted = hear(segments, state)
    assert not any(accepted)


def test_cluster_after_a_short_silence_puts_a_publisher_on_probation() -> None:
    state, _ = hear(steady(20))
    begin = 19 / 30.0 + 0.1
    _, accepted = hear([begin + n * 0.0005 for n in range(8)], state)
    assert accepted[CLUSTER - 1 :] == [False] * (8 - CLUSTER + 1)


def test_two_commands_together_do_not_stop_a_publisher_that_drives() -> None:
    state, _ = hear(steady(20))
    _, accepted = hear([0.70, 0.701, 0.75, 0.751], state)
    assert all(accepted)


def test_slow_publisher_is_reported_once_until_it_drives() -> None:
    state, _ = hear([0.0, 1.0])
    assert not too_slow(state, 1.1)[1]
    state, reported = too_slow(state, 1.2)
    assert reported
    assert describe_slow(state, "Twist") == "publishes Twist at 1 Hz; the robot drives at 10 Hz or more"
    state, _ = hear([2.0], state)
    assert not too_slow(state, 2.2)[1]
    state, _ = hear([*steady(8, begin=3.0), 4.0, 5.0], state)
    assert too_slow(state, 5.2)[1]


def test_single_command_is_reported_once_it_is_clear_that_no_other_follows() -> None:
    state, _ = hear([0.0])
    assert not too_slow(state, 2.0)[1]
    state, reported = too_slow(state, 3.1)
    assert reported
    assert describe_slow(state, "Twist") == "published a single Twist; the robot drives at 10 Hz or more"


def test_publisher_that_is_too_fast_is_reported() -> None:
    state, accepted = hear(steady(900, 300.0))
    assert not any(accepted)
    state, reported = too_slow(state, 900 / 300.0)
    assert reported
    text = "publishes Twist at 300 Hz, unsteadily; the robot drives at a steady 10 to 200 Hz"
    assert describe_slow(state, "Twist") == text


def test_publisher_of_zeros_is_not_reported() -> None:
    state, _ = hear([0.0], motion=False)
    assert not too_slow(state, 1.0)[1]


def test_needed_rate_drives() -> None:
    for timeout in (0.05, 0.1, 0.15, 0.2, 1.0):
        assert 1.0 / rate_needed(timeout) < timeout


@given(st.lists(st.floats(0.0, TOO_CLOSE * 0.99) | st.floats(TIMEOUT * 1.01, 10.0), max_size=80))
def test_no_rhythm_of_gaps_and_bursts_drives(gaps: list[float]) -> None:
    times = list(accumulate(gaps))
    assert not any(hear(times)[1])
    assert not any(hear(times, aged=True)[1])


@given(st.lists(st.floats(0.0, TOO_CLOSE) | st.floats(0.01, TIMEOUT), max_size=30))
def test_publisher_whose_commands_show_their_age_is_accepted_no_later(gaps: list[float]) -> None:
    times = list(accumulate(gaps))
    first, first_aged = ([*hear(times, aged=aged)[1], True].index(True) for aged in (False, True))
    assert first_aged <= first


def test_two_commands_that_a_thread_delivers_together_take_back_one() -> None:
    times = [0.0, 0.05, 0.15, 0.1501, 0.2, 0.25, 0.3, 0.35]
    assert hear(times, aged=True)[1].index(True) == 6
    assert hear(times)[1].index(True) == 7


def test_pairs_of_commands_never_drive_whether_or_not_they_show_their_age() -> None:
    times = [n // 2 * 0.1 + n % 2 * 0.001 for n in range(100)]
    assert not any(hear(times)[1])
    assert not any(hear(times, aged=True)[1])


def test_lock_is_obeyed_at_once_and_its_end_only_from_a_new_publisher_or_repeated() -> None:
    state, obeyed = step_lock_release(LockRelease(0.0), 0.0, locked=True, new=True)
    assert obeyed
    state, obeyed = step_lock_release(state, 20.0, locked=False, new=False)
    assert not obeyed
    _, obeyed = step_lock_release(state, 20.5, locked=False, new=True)
    assert obeyed
    for n in range(PROOF):
        state, obeyed = step_lock_release(state, 30.0 + n * 0.5, locked=False, new=False)
    assert obeyed


def test_burst_of_ends_of_a_lock_is_not_obeyed() -> None:
    state, _ = step_lock_release(LockRelease(0.5), 0.0, locked=False, new=True)
    for n in range(100):
        state, obeyed = step_lock_release(state, 20.0 + n * 0.001, locked=False, new=False)
        assert not obeyed
