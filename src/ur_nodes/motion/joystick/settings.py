"""Upstream's parameters of teleop_twist_joy."""

from __future__ import annotations

from collections.abc import Sequence

from ur_nodes.motion.joystick.joy_teleop import ANGULAR, LINEAR, JoyTeleopSettings, Speeds
from ur_nodes.ports.parameters import Parameters


def read_settings(own: Parameters) -> JoyTeleopSettings:
    """Read axes and scales: one number each, or one for each direction below `axis_linear/` etc. Raises UserError."""
    axis_linear = _by_name(own, "axis_linear", LINEAR, "x", 1.0)
    axis_angular = _by_name(own, "axis_angular", ANGULAR, "yaw", 0.0)
    linear = _by_name(own, "scale_linear", LINEAR, "x", 0.5, live="full deflection, m/s")
    angular = _by_name(own, "scale_angular", ANGULAR, "yaw", 0.5, live="full deflection, rad/s")
    return JoyTeleopSettings(
        {name: int(number) for name, number in axis_linear.items()},
        {name: int(number) for name, number in axis_angular.items()},
        Speeds(linear, angular),
        Speeds(
            _by_name(own, "scale_linear_turbo", LINEAR, "x", 1.0, live="with turbo, m/s"),
            _by_name(own, "scale_angular_turbo", ANGULAR, "yaw", angular.get("yaw", 0.5), live="with turbo, rad/s"),
        ),
        enable_button=own.integer("enable_button", 0, minimum=-1),
        enable_turbo_button=own.integer("enable_turbo_button", -1, minimum=-1),
        stop_button=own.integer("stop_button", -1, minimum=-1),
        release_button=own.integer("release_button", -1, minimum=-1),
        speed_limit=own.limit("speed_limit", 1000.0, minimum=0.0, live="greatest speed, m/s"),
        turn_limit=own.limit("turn_limit", 1000.0, minimum=0.0, live="greatest turn, rad/s"),
    )


def _by_name(
    own: Parameters, key: str, names: Sequence[str], usual: str, default: float, live: str = ""
) -> dict[str, float]:
    """Return the parameter as a mapping, from either of its two forms."""
    value = own.any(key)
    if not isinstance(value, dict):
        return {usual: own.number(key, default, live=live)}
    below = own.below(key)
    for name in value:
        if name not in names:
            below.fail(name, value[name], f"one of {', '.join(names)} as its name", names)
    return {name: below.number(name, live=live) for name in value}
