"""Plain commands: a steady rhythm drives, what a network has held back does not."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.motion.admission.probation import (
    CLUSTER,
    PROOF,
    TOO_CLOSE,
    LockRelease,
    Probation,
    rate_needed,
    step_lock_release,
    step_probation,
    too_slow,
)

TIMEOUT = 0.15


def hear(times: list[float], state: Probation | None = None, *, motion: bool = True) -> tuple[Probation, list[bool]]:
    state, accepted = state or Probation(TIMEOUT), []
    for at in times:
        state = step_probation(state, at, motion=motion)
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
    state, _ = hear([0.0])
    assert not too_slow(state, 0.1)[1]
    state, reported = too_slow(state, 0.2)
    assert reported
    state, _ = hear([1.0], state)
    assert not too_slow(state, 1.2)[1]
    state, _ = hear([*steady(8, begin=2.0), 3.0], state)
    assert too_slow(state, 3.2)[1]


def test_publisher_of_zeros_is_not_reported() -> None:
    state, _ = hear([0.0], motion=False)
    assert not too_slow(state, 1.0)[1]


def test_needed_rate_drives() -> None:
    for timeout in (0.05, 0.1, 0.15, 0.2, 1.0):
        assert 1.0 / rate_needed(timeout) < timeout


@given(st.lists(st.floats(0.0, TOO_CLOSE * 0.99) | st.floats(TIMEOUT * 1.01, 10.0), max_size=80))
def test_no_rhythm_of_gaps_and_bursts_drives(gaps: list[float]) -> None:
    now, state = 0.0, Probation(TIMEOUT)
    for gap in gaps:
        now += gap
        state = step_probation(state, now, motion=True)
        assert not state.accepted


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
