"""The topics of one simulated robot's sonars, bumpers, cliff sensors, inertial unit and battery."""

from __future__ import annotations

from typing import Any

import rospy
from geometry_msgs.msg import Quaternion, Vector3
from sensor_msgs.msg import BatteryState, Imu, Range
from std_msgs.msg import Bool

from ur.robot.base import Base, Bumpers, Cliffs
from ur_nodes.rosio.publishers import has_subscribers, make_publisher
from ur_nodes.simulator.settings import Settings
from ur_nodes.simulator.simulation import Simulation, Tick

# sensor_msgs/BatteryState knows no lead.
_TECHNOLOGIES = {
    "lifepo4": BatteryState.POWER_SUPPLY_TECHNOLOGY_LIFE,
    "lithium-ion": BatteryState.POWER_SUPPLY_TECHNOLOGY_LION,
    "lithium-polymer": BatteryState.POWER_SUPPLY_TECHNOLOGY_LIPO,
    "nicd": BatteryState.POWER_SUPPLY_TECHNOLOGY_NICD,
    "nimh": BatteryState.POWER_SUPPLY_TECHNOLOGY_NIMH,
}
_ORIENTATION_VARIANCE = 1e-6  # rad^2


class SensorTopics:
    """Publishers for what the base has. Topics without subscribers cost nothing, latched ones aside."""

    def __init__(self, simulation: Simulation, robot: int, prefix: str, settings: Settings) -> None:
        """`prefix` is put before topics and frames: '' for a single robot, else 'robot_<n>/'."""
        base, queue = simulation.base, settings.queue_size
        self._simulation = simulation
        self._robot = robot
        self._ranges = _range_messages(base, prefix)
        self._sonars = _publisher(prefix, base.sonars, Range, _several(queue, len(self._ranges)))
        self._imu = _publisher(prefix, base.imu, Imu, queue)
        self._imu_message = _imu_message(base, prefix)
        self._battery = _publisher(prefix, base.battery, BatteryState, queue)
        self._battery_message = _battery_message(base)
        self._bumpers = _Switches(prefix, base.bumpers)
        self._cliffs = _Switches(prefix, base.cliffs)

    def publish(self, tick: Tick, stamp: rospy.Time) -> None:
        """Publish the readings that are due."""
        if tick.sonars and self._sonars and has_subscribers(self._sonars):
            for message, value in zip(self._ranges, self._ranges_now(), strict=True):
                message.header.stamp = stamp
                message.range = value
                self._sonars.publish(message)
        if tick.imu and self._imu and has_subscribers(self._imu):
            self._publish_imu(stamp)
        if tick.battery and self._battery and has_subscribers(self._battery):
            self._publish_battery(stamp)
        senses = self._simulation.senses[self._robot]
        self._bumpers.publish(senses.pressed(self._simulation.time))
        self._cliffs.publish(senses.cliffs())

    def _ranges_now(self) -> list[float]:
        return [float(each) for each in self._simulation.senses[self._robot].ranges()]

    def _publish_imu(self, stamp: rospy.Time) -> None:
        reading = self._simulation.senses[self._robot].inertia()
        if reading:
            message = self._imu_message
            message.header.stamp = stamp
            message.orientation = Quaternion(*reading.orientation)
            message.angular_velocity = Vector3(*reading.turning)
            message.linear_acceleration = Vector3(*reading.force)
            self._imu.publish(message)

    def _publish_battery(self, stamp: rospy.Time) -> None:
        battery = self._simulation.senses[self._robot].battery
        if battery:
            message = self._battery_message
            message.header.stamp = stamp
            message.voltage, message.current = battery.voltage, battery.current
            message.charge, message.percentage = battery.charge, battery.fraction
            self._battery.publish(message)


class _Switches:
    """Bumpers or cliff sensors: a latched topic each, on which a state is sent when it changes."""

    def __init__(self, prefix: str, part: Bumpers | Cliffs | None) -> None:
        topics = {each.name: f"{prefix}{part.topic}/{each.name}" for each in part.at} if part else {}
        self._topics = {name: rospy.Publisher(topic, Bool, queue_size=1, latch=True) for name, topic in topics.items()}
        self._sent: dict[str, bool] = {}

    def publish(self, states: dict[str, bool]) -> None:
        """Send the states, by name, that differ from those sent before."""
        if states == self._sent:
            return
        for name, state in states.items():
            if self._sent.get(name) is not state:
                self._sent[name] = state
                self._topics[name].publish(state)


def _several(queue: int | None, count: int) -> int | None:
    """A queue that keeps as many rounds of `count` messages as others keep messages."""
    return queue if queue is None else queue * max(1, count)


def _publisher(prefix: str, part: Any, kind: Any, queue: int | None) -> Any:
    return make_publisher(prefix + part.topic, kind, queue) if part else None


def _range_messages(base: Base, prefix: str) -> list[Range]:
    sonars = base.sonars
    if sonars is None:
        return []
    messages = []
    for sonar in sonars.at:
        message = Range(
            radiation_type=Range.ULTRASOUND,
            field_of_view=sonars.field_of_view,
            min_range=sonars.range_min,
            max_range=sonars.range_max,
        )
        message.header.frame_id = prefix + sonar.frame
        messages.append(message)
    return messages


def _imu_message(base: Base, prefix: str) -> Imu:
    message = Imu()
    if base.imu:
        message.header.frame_id = prefix + base.imu.frame
        message.orientation_covariance = _diagonal(_ORIENTATION_VARIANCE)
        message.angular_velocity_covariance = _diagonal(base.imu.gyro_noise**2)
        message.linear_acceleration_covariance = _diagonal(base.imu.accel_noise**2)
    return message


def _battery_message(base: Base) -> BatteryState:
    message = BatteryState(
        power_supply_status=BatteryState.POWER_SUPPLY_STATUS_DISCHARGING,
        power_supply_health=BatteryState.POWER_SUPPLY_HEALTH_GOOD,
        temperature=float("nan"),
        present=True,
    )
    message.capacity = message.design_capacity = base.battery.design_capacity if base.battery else 0.0
    message.power_supply_technology = _TECHNOLOGIES.get(base.battery.technology if base.battery else "", 0)
    return message


def _diagonal(variance: float) -> list[float]:
    return [variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance]
