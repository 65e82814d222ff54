"""Joystick to velocities: nothing moves unless the dead-man button is held."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from ur_nodes.motion.joystick.device import JoystickState

LINEAR = ("x", "y", "z")
ANGULAR = ("roll", "pitch", "yaw")
ZEROS = 3  # how often a stop is sent before silence: one message may be lost

ButtonRequest = Literal["stop", "release"]


@dataclass(frozen=True, slots=True)
class Speeds:
    """The velocities at full deflection (m/s, rad/s), by the names in LINEAR and ANGULAR."""

    linear: Mapping[str, float]
    angular: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class JoyTeleopSettings:
    """Axes by name, speeds, and button numbers; -1 is no button. `speed_limit`, `turn_limit`: m/s, rad/s."""

    axis_linear: Mapping[str, int]
    axis_angular: Mapping[str, int]
    normal: Speeds
    turbo: Speeds
    enable_button: int = 0
    enable_turbo_button: int = -1
    stop_button: int = -1
    release_button: int = -1
    speed_limit: float = float("inf")
    turn_limit: float = float("inf")


@dataclass(frozen=True, slots=True)
class JoyTwist:
    """A velocity: x, y, z in m/s; roll, pitch, yaw rates in rad/s."""

    linear: tuple[float, float, float] = (0.0, 0.0, 0.0)
    angular: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class JoyTeleopState:
    """The state after the joystick's last report."""

    settings: JoyTeleopSettings
    zeros_left: int = 0
    pressed: frozenset[int] = field(default_factory=frozenset)

    @property
    def held(self) -> bool:
        """Return whether a dead-man button is held."""
        return _held_speeds(self.settings, self.pressed) is not None


def step_joy_teleop(
    state: JoyTeleopState, joystick: JoystickState
) -> tuple[JoyTeleopState, JoyTwist | None, ButtonRequest | None]:
    """Return the state after a joystick report, the velocity to send or None, and the request of a pressed button.

    While a dead-man button is held, each report results in a velocity; afterwards the next `ZEROS` reports result in
    zero.
    """
    settings = state.settings
    pressed = frozenset(number for number, value in enumerate(joystick.buttons) if value)
    new = pressed - state.pressed
    request: ButtonRequest | None = None
    if settings.stop_button in new:
        request = "stop"
    elif settings.release_button in new:
        request = "release"
    state = replace(state, pressed=pressed)
    speeds = _held_speeds(settings, pressed)
    if speeds is not None:
        return replace(state, zeros_left=ZEROS), _twist(settings, speeds, joystick.axes), request
    if state.zeros_left:
        return replace(state, zeros_left=state.zeros_left - 1), JoyTwist(), request
    return state, None, request


def _held_speeds(settings: JoyTeleopSettings, pressed: frozenset[int]) -> Speeds | None:
    if settings.enable_turbo_button in pressed:
        return settings.turbo
    return settings.normal if settings.enable_button in pressed else None


def _twist(settings: JoyTeleopSettings, speeds: Speeds, axes: Sequence[float]) -> JoyTwist:
    x, y, z = (_deflection(settings.axis_linear, speeds.linear, name, axes, settings.speed_limit) for name in LINEAR)
    roll, pitch, yaw = (
        _deflection(settings.axis_angular, speeds.angular, name, axes, settings.turn_limit) for name in ANGULAR
    )
    return JoyTwist((x, y, z), (roll, pitch, yaw))


def _deflection(
    axis: Mapping[str, int], scale: Mapping[str, float], name: str, axes: Sequence[float], limit: float
) -> float:
    number = axis.get(name, -1)
    if not 0 <= number < len(axes):
        return 0.0
    value = axes[number] * scale.get(name, 0.0)
    return max(-limit, min(limit, value)) if math.isfinite(value) else 0.0  # min and max pass a limit on for NaN
