from __future__ import annotations

import json
import math
from typing import Any

import pytest
from tests.ur_nodes.web.layers.test_layers_node import Topics

from ur.web.wire.frames import Kind, Layer, key_of

pytest.importorskip("rospy", reason="ROS is not installed")

from geometry_msgs.msg import Point, PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Range
from std_msgs.msg import Bool, ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from ur_nodes.codecs.genpy.fiducials import message_classes
from ur_nodes.geometry.pose import Pose2
from ur_nodes.web.layers.overlays_node import Overlays, choose_topics

PLACES = {"map": Pose2(0.0, 0.0, 0.0), "sonar": Pose2(1.0, 2.0, math.pi / 2), "odom": Pose2(1.0, 0.0, math.pi / 2)}
POSE = "geometry_msgs/PoseWithCovarianceStamped"
TOPICS = [
    ("/sonars", "sensor_msgs/Range"),
    ("/scan", "sensor_msgs/LaserScan"),
    ("/bumper/left", "std_msgs/Bool"),
    ("/ns/bumper/right", "std_msgs/Bool"),
    ("/left", "std_msgs/Bool"),
    ("/amcl_pose", POSE),
    ("/eve/amcl_pose", POSE),
    ("/eve/base_pose_ground_truth", "nav_msgs/Odometry"),
    ("/base_pose_ground_truth", "nav_msgs/Odometry"),
    ("/fiducial_map", "fiducial_msgs/FiducialMapEntryArray"),
    ("/explore/frontiers", "visualization_msgs/MarkerArray"),
]


class Scene:
    """Overlays without ROS, and what they have sent."""

    def __init__(self) -> None:
        self.topics, self.frames, self.now = Topics(), list[bytes](), 10.0
        self.overlays = Overlays(PLACES.get, self.frames.append, lambda: TOPICS, self.topics.subscribe)

    def step(self) -> None:
        self.now += 5.0
        self.overlays.step(self.now)

    def show(self, layer: Layer, *messages: tuple[str, Any]) -> Any:
        """Want a layer, publish messages, and return what is sent."""
        self.overlays.want([layer], watched=False)
        self.step()
        for topic, message in messages:
            self.topics.publish(topic, message)
        self.step()
        assert key_of(self.frames[-1])[:2] == (Kind.OVERLAY, layer)
        return json.loads(self.frames[-1][6:])


@pytest.mark.parametrize(
    ("layer", "names"),
    [
        (Layer.SONARS, ["/sonars"]),
        (Layer.COVARIANCE, ["/amcl_pose"]),
        (Layer.FIDUCIALS, ["/fiducial_map"]),
        (Layer.ROBOTS, ["/eve/amcl_pose", "/eve/base_pose_ground_truth"]),
        (Layer.NONE, ["/bumper/left", "/ns/bumper/right"]),
    ],
)
def test_topics_are_chosen_by_name_and_type(layer: Layer, names: list[str]) -> None:
    assert [name for name, _ in choose_topics(layer, TOPICS)] == names


def test_sonars_are_cones_in_the_map_as_long_as_their_echo() -> None:
    near = Range(range=0.5, min_range=0.1, max_range=3.0, field_of_view=0.4)
    near.header.frame_id = "sonar"
    assert Scene().show(Layer.SONARS, ("/sonars", near)) == {"cones": [[1.0, 2.0, 1.571, 0.5, 0.4, 1]]}
    near.range = math.inf
    assert Scene().show(Layer.SONARS, ("/sonars", near))["cones"][0][3:] == [3.0, 0.4, 0]
    near.max_range = math.nan
    scene = Scene()
    assert scene.show(Layer.SONARS, ("/sonars", near))["cones"] == []


def test_spread_of_the_pose_turns_with_its_frame() -> None:
    message = PoseWithCovarianceStamped()
    message.header.frame_id = "odom"
    message.pose.pose.position.x = 1.0
    message.pose.pose.orientation.w = 1.0
    message.pose.covariance[0], message.pose.covariance[7] = 0.04, 0.01
    assert Scene().show(Layer.COVARIANCE, ("/amcl_pose", message)) == {"at": [1.0, 1.0], "spread": [0.01, 0.0, 0.04]}


def test_fiducials_have_numbers_and_places() -> None:
    array, entry = message_classes("FiducialMapEntryArray")
    marks = [entry(fiducial_id=7, x=1.0, y=-2.0), entry(fiducial_id=8, x=math.nan)]
    assert Scene().show(Layer.FIDUCIALS, ("/fiducial_map", array(marks))) == {"marks": [[7, 1.0, -2.0]]}


def test_frontiers_are_points_of_which_some_are_given_up() -> None:
    deleted, left, blocked = Marker(action=Marker.DELETEALL), Marker(), Marker(color=ColorRGBA(1.0, 0.0, 0.0, 1.0))
    left.header.frame_id, left.points = "map", [Point(1.0, 2.0, 0.0), Point(1.05, 2.0, 0.0)]
    blocked.header.frame_id, blocked.points = "odom", [Point(1.0, 0.0, 0.0)] * 500
    shown = Scene().show(Layer.FRONTIERS, ("/explore/frontiers", MarkerArray([deleted, left, blocked])))["frontiers"]
    assert shown[0] == [0, 1.0, 2.0, 1.05, 2.0]
    assert shown[1][:3] == [1, 1.0, 1.0]
    assert len(shown[1]) < 125


def test_other_robot_is_where_its_localiser_says_before_where_a_simulator_knows_it() -> None:
    truth, pose = Odometry(), PoseWithCovarianceStamped()
    for message, x in ((truth, 1.0), (pose, 2.0)):
        message.header.frame_id = "map"
        message.pose.pose.position.x, message.pose.pose.orientation.w = x, 1.0
    scene = Scene()
    assert scene.show(Layer.ROBOTS, ("/eve/base_pose_ground_truth", truth)) == {"robots": {"eve": [1.0, 0.0, 0.0]}}
    assert scene.show(Layer.ROBOTS, ("/eve/amcl_pose", pose)) == {"robots": {"eve": [2.0, 0.0, 0.0]}}


def test_bumpers_are_known_while_a_page_looks() -> None:
    scene = Scene()
    scene.overlays.want([], watched=True)
    scene.step()
    scene.topics.publish("/bumper/left", Bool(data=True))
    scene.topics.publish("/ns/bumper/right", Bool(data=True))
    assert scene.overlays.pressed() == ["left", "right"]
    scene.topics.publish("/bumper/left", Bool(data=False))
    assert scene.overlays.pressed() == ["right"]
    scene.overlays.want([], watched=False)
    scene.step()
    assert (scene.topics.callbacks, scene.overlays.pressed()) == ({}, [])


def test_layer_that_nobody_wants_any_more_is_forgotten() -> None:
    scene = Scene()
    message = Range(range=0.5, min_range=0.1, max_range=3.0, field_of_view=0.4)
    message.header.frame_id = "sonar"
    scene.show(Layer.SONARS, ("/sonars", message))
    scene.overlays.want([], watched=False)
    scene.step()
    assert scene.topics.callbacks == {}
    assert (key_of(scene.frames[-1])[:2], scene.frames[-1][6:]) == ((Kind.OVERLAY, Layer.SONARS), b"{}")
