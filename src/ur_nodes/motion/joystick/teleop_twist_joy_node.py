"""The node `teleop_node`: drives with a joystick, in place of upstream's, with a button for emergency stops.

Turns each `joy` into at most one command: it never repeats a command without a new input. A command is as new as the
`joy` that it is made of, so reader and teleop have to run on the same computer.
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from ur_nodes.motion.joystick.device import JoystickState
from ur_nodes.motion.joystick.joy_origin import JoyOrigin
from ur_nodes.motion.joystick.joy_teleop import (
    ANGULAR,
    LINEAR,
    ButtonRequest,
    JoyTeleopSettings,
    JoyTeleopState,
    JoyTwist,
    Speeds,
    make_joy_commander,
    step_joy_teleop,
)
from ur_nodes.ports.node import Node, Sender
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Joystick, Result, Twist
from ur_nodes.run import run


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


_PATIENCE: dict[ButtonRequest, float] = {"stop": 30.0, "release": 1.0}  # s: a stop may be late, nothing else


def start(node: Node) -> None:
    """Read the parameters and connect. Raises UserError."""
    mux = node.parameters.text("mux", "cmd_vel_mux")
    origin = JoyOrigin(node, remote=node.parameters.boolean("remote_joy", False))
    state = node.parameters.follow(lambda own: JoyTeleopState(read_settings(own)), lambda fresh: use(fresh))
    commander = make_joy_commander(node, mux)

    def use(fresh: JoyTeleopState) -> None:
        nonlocal state
        state = replace(state, settings=fresh.settings)

    def on_joystick(joystick: Joystick, sender: Sender | None) -> None:
        nonlocal state
        accepted = origin.accepts(sender, joystick.stamp)
        state, twist, request = step_joy_teleop(state, JoystickState(joystick.axes, joystick.buttons))
        if not accepted:
            twist, request = None, request if request == "stop" else None
        if twist is not None:
            commander.publish(_velocity_of(twist), held=state.held)
        if request is not None:
            ask(request)

    def ask(request: ButtonRequest) -> None:
        service = node.resolve(f"{mux}/{request}")
        node.call(service, Trigger(), partial(report, service), _PATIENCE[request])

    def report(service: str, answer: Result) -> None:
        if answer.success:
            node.log.warn(f"{service}: {answer.text}")
        else:
            node.log.error(f"{service}: {answer.text}, expected the answer of a cmd_vel_mux")

    node.subscribe_from("joy", Joystick, on_joystick)


def _velocity_of(twist: JoyTwist) -> Twist:
    (x, y, z), (roll, pitch, yaw) = twist.linear, twist.angular
    return Twist(x, yaw, y, z, roll, pitch)


def main() -> int:
    """Run until shutdown. Returns the exit code."""
    return run("teleop_twist_joy", start)


if __name__ == "__main__":
    sys.exit(main())
