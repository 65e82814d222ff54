"""Joystick to velocities, and where they go: nothing moves unless the dead-man button is held."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, Protocol

from ur_nodes.motion.challenge.link import AdaptivePublisher, FreshPublisher
from ur_nodes.motion.joystick.device import JoystickState
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Twist


class JoyCommander(Protocol):
    """Publishes velocities while the dead-man button is held and briefly afterwards. No call blocks."""

    def publish(self, twist: Twist, *, held: bool) -> None:
        """Publish a velocity; `held`: the dead-man button is held."""


class PlainJoyCommander:
    """Twist, for a base without a mux of ours."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.publish("cmd_vel", Twist)

    def publish(self, twist: Twist, *, held: bool) -> None:  # noqa: ARG002 - see JoyCommander
        """Publish a velocity."""
        self._publisher.send(twist)


class LeasedJoyCommander:
    """Stamped commands for a mux.

    The joystick drives while its dead-man button is held: pressing it requests the lease as UR_LEASE specifies, and
    releasing it releases a lease that was acquired so. A lease that the run had before, by its keyboard, is kept.
    """

    def __init__(self, node: Node, mux: str, *, adaptive: bool) -> None:
        """With `adaptive`, publish plain commands where there is no mux of ours: see AdaptivePublisher."""
        self._log = node.log
        self._lease = LeaseClient(node, mux, "joystick", conduct="watch")
        self._conduct = self._lease.identity.conduct
        publisher = AdaptivePublisher if adaptive else FreshPublisher
        self._publisher = publisher("cmd_vel", self._lease.link, self._lease.client)
        self._held = False
        self._borrowed = False
        self._sent: tuple[int | None, Twist] | None = None

    def publish(self, twist: Twist, *, held: bool) -> None:
        """Publish a velocity, unless another client drives. An unchanged one is not sent again."""
        if isinstance(self._publisher, AdaptivePublisher) and self._publisher.plain:
            self._publisher.send(twist)
            return
        view = self._lease.view()
        if held and not self._held:
            self._begin(mine=view.mine)
        if view.mine or (view.state == "free" and self._conduct != "watch"):
            what = (self._lease.link.newest(), twist)
            if what != self._sent or not held:
                self._publisher.send(twist)
                self._sent = what
        elif held:
            program = f" ({view.program})" if view.program else ""
            other = f"{view.holder}{program} drives" if view.state == "held" else "no mux has sent a lease"
            if view.state == "lost":
                other = f"{view.holder}{program} drove and is out of reach"
            way = "press the button again" if self._conduct == "take" else "UR_LEASE=take lets it take over"
            self._log.warn(f"the joystick does not drive: {other}; {way}", every=5.0)
        if self._held and not held and self._borrowed:
            self._borrowed = False
            self._lease.release(final=False)
        self._held = held

    def _begin(self, *, mine: bool) -> None:
        """Request the lease when the button is pressed."""
        self._borrowed = not mine and self._conduct != "watch"
        if mine or self._conduct == "watch":
            return
        {"drive": self._lease.acquire, "take": self._lease.take_over, "ask": self._lease.ask}[self._conduct]()


def make_joy_commander(node: Node, mux: str) -> JoyCommander:
    """Make the commander that the parameter `lease` selects. Raises UserError.

    It is `true`, `false` or `auto`: yes if there is a mux of ours, unless the commands go to a topic that is called
    cmd_vel, a base's own.
    """
    lease = node.parameters.text("lease", "auto", choices=("auto", "true", "false"))
    on_base = node.resolve("cmd_vel").rsplit("/", 1)[-1] == "cmd_vel"
    if lease == "true" or (lease == "auto" and not on_base):
        return LeasedJoyCommander(node, mux, adaptive=lease == "auto")
    return PlainJoyCommander(node)


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
