"""A battery whose charge is counted."""

from ur.robot.base import BatteryProperties
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery as State
from ur_nodes.simulator.sensors.sense import Send, Sense, Site

SECONDS_PER_HOUR = 3600.0


class BatteryCharge:
    """The charge of a battery. Its voltage falls in a straight line from full to empty; it does not fall under load."""

    def __init__(self, battery: BatteryProperties, fraction: float = 1.0) -> None:
        """`fraction` of its capacity is in it at first."""
        self._battery = battery
        self._charge = battery.design_capacity * min(1.0, max(0.0, fraction))
        self._current = 0.0

    @property
    def charge(self) -> float:
        """The remaining charge, Ah."""
        return self._charge

    @property
    def fraction(self) -> float:
        """The remaining charge as a share, 0 to 1."""
        return self._charge / self._battery.design_capacity

    @property
    def voltage(self) -> float:
        """V."""
        empty, full = self._battery.voltage_empty, self._battery.voltage_full
        return empty + self.fraction * (full - empty)

    @property
    def current(self) -> float:
        """The recent current into the battery, A: negative, for it is drawn from it."""
        return -self._current

    def draw(self, effort: float, seconds: float) -> None:
        """Some time in which the base moved at the share `effort` (0 to 1) of its full speed, on average."""
        idle = self._battery.current_idle
        self._current = idle + effort * (self._battery.current_moving - idle)
        self._charge = max(0.0, self._charge - self._current * seconds / SECONDS_PER_HOUR)


class BatterySense(Sense):
    """The battery of one robot: it gives what the wheels take."""

    rate = 1.0  # Hz

    def __init__(self, battery: BatteryProperties, site: Site) -> None:
        self._battery, self._site = battery, site
        self.begin()

    def begin(self) -> None:
        """It is as full as at first."""
        self.charge = BatteryCharge(self._battery, self._site.charge)
        self._rolled, self._aside = self._read_wheels()

    def _read_wheels(self) -> tuple[tuple[float, float], float]:
        physics, robot = self._site.physics, self._site.robot
        return physics.wheel_angles(robot), physics.rolled_aside(robot)

    def sample(self, time: float) -> None:  # noqa: ARG002 - it is due at its rate
        """Draw what the wheels took since the last time."""
        rolled, aside = self._read_wheels()
        turned = sum(abs(now - then) for now, then in zip(rolled, self._rolled, strict=True)) / 2.0
        speed = (turned * self._site.base.wheels.radius + abs(aside - self._aside)) * self.rate
        self._rolled, self._aside = rolled, aside
        self.charge.draw(min(1.0, speed / self._site.base.limits.velocity), 1.0 / self.rate)

    def advertise(self, node: Node, prefix: str, quality: Quality) -> Send:
        """Open the topic of its state."""
        publisher = node.publish(prefix + self._battery.topic, State, quality)

        def send(_time: float, stamp: int) -> None:
            if publisher.subscribers():
                now, battery = self.charge, self._battery
                state = now.voltage, now.current, now.charge, battery.design_capacity, now.fraction
                publisher.send(State(stamp, *state, technology=battery.technology))

        return send


SENSE = BatterySense
