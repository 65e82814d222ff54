import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.motion.ramp import Axis, approach

AXIS = Axis(speed=0.5, speed_up=1.0, slow_down=4.0)
SPEEDS = st.floats(-0.5, 0.5)


@given(value=SPEEDS, target=st.floats(), seconds=st.floats(0.0, 1.0))
def test_approach_stays_within_the_limits(value: float, target: float, seconds: float) -> None:
    after = approach(value, target, AXIS, seconds)
    assert abs(after) <= 0.5
    assert abs(after) - abs(value) <= 1.0 * seconds + 1e-12
    assert abs(after - value) <= 4.0 * seconds + 1e-12


@given(value=SPEEDS, target=SPEEDS)
def test_approach_arrives_and_never_overshoots(value: float, target: float) -> None:
    low, high = min(value, target), max(value, target)
    for _ in range(70):
        value = approach(value, target, AXIS, 0.01)
        assert low - 1e-12 <= value <= high + 1e-12
    assert value == target


@pytest.mark.parametrize(
    ("value", "target", "seconds", "after"),
    [
        (0.0, 0.5, 0.1, 0.1),  # speeds up
        (0.5, 0.0, 0.1, 0.1),  # slows down
        (-0.5, -0.2, 0.05, -0.3),
        (0.2, -0.5, 0.1, -0.05),  # brakes for 0.05 s, then speeds up the other way
        (0.4, 0.4, 0.0, 0.4),
        (0.4, float("nan"), 1.0, 0.0),
        (0.0, 9.0, 1.0, 0.5),
    ],
)
def test_approach_takes_the_quickest_way(value: float, target: float, seconds: float, after: float) -> None:
    assert approach(value, target, AXIS, seconds) == pytest.approx(after)
