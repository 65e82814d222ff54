"""Records of a Linux joystick device, and the state that follows from them.

The format is that of /dev/input/js* (the kernel's Documentation/input/joydev/joystick-api.rst): records of 8 bytes,
little-endian on the machines that ROS runs on: time (ms, u32), value (s16), type (u8), number (u8). After opening come
records of the initial state.
"""

import struct
from dataclasses import dataclass, replace
from typing import TypeVar

RECORD = struct.Struct("=IhBB")
_BUTTON, _AXIS, _INITIAL = 0x01, 0x02, 0x80
_FULL = 32767.0
_Value = TypeVar("_Value")


@dataclass(frozen=True, slots=True)
class JoystickSettings:
    """Axes within `deadzone` (0 to 1) of the centre are 0. `sticky_buttons` toggle at each press."""

    deadzone: float = 0.05
    sticky_buttons: bool = False


@dataclass(frozen=True, slots=True)
class JoystickState:
    """Axes from -1 to 1 (left and up are positive, as in joy_node), buttons 0 or 1."""

    axes: tuple[float, ...] = ()
    buttons: tuple[int, ...] = ()


def apply_records(state: JoystickState, data: bytes, settings: JoystickSettings) -> tuple[JoystickState, bool, bytes]:
    """The state after the records in `data`; whether a record was an event, not just the initial state; the rest.

    The rest is an incomplete record: prepend it to the next data.
    """
    event = False
    whole = len(data) - len(data) % RECORD.size
    for _, value, kind, number in RECORD.iter_unpack(data[:whole]):
        event = event or not kind & _INITIAL
        if kind & ~_INITIAL == _AXIS:
            state = replace(state, axes=_set(state.axes, number, scale_axis(value, settings.deadzone), 0.0))
        elif kind & ~_INITIAL == _BUTTON:
            pressed = _press(state, number, value, kind, settings)
            state = replace(state, buttons=_set(state.buttons, number, pressed, 0))
    return state, event, data[whole:]


def scale_axis(value: int, deadzone: float) -> float:
    """A raw axis value as -1 to 1: 0 within the dead zone, from its edge on linear up to 1."""
    raw = max(-1.0, min(1.0, value / _FULL))
    if abs(raw) <= deadzone:
        return 0.0
    beyond = (abs(raw) - deadzone) / (1.0 - deadzone)
    return -beyond if raw > 0.0 else beyond


def let_go(state: JoystickState) -> JoystickState:
    """Return the same joystick with all buttons and axes released."""
    return JoystickState((0.0,) * len(state.axes), (0,) * len(state.buttons))


def _press(state: JoystickState, number: int, value: int, kind: int, settings: JoystickSettings) -> int:
    if not settings.sticky_buttons or kind & _INITIAL:
        return 1 if value else 0
    before = state.buttons[number] if number < len(state.buttons) else 0
    return 1 - before if value else before


def _set(values: tuple[_Value, ...], number: int, value: _Value, missing: _Value) -> tuple[_Value, ...]:
    longer = (*values, *[missing] * (number + 1 - len(values)))
    return (*longer[:number], value, *longer[number + 1 :])
