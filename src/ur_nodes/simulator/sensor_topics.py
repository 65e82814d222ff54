"""The topics of one simulated robot's sonars, bumpers, cliff sensors, inertial unit and battery."""

from __future__ import annotations

from ur.robot.base import Bumpers, Cliffs
from ur_nodes.ports.node import Node, Publisher
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Imu, Range
from ur_nodes.simulator.settings import SimulatorSettings
from ur_nodes.simulator.simulation import Simulation, SimulationTick

_ORIENTATION_VARIANCE = 1e-6  # rad^2


class SensorTopics:
    """Publishers for what the base has. Topics without listeners cost nothing, latched ones aside."""

    def __init__(
        self, node: Node, simulation: Simulation, robot: int, prefix: str, settings: SimulatorSettings
    ) -> None:
        """`prefix` is put before topics and frames: '' for a single robot, else 'robot_<n>/'."""
        base = simulation.base
        self._simulation = simulation
        self._robot = robot
        self._prefix = prefix
        quality = settings.quality
        self._sonars = node.publish(prefix + base.sonars.topic, Range, quality) if base.sonars else None
        self._imu = node.publish(prefix + base.imu.topic, Imu, quality) if base.imu else None
        self._battery = node.publish(prefix + base.battery.topic, Battery, quality) if base.battery else None
        self._bumpers = _Switches(node, prefix, base.bumpers)
        self._cliffs = _Switches(node, prefix, base.cliffs)

    def send(self, tick: SimulationTick, stamp: int) -> None:
        """Send the readings that are due."""
        if tick.sonars and self._sonars and self._sonars.listeners():
            self._send_ranges(self._sonars, stamp)
        if tick.imu and self._imu and self._imu.listeners():
            self._send_inertia(self._imu, stamp)
        if tick.battery and self._battery and self._battery.listeners():
            self._send_charge(self._battery, stamp)
        senses = self._simulation.senses[self._robot]
        self._bumpers.send(senses.pressed(self._simulation.time))
        self._cliffs.send(senses.cliffs())

    def _send_ranges(self, publisher: Publisher[Range], stamp: int) -> None:
        sonars = self._simulation.base.sonars
        assert sonars
        limits = sonars.field_of_view, sonars.range_min, sonars.range_max
        ranges = self._simulation.senses[self._robot].ranges().tolist()
        for sonar, value in zip(sonars.at, ranges, strict=True):
            publisher.send(Range(stamp, self._prefix + sonar.frame, value, *limits))

    def _send_inertia(self, publisher: Publisher[Imu], stamp: int) -> None:
        imu, reading = self._simulation.base.imu, self._simulation.senses[self._robot].inertia()
        if imu and reading:
            measured = reading.orientation, reading.turning, reading.force
            variances = _ORIENTATION_VARIANCE, imu.gyro_noise**2, imu.accel_noise**2
            publisher.send(Imu(stamp, self._prefix + imu.frame, *measured, *variances))

    def _send_charge(self, publisher: Publisher[Battery], stamp: int) -> None:
        battery, now = self._simulation.base.battery, self._simulation.senses[self._robot].battery
        if battery and now:
            state = now.voltage, now.current, now.charge, battery.design_capacity, now.fraction
            publisher.send(Battery(stamp, *state, technology=battery.technology))


class _Switches:
    """Bumpers or cliff sensors: a latched topic each, on which a state is sent when it changes."""

    def __init__(self, node: Node, prefix: str, part: Bumpers | Cliffs | None) -> None:
        topics = {each.name: f"{prefix}{part.topic}/{each.name}" for each in part.at} if part else {}
        self._topics = {name: node.publish(topic, bool, Quality.LATCHED) for name, topic in topics.items()}
        self._sent: dict[str, bool] = {}

    def send(self, states: dict[str, bool]) -> None:
        """Send the states, by name, that differ from those sent before."""
        if states == self._sent:
            return
        for name, state in states.items():
            if self._sent.get(name) is not state:
                self._sent[name] = state
                self._topics[name].send(state)
