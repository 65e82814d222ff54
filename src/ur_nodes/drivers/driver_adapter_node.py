"""The node between a driver and the rest: what the driver leaves out, under the names that the base file gives."""

import sys
from dataclasses import replace

from ur.robot.base import Base, Lidar
from ur.source.diagnostic import user_error
from ur_nodes.drivers.base_states import WHEEL_JOINTS, BumperStates, WheelStates
from ur_nodes.drivers.registry import read_base
from ur_nodes.geometry.pose import Pose3
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import DriverOdometry, Joints, Scan, Transform
from ur_nodes.run import run

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

    def on_scan(scan: Scan) -> None:
        last = None if scan.angle_max is None else scan.angle_max + lidar.askew
        scans.send(replace(scan, frame=lidar.frame, angle_min=scan.angle_min + lidar.askew, angle_max=last))

    node.subscribe("driver/scan", Scan, on_scan)


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


def start(node: Node) -> None:
    """Read the parameters and connect. Raises UserError."""
    own = node.parameters
    base = read_base(own)
    adapt_odometry(node, base, publish_tf=own.boolean("publish_tf", False))
    if own.boolean("rename_scan", False) and base.lidar:
        adapt_scan(node, base.lidar)
    kind = own.text("bumper_messages", "")
    if kind and base.bumpers:
        known = [bumper.name for bumper in base.bumpers.at]
        names = read_names(node.parameters, known)
        try:
            adapt_bumpers(node, base.bumpers.topic, names, known, kind)
        except LookupError:
            expected = "a type of message as package/Name of an installed package"
            node.parameters.fail("bumper_messages", kind, expected)
        except ValueError:
            text = f"messages {kind} have no name and value, expected those of bumpers"
            raise user_error(text, rule="bad-parameter") from None


def read_names(own: Parameters, known: list[str]) -> dict[str, str]:
    """The parameter `bumper_names`: upstream's names and those of the base. Raises UserError."""
    names = own.any("bumper_names", {})
    if not isinstance(names, dict) or not all(isinstance(name, str) and name in known for name in names.values()):
        own.fail("bumper_names", names, f"a map from upstream's names to some of {', '.join(known)}")
    return dict(names)


if __name__ == "__main__":
    sys.exit(run("driver_adapter", start))
