import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from ur.web.wire.frames import Kind, Layer, key_of
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.fiducials import MappedFiducial, MappedFiducials
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Marker, Markers, Odometry, PoseEstimate, Range, Twist
from ur_nodes.web.layers.overlays import Overlays, choose_topics

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


NEAR = Range(0, "sonar", 0.5, 0.4, 0.1, 3.0)


class Scene:
    """Overlays on a bus, and what they have sent."""

    def __init__(self) -> None:
        self.bus, self.frames = Bus(), list[bytes]()
        self.node, self.robot = self.bus.node("web"), self.bus.node("robot")
        self.overlays = Overlays(self.node, PLACES.get, self.frames.append)
        self.overlays.update_topics(TOPICS)
        self.publishers: dict[str, Any] = {}

    def step(self) -> None:
        self.bus.run(1.0)
        self.overlays.step(self.node.steady())

    def publish(self, topic: str, value: Any) -> None:
        if topic not in self.publishers:
            quality = Quality.NEWEST if isinstance(value, (Range, Odometry)) else Quality.LATCHED
            self.publishers[topic] = self.robot.publish(topic, type(value), quality)
        self.publishers[topic].send(value)

    def subscribed(self) -> list[str]:
        return [name for name, topic in self.bus.topics.items() if topic.subscribers]

    def show(self, layer: Layer, *values: tuple[str, Any]) -> Any:
        """Want a layer, publish values, and return what is sent."""
        self.overlays.want([layer], watched=False)
        self.step()
        for topic, value in values:
            self.publish(topic, value)
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
    assert [name for name, _ in choose_topics(layer, TOPICS, lambda name: f"/{name}")] == names


def test_sonars_are_cones_in_the_map_as_long_as_their_echo() -> None:
    assert Scene().show(Layer.SONARS, ("/sonars", NEAR)) == {"cones": [[1.0, 2.0, 1.571, 0.5, 0.4, 1]]}
    clear = replace(NEAR, range=math.inf)
    assert Scene().show(Layer.SONARS, ("/sonars", clear))["cones"][0][3:] == [3.0, 0.4, 0]
    assert Scene().show(Layer.SONARS, ("/sonars", replace(clear, range_max=math.nan)))["cones"] == []


def test_spread_of_the_pose_turns_with_its_frame() -> None:
    pose = PoseEstimate(0, "odom", Pose2(1.0, 0.0, 0.0), np.diag((0.04, 0.01, 0.0)))
    assert Scene().show(Layer.COVARIANCE, ("/amcl_pose", pose)) == {"at": [1.0, 1.0], "spread": [0.01, 0.0, 0.04]}


def test_fiducials_have_numbers_and_places() -> None:
    marks = (
        MappedFiducial(7, (1.0, -2.0, 0.0), (0.0, 0.0, 0.0)),
        MappedFiducial(8, (math.nan, 0.0, 0.0), (0.0, 0.0, 0.0)),
    )
    assert Scene().show(Layer.FIDUCIALS, ("/fiducial_map", MappedFiducials(marks))) == {"marks": [[7, 1.0, -2.0]]}


def test_frontiers_are_points_of_which_some_are_given_up() -> None:
    def frontier(points: Any, red: float) -> Marker:
        colour = (red, 0.0, 1.0 - red, 1.0)
        here = Pose2(0.0, 0.0, 0.0).in_space()
        return Marker("a", 1, "points", here, (0.1, 0.1, 0.1), colour, points=np.array(points))

    left, blocked = frontier([(0.0, -1.0, 0.0), (0.0, -1.05, 0.0)], 0.0), frontier([(1.0, 0.0, 0.0)] * 500, 1.0)
    empty = frontier(np.zeros((0, 3)), 0.0)
    shown = Scene().show(Layer.FRONTIERS, ("/explore/frontiers", Markers(0, "odom", (left, empty, blocked))))
    assert shown["frontiers"][0] == [0, 2.0, 0.0, 2.05, 0.0]
    assert shown["frontiers"][1][:3] == [1, 1.0, 1.0]
    assert len(shown["frontiers"][1]) < 125
    assert len(shown["frontiers"]) == 2


def test_other_robot_is_where_its_localiser_says_before_where_a_simulator_knows_it() -> None:
    truth = Odometry(0, "map", "base", Pose2(1.0, 0.0, 0.0), Twist(0.0, 0.0))
    pose = PoseEstimate(0, "map", Pose2(2.0, 0.0, 0.0), np.zeros((3, 3)))
    scene = Scene()
    assert scene.show(Layer.ROBOTS, ("/eve/base_pose_ground_truth", truth)) == {"robots": {"eve": [1.0, 0.0, 0.0]}}
    assert scene.show(Layer.ROBOTS, ("/eve/amcl_pose", pose)) == {"robots": {"eve": [2.0, 0.0, 0.0]}}


def test_bumpers_are_known_while_a_page_is_open() -> None:
    scene = Scene()
    scene.overlays.want([], watched=True)
    scene.step()
    scene.publish("/bumper/left", True)
    scene.publish("/ns/bumper/right", True)
    scene.step()
    assert scene.overlays.pressed() == ["left", "right"]
    scene.publish("/bumper/left", False)
    scene.step()
    assert scene.overlays.pressed() == ["right"]
    scene.overlays.want([], watched=False)
    scene.step()
    assert (scene.subscribed(), scene.overlays.pressed()) == ([], [])


def test_layer_that_no_page_wants_any_more_is_forgotten() -> None:
    scene = Scene()
    scene.show(Layer.SONARS, ("/sonars", NEAR))
    scene.overlays.want([], watched=False)
    scene.step()
    assert scene.subscribed() == []
    assert (key_of(scene.frames[-1])[:2], scene.frames[-1][6:]) == ((Kind.OVERLAY, Layer.SONARS), b"{}")


def test_topic_that_is_published_later_is_shown_with_the_next_list() -> None:
    scene = Scene()
    scene.overlays.update_topics([])
    scene.overlays.want([Layer.SONARS], watched=False)
    scene.step()
    assert scene.subscribed() == []
    scene.overlays.update_topics(TOPICS)
    scene.step()
    assert scene.subscribed() == ["/sonars"]
