import pytest

from ur_nodes.exploration.explorer import Pace


def grow(rate: float, until: float, pace: Pace | None = None, begin: float = 0.0) -> Pace:
    """A map that grows by so many m2 a second; a sample each 0.5 s."""
    pace = pace or Pace()
    for half in range(int((until - begin) * 2) + 1):
        now = begin + half / 2.0
        pace = pace.note(now, 20.0 + rate * now)
    return pace


def test_time_left_is_in_proportion_to_the_unknown_floor_and_the_growth() -> None:
    left = grow(0.5, 40.0).seconds_left(30.0)
    assert left == pytest.approx(132.0)
    assert left is not None
    assert grow(1.0, 40.0).seconds_left(30.0) == pytest.approx(left / 2)
    assert grow(0.5, 40.0).seconds_left(60.0) == pytest.approx(left * 2)


def test_nothing_is_said_in_the_first_half_minute_or_with_nothing_left() -> None:
    assert Pace().seconds_left(30.0) is None
    assert grow(0.5, 29.0).seconds_left(30.0) is None
    assert grow(0.5, 31.0).seconds_left(30.0) is not None
    assert grow(0.5, 31.0).seconds_left(0.0) is None


@pytest.mark.parametrize("rate", [0.04, 0.0, -0.5])
def test_nothing_is_said_while_the_map_hardly_grows_or_shrinks(rate: float) -> None:
    assert grow(rate, 60.0).seconds_left(30.0) is None


def test_only_the_last_minute_counts() -> None:
    slower = grow(0.5, 200.0, grow(5.0, 100.0), 100.5)
    assert slower.seconds_left(30.0) == pytest.approx(132.0)
    assert len(slower.samples) <= 62


def test_time_that_begins_anew_forgets_what_was_before() -> None:
    assert grow(0.5, 10.0, grow(0.5, 60.0)).seconds_left(30.0) is None
