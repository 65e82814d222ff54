import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.motion.joystick.device import RECORD, JoystickSettings, JoystickState, apply_records, let_go, scale_axis

SETTINGS = JoystickSettings()


def record(kind: int, number: int, value: int) -> bytes:
    return RECORD.pack(1000, value, kind, number)


def test_records_add_up_to_the_state() -> None:
    data = record(0x82, 0, 0) + record(0x82, 1, 0) + record(0x81, 0, 0) + record(0x81, 2, 0)
    state, told, rest = apply_records(JoystickState(), data, SETTINGS)
    assert (state, told, rest) == (JoystickState((0.0, 0.0), (0, 0, 0)), False, b"")
    state, told, _ = apply_records(state, record(0x02, 1, -32767) + record(0x01, 2, 1), SETTINGS)
    assert (state, told) == (JoystickState((0.0, 1.0), (0, 0, 1)), True)
    assert let_go(state) == JoystickState((0.0, 0.0), (0, 0, 0))


def test_records_may_be_cut_anywhere() -> None:
    data = b"".join(record(2, n % 3, 9000 * (n % 4)) for n in range(6))
    whole = apply_records(JoystickState(), data, SETTINGS)[0]
    for cut in range(len(data)):
        state, _, rest = apply_records(JoystickState(), data[:cut], SETTINGS)
        assert apply_records(state, rest + data[cut:], SETTINGS)[0] == whole


def test_sticky_button_changes_at_each_press() -> None:
    settings = JoystickSettings(sticky_buttons=True)
    state = JoystickState()
    seen = []
    for value in (1, 0, 1, 0):
        state, _, _ = apply_records(state, record(1, 0, value), settings)
        seen.append(state.buttons[0])
    assert seen == [1, 1, 0, 0]


@pytest.mark.parametrize(
    ("value", "axis"), [(0, 0.0), (1600, 0.0), (-1600, 0.0), (32767, -1.0), (-32768, 1.0), (-17203, 0.5)]
)
def test_axis_is_scaled_beyond_the_dead_zone(value: int, axis: float) -> None:
    assert scale_axis(value, 0.05) == pytest.approx(axis, abs=1e-4)


@given(st.binary(max_size=200))
def test_any_bytes_give_a_state_within_bounds(data: bytes) -> None:
    state, _, rest = apply_records(JoystickState(), data, SETTINGS)
    assert all(-1.0 <= axis <= 1.0 for axis in state.axes)
    assert set(state.buttons) <= {0, 1}
    assert len(rest) < RECORD.size
