"""Values over time, drawn with characters."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.robot.wireless.plot import GAP, log_scale, plot, plot_bars

VALUES = st.lists(st.none() | st.floats(-1e6, 1e6), max_size=50)


def test_rising_values_rise_to_the_right() -> None:
    assert plot([0, 1, 2, 3], 0, 3, 2, 1) == ["⡠⠊"]
    assert plot([0.0] * 4 + [7.0] * 4, 0, 7, 4, 2) == ["  ⠉⠉", "⣀⣀  "]


def test_latest_values_are_at_the_right_and_older_ones_leave_at_the_left() -> None:
    assert plot([0, 0], 0, 1, 3, 1) == ["  ⣀"]
    assert plot([1, 1, 1, 1, 0, 0], 0, 1, 1, 1) == ["⣀"]


def test_gap_is_marked_at_the_bottom_and_empty_time_is_not() -> None:
    assert plot([1, 1, None, None, 1, 1], 0, 1, 4, 2) == [" ⠉ ⠉", f"  {GAP} "]


@given(VALUES, st.integers(1, 30), st.integers(1, 6))
def test_plot_has_the_size_that_was_asked_for(values: list[float | None], width: int, height: int) -> None:
    lines = plot(values, -5.0, 5.0, width, height)
    assert [len(line) for line in lines] == [width] * height
    dots = sum(bin(ord(sign) - 0x2800).count("1") for line in lines for sign in line if ord(sign) >= 0x2800)
    assert dots == sum(value is not None for value in values[-2 * width :])
    assert len(plot_bars([value and abs(value) for value in values], width)) == width


@pytest.mark.parametrize(
    ("parts", "bars"), [([], "    "), ([1.0, 0.0, 0.001], "  █▁"), ([0.0, 0.0], "    "), ([0.5], "   ▄")]
)
def test_any_loss_is_seen_and_the_greater_of_two_counts(parts: list[float | None], bars: str) -> None:
    assert plot_bars(parts, 4) == bars


def test_latencies_are_spread_over_decades() -> None:
    assert log_scale([1.0, 0.001, None, 0.0]) == [0.0, -3.0, None, -6.0]
