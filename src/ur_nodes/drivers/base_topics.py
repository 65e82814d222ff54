"""The topics of a real base, under the names that its file gives: what the simulated one publishes."""

import math

from ur.robot.base import Base, Bumpers, Cliffs
from ur_nodes.drivers.base_states import WHEEL_JOINTS
from ur_nodes.drivers.lidars.turns import TurnCollector
from ur_nodes.drivers.odometer import CounterOdometry, Motion
from ur_nodes.drivers.readings import Contacts, MeasuredBeams, Power, SonarEcho
from ur_nodes.drivers.sonars.ranges import make_range
from ur_nodes.geometry.dead_reckoning import SPEED_COVARIANCE, covariance_matrix
from ur_nodes.geometry.pose import Pose3, quaternion_of_yaw
from ur_nodes.ports.node import SECOND, Node, Publisher
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Joints, Odometry, Range, Scan, Transform, Twist

_BATTERY_PERIOD = 1.0  # s
_WARN_EVERY = 60.0  # s


class BaseTopics:
    """Publishers of a base. Set `battery` to what was measured last; it is sent once a second."""

    def __init__(self, node: Node, base: Base, odometer: CounterOdometry) -> None:
        self._node, self._odometer = node, odometer
        self._period = SECOND / base.odometry.rate
        self._next = 0
        self._odom = node.publish("odom", Odometry)
        self._joints = node.publish("joint_states", Joints)
        self._frames = node.publish("/tf", tuple, Quality.EVERY)
        self.battery: Power | None = None
        self._properties = base.battery
        self._battery = node.publish(base.battery.topic, Battery) if base.battery else None
        self._contacts: dict[tuple[str, str], Publisher[bool]] = {}
        parts: list[tuple[str, Bumpers | Cliffs | None]] = [("bumper", base.bumpers), ("cliff", base.cliffs)]
        for kind, part in parts:
            for name, topic in zip((each.name for each in part.at), part.topics(), strict=True) if part else ():
                self._contacts[kind, name] = node.publish(topic, bool, Quality.LATCHED)
        own_lidar = base.lidar if not any(each.part == "lidar" for each in base.drivers) else None
        self._turns = TurnCollector(own_lidar) if own_lidar else None
        self._scans = node.publish(own_lidar.topic, Scan) if own_lidar else None
        self._sonars = base.sonars if not any(each.part == "sonars" for each in base.drivers) else None
        self._echoes = node.publish(self._sonars.topic, Range, Quality.EVERY) if self._sonars else None
        self._reported: dict[tuple[str, str], bool] = {}
        node.every(_BATTERY_PERIOD, self._beat)

    def forget(self) -> None:
        """The device is away: what it measured is no longer known."""
        self.battery = None
        self._reported.clear()

    def send_motion(self, motion: Motion, stamp: int) -> None:
        """Send odometry, joints and the transform, at most as often as the base file says."""
        if stamp < self._next and stamp > self._next - 10 * self._period:
            return
        self._next = max(self._next + round(self._period), stamp - round(self._period / 2.0))
        reckoning = self._odometer.reckoning
        covariance = covariance_matrix(reckoning.covariance)
        x, y, yaw = reckoning.pose
        self._frames.send((Transform(stamp, "odom", "base_footprint", Pose3(x, y, 0.0, *quaternion_of_yaw(yaw))),))
        twist = Twist(motion.forward, motion.turn)
        self._odom.send(Odometry(stamp, "odom", "base_footprint", reckoning.pose, twist, covariance, SPEED_COVARIANCE))
        self._joints.send(Joints(stamp, WHEEL_JOINTS, self._odometer.angles, motion.wheel_speeds))

    def send_contacts(self, contacts: Contacts) -> None:
        """Send the bumpers or cliff sensors that have changed, of those that the base file names."""
        for name, state in contacts.states:
            key = (contacts.kind, name)
            if key in self._contacts and self._reported.get(key) is not state:
                self._reported[key] = state
                self._contacts[key].send(state)

    def send_beams(self, beams: MeasuredBeams, stamp: int) -> None:
        """Send the scans that beams complete, where the base has a lidar without a driver of its own."""
        if self._scans and self._turns:
            for scan in self._turns.add(beams, stamp):
                self._scans.send(scan)

    def send_echo(self, echo: SonarEcho, stamp: int) -> None:
        """Send a range, where the base has sonars without a driver of their own."""
        if self._echoes and self._sonars and echo.number < len(self._sonars.at):
            measured = stamp - round(echo.age * SECOND)
            self._echoes.send(make_range(self._sonars, self._sonars.at[echo.number].frame, echo.distance, measured))

    def _beat(self) -> None:
        battery, now = self._properties, self.battery
        if self._battery is None or battery is None or now is None:
            return
        capacity = battery.design_capacity if math.isnan(now.capacity) or now.capacity <= 0.0 else now.capacity
        if math.isnan(now.charge):
            span = battery.voltage_full - battery.voltage_empty
            fraction = min(1.0, max(0.0, (now.voltage - battery.voltage_empty) / span))
        else:
            fraction = min(1.0, max(0.0, now.charge / capacity))
        stamp, amounts = self._node.now(), (now.voltage, now.current, now.charge, capacity)
        self._battery.send(Battery(stamp, *amounts, fraction, now.charging, battery.technology))
        if now.voltage < battery.voltage_empty:
            self._node.log.warn(f"the battery is empty ({now.voltage:.1f} V); charge it", every=_WARN_EVERY)
