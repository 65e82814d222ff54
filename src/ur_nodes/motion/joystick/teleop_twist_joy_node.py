"""Drive with a joystick: the stand-in for teleop_twist_joy. Beside the dead-man button it knows one for emergencies."""

from __future__ import annotations

import sys
import threading
from collections.abc import Sequence

import rospy
from geometry_msgs.msg import Twist, Vector3
from sensor_msgs.msg import Joy
from std_srvs.srv import Trigger

from ur_nodes.motion.joystick.device import JoystickState
from ur_nodes.motion.joystick.joy_commander_node import JoyCommander, make_joy_commander
from ur_nodes.motion.joystick.joy_origin_node import JoyOrigin
from ur_nodes.motion.joystick.joy_teleop import (
    ANGULAR,
    LINEAR,
    ButtonRequest,
    JoyTeleopSettings,
    JoyTeleopState,
    Speeds,
    step_joy_teleop,
)
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.shell import run_node


class TeleopTwistJoy:
    """Turns each `joy` into at most one command: it never repeats a command without a new input.

    A command is as new as the `joy` that it is made of, so reader and teleop have to run on the same computer.
    """

    def __init__(self, settings: JoyTeleopSettings, mux: str, commander: JoyCommander, origin: JoyOrigin) -> None:
        """`mux` is the name of the node that offers `stop` and `release`."""
        self._state = JoyTeleopState(settings)
        self._mux = mux
        self._lock = threading.Lock()
        self._commander = commander
        self._origin = origin
        rospy.Subscriber("joy", Joy, self._on_joy, queue_size=1, tcp_nodelay=True)

    def _on_joy(self, message: Joy) -> None:
        publisher = str((getattr(message, "_connection_header", None) or {}).get("callerid", ""))
        with self._lock:
            accepted = self._origin.accepts(publisher)
            joystick = JoystickState(tuple(message.axes), tuple(message.buttons))
            self._state, twist, request = step_joy_teleop(self._state, joystick)
            if not accepted:  # a stop may be late, nothing else
                twist, request = None, request if request == "stop" else None
            if twist is not None:
                message = Twist(Vector3(*twist.linear), Vector3(*twist.angular))
                self._commander.publish(message, held=self._state.held)
        if request is not None:
            threading.Thread(target=self._ask, args=(request,), daemon=True).start()

    def _ask(self, request: ButtonRequest) -> None:
        service = rospy.resolve_name(f"{self._mux}/{request}")
        try:
            answer = rospy.ServiceProxy(service, Trigger)()
        except (rospy.ServiceException, rospy.ROSException) as problem:
            rospy.logerr("%s: %s, expected the answer of a cmd_vel_mux", service, problem)
        else:
            rospy.logwarn("%s: %s", service, answer.message)


def read_settings(own: Parameters) -> JoyTeleopSettings:
    """Upstream's parameters: axes and scales are one number, or one for each direction below `axis_linear/` etc.

    Raises UserError.
    """
    axis_linear = _by_name(own, "axis_linear", LINEAR, "x", 1.0)
    axis_angular = _by_name(own, "axis_angular", ANGULAR, "yaw", 0.0)
    linear = _by_name(own, "scale_linear", LINEAR, "x", 0.5)
    angular = _by_name(own, "scale_angular", ANGULAR, "yaw", 0.5)
    return JoyTeleopSettings(
        {name: int(number) for name, number in axis_linear.items()},
        {name: int(number) for name, number in axis_angular.items()},
        Speeds(linear, angular),
        Speeds(
            _by_name(own, "scale_linear_turbo", LINEAR, "x", 1.0),
            _by_name(own, "scale_angular_turbo", ANGULAR, "yaw", angular.get("yaw", 0.5)),
        ),
        enable_button=own.integer("enable_button", 0, minimum=-1),
        enable_turbo_button=own.integer("enable_turbo_button", -1, minimum=-1),
        stop_button=own.integer("stop_button", -1, minimum=-1),
        release_button=own.integer("release_button", -1, minimum=-1),
        speed_limit=own.number("speed_limit", 1000.0, minimum=0.0),
        turn_limit=own.number("turn_limit", 1000.0, minimum=0.0),
    )


def _by_name(own: Parameters, key: str, names: Sequence[str], usual: str, default: float) -> dict[str, float]:
    """The parameter as a mapping, in either of its two forms."""
    value = rospy.get_param("~" + key, None)
    if not isinstance(value, dict):
        return {usual: own.number(key, default)}
    below = own.below(key)
    for name in value:
        if name not in names:
            below.fail(name, value[name], f"one of {', '.join(names)} as its name", names)
    return {name: below.number(name) for name in value}


def start() -> None:
    """Read the parameters and run. Raises UserError."""
    own = Parameters()
    mux = own.text("mux", "cmd_vel_mux")
    origin = JoyOrigin(remote=own.boolean("remote_joy", False))
    TeleopTwistJoy(read_settings(own), mux, make_joy_commander(own, mux), origin)


def main() -> int:
    """Run until shutdown. Returns the exit code."""
    return run_node("teleop_twist_joy", start)


if __name__ == "__main__":
    sys.exit(main())
