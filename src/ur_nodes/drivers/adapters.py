"""Additions to a driver's topics: joints and transform from odometry, a renamed scan, a topic for each bumper."""

from __future__ import annotations

from dataclasses import replace

from ur.robot.base import Base, Lidar
from ur_nodes.drivers.base_states import WHEEL_JOINTS, BumperStates, WheelStates
from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import DriverOdometry, Joints, Scan, Transform

_LOOK_RATE = 10.0  # Hz
_WARN_EVERY = 10.0  # s
_BAD_ODOMETRY = (
    "odometry is left out, expected speeds that a robot can have:"
    " does the driver read its serial line at the right baud rate, without noise?"
)


def adapt_odometry(node: Node, base: Base, *, publish_tf: bool) -> None:
    """From `odom`: `joint_states`, and tf odom -> base_footprint when asked."""
    wheels = WheelStates(base.wheels)
    joints = node.publish("joint_states", Joints)
    frames = node.publish("/tf", tuple, Quality.EVERY) if publish_tf else None

    def on_odometry(odometry: DriverOdometry) -> None:
        time = seconds_of(odometry.stamp)
        if not wheels.update(odometry.forward, odometry.turn, time):
            node.log.warn(f"{node.resolve('odom')}: {_BAD_ODOMETRY}", every=_WARN_EVERY)
            return
        if frames:
            pose = Pose3(odometry.x, odometry.y, 0.0, *odometry.rotation)
            frames.send((Transform(odometry.stamp, "odom", "base_footprint", pose),))
        joints.send(Joints(odometry.stamp, WHEEL_JOINTS, wheels.angles, wheels.speeds))

    node.subscribe("odom", DriverOdometry, on_odometry, Quality.EVERY)


def adapt_scan(node: Node, lidar: Lidar) -> None:
    """From `driver/scan`: the scan of the base's lidar, in its frame."""
    scans = node.publish(lidar.topic, Scan)
    node.subscribe("driver/scan", Scan, lambda scan: scans.send(replace(scan, frame=lidar.frame)))


def adapt_bumpers(node: Node, topic: str, names: dict[str, str], known: list[str], type_name: str) -> None:
    """From `driver/bumpers`, messages with `name` and `value`: a latched topic for each bumper of the base.

    Raises LookupError and ValueError for the type, as `Node.subscribe_fields`.
    """
    states = BumperStates(known)
    topics = {name: node.publish(f"{topic}/{name}", bool, Quality.LATCHED) for name in known}

    def publish() -> None:
        for name, pressed in states.changes(seconds_of(node.now())).items():
            topics[name].send(pressed)

    def on_bumper(fields: tuple[object, ...]) -> None:
        name, value = fields
        if value and name in names:
            states.press(names[name], seconds_of(node.now()))
            publish()

    node.subscribe_fields("driver/bumpers", type_name, ("name", "value"), on_bumper)
    node.every(1.0 / _LOOK_RATE, publish)
