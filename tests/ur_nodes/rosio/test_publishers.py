from __future__ import annotations

import io
import math
from typing import Any

import pytest
import rospy
from tf2_msgs.msg import TFMessage

from ur_nodes.codecs.geometry import pose3_of_transform
from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.rosio.publishers import TransformSender

QUARTER = math.sqrt(0.5)


class _Wire:
    """Stands for a publisher, and keeps the bytes that it sends."""

    def __init__(self, topic: str, kind: Any, queue_size: int | None, tcp_nodelay: bool) -> None:
        self.made = topic, kind, queue_size, tcp_nodelay
        self.sent: list[TFMessage] = []

    def publish(self, message: TFMessage) -> None:
        buffer = io.BytesIO()
        message.serialize(buffer)
        self.sent.append(TFMessage().deserialize(buffer.getvalue()))


@pytest.fixture
def wires(monkeypatch: pytest.MonkeyPatch) -> list[_Wire]:
    made: list[_Wire] = []

    def make(*args: Any, **options: Any) -> _Wire:
        made.append(_Wire(*args, **options))
        return made[-1]

    monkeypatch.setattr(rospy, "Publisher", make)
    return made


@pytest.mark.parametrize("queue", [100, 10, None])
def test_transforms_are_published_on_tf_without_delay(wires: list[_Wire], queue: int | None) -> None:
    TransformSender(queue)
    assert [wire.made for wire in wires] == [("/tf", TFMessage, queue, True)]


def test_edges_of_one_moment_are_one_message(wires: list[_Wire]) -> None:
    space = Pose3(1.0, 2.0, 3.0, QUARTER, 0.0, 0.0, -QUARTER)
    TransformSender().send(
        rospy.Time(7, 5), ("map", "odom", Pose2(1.0, -2.0, math.pi / 2.0)), ("camera", "fiducial_3", space)
    )
    (message,) = wires[0].sent
    planar, spatial = message.transforms
    assert [each.header.stamp for each in message.transforms] == [rospy.Time(7, 5)] * 2
    assert (planar.header.frame_id, planar.child_frame_id) == ("map", "odom")
    assert pose3_of_transform(planar.transform) == pytest.approx((1.0, -2.0, 0.0, 0.0, 0.0, QUARTER, QUARTER))
    assert (spatial.header.frame_id, spatial.child_frame_id) == ("camera", "fiducial_3")
    assert pose3_of_transform(spatial.transform) == pytest.approx(space)


def test_edge_has_the_stamp_and_pose_of_each_time_it_is_sent(wires: list[_Wire]) -> None:
    sender = TransformSender()
    for second in (1, 2):
        sender.send(rospy.Time(second), ("odom", "base_footprint", Pose2(float(second), 0.0, 0.0)))
        sender.send(rospy.Time(second), ("map", "odom", Pose2(-1.0, 0.0, 0.0)))
    sent = [message.transforms[0] for message in wires[0].sent]
    assert [(each.header.stamp.to_sec(), each.transform.translation.x) for each in sent] == [
        (1.0, 1.0),
        (1.0, -1.0),
        (2.0, 2.0),
        (2.0, -1.0),
    ]
