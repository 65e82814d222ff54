"""Ages from stamps, on histories of (sent, arrived) as they were recorded over networks, by clocks that disagree."""

from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.motion.admission.admission import DRIFT, FALL, Stamps, step_stamps

PERIOD = 0.05
JITTER = (0.002, 0.011, 0.003, 0.018, 0.002, 0.004, 0.031, 0.002, 0.007, 0.002)  # s, of a WiFi
CLOCK = 1_700_000_000.0  # s: what the sender's clock shows at 0


def ages(history: Iterable[tuple[float, float]], state: Stamps | None = None) -> list[tuple[float, bool]]:
    """Age and fall of each message of a history of when it was sent, by the sender's clock, and when it arrived."""
    state = state or Stamps()
    found = []
    for sent, arrived in history:
        state, age, fell = step_stamps(state, round(sent * 1e9), arrived)
        found.append((age, fell))
    return found


def steady(count: int, delay: float = 0.002, begin: float = 0.0, clock: float = CLOCK) -> list[tuple[float, float]]:
    return [(clock + begin + n * PERIOD, begin + n * PERIOD + delay) for n in range(count)]


def test_age_is_the_delay_beyond_the_fastest_message() -> None:
    history = [(CLOCK + n * PERIOD, n * PERIOD + delay) for n, delay in enumerate(JITTER)]
    found = [age for age, _ in ages(history)]
    assert found == pytest.approx([delay - min(JITTER) for delay in JITTER], abs=5e-4)


def test_clocks_need_not_agree() -> None:
    for clock in (0.0, CLOCK, CLOCK + 3600.0, -5.0):
        assert max(age for age, _ in ages(steady(20, clock=clock))) < 1e-6


def test_burst_after_a_cut_is_as_old_as_it_is() -> None:
    cut = [(CLOCK + 1.0 + n * PERIOD, 6.0 + n * 0.001) for n in range(100)]
    found = [age for age, _ in ages(steady(20) + cut)][20:]
    for (sent, arrived), age in zip(cut, found, strict=True):
        assert age == pytest.approx(max(0.0, arrived - (sent - CLOCK) - 0.002), abs=6 * DRIFT)


def test_link_that_becomes_slow_for_good_shows_all_of_its_delay() -> None:
    late = steady(200, delay=0.502, begin=1.0)
    assert min(age for age, _ in ages(steady(20) + late)[20:]) > 0.49


def test_burst_of_a_publisher_that_is_new_shows_as_a_fall_until_its_queue_is_empty() -> None:
    drained = [(CLOCK + n * PERIOD, 5.0 + n * 0.02) for n in range(50)]  # 30 ms less late each
    found = ages(drained + steady(10, begin=5.0 + 50 * 0.02))
    assert all(fell for _, fell in found[1:50])
    assert not any(fell for _, fell in found[-8:])


def test_clock_that_is_set_ahead_shows_as_one_fall() -> None:
    found = ages(steady(20) + steady(20, begin=1.0, clock=CLOCK + 60.0))
    assert [fell for _, fell in found].count(True) == 1
    assert max(age for age, _ in found) < 1e-3


def test_commands_after_a_clock_was_set_back_are_late() -> None:
    found = ages(steady(20) + steady(20, begin=1.0, clock=CLOCK - 2.0))
    assert min(age for age, _ in found[20:]) > 1.9


def test_clocks_that_run_apart_make_nothing_late() -> None:
    slow = [(CLOCK + n * PERIOD * (1 - 0.9 * DRIFT), n * PERIOD) for n in range(20 * 3600)]
    assert max(age for age, _ in ages(slow)) < 1e-4


def test_jitter_below_the_limit_is_no_fall() -> None:
    history = [(CLOCK + n * PERIOD, n * PERIOD + 0.001 + FALL * 0.9 * (n % 2 == 0)) for n in range(20)]
    assert not any(fell for _, fell in ages(history))


@given(st.lists(st.tuples(st.integers(-(2**63), 2**63 - 1), st.floats(0.0, 1e6)), max_size=20))
def test_any_stamp_has_an_age(history: list[tuple[int, float]]) -> None:
    state = Stamps()
    for sent, arrived in history:
        state, age, _ = step_stamps(state, sent, arrived)
        assert age >= 0.0


@given(st.lists(st.floats(0.0, 3.0), min_size=1, max_size=40))
def test_age_never_exceeds_the_true_delay_and_falls_short_of_it_by_the_least_delay_and_drift(
    delays: list[float],
) -> None:
    found = ages((CLOCK + n * PERIOD, n * PERIOD + delay) for n, delay in enumerate(delays))
    least = float("inf")
    for delay, (age, _) in zip(delays, found, strict=True):
        least = min(least, delay)
        assert delay - least - 6 * DRIFT - 1e-6 <= age <= delay + 1e-6
