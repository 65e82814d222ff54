"""The node on a bus."""

from tests.ur_nodes.frames.test_links import URDF

from ur_nodes.frames.robot_state_publisher_node import RobotStatePublisher
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Joints

_MS = 1_000_000


def test_frames_follow_the_joints_no_more_often_than_asked() -> None:
    bus = Bus()
    node = bus.node("robot_state_publisher")
    node.parameters.keep("robot_description", URDF)
    node.parameters.keep("publish_frequency", 10.0)
    started = RobotStatePublisher(node)
    other = bus.node("other")
    described: list[str] = []
    other.subscribe("robot_description", str, described.append, Quality.LATCHED)
    tree, joints = other.transforms, other.publish("joint_states", Joints)
    changes: list[None] = []
    bus.run(0.1)
    tree.watch(lambda: changes.append(None))
    for number in range(1, 21):
        joints.send(Joints(number * 20 * _MS, ("axle",), (0.1,)))
        bus.run(0.02)
    assert described == [URDF]
    assert tree.find("base", "laser") is not None
    assert tree.find("base", "wheel") is not None
    assert len(changes) == 4
    assert started is not None
