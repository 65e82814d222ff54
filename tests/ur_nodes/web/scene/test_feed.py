"""What pages show of frames, markers and clouds, on a bus."""

import json
from typing import Any

import numpy as np

from ur.web.wire.data_requests import Show, unpack_frame
from ur_nodes.geometry.pose import Pose3
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Marker, MarkerChange, MarkerChanges, PointCloud, Transform
from ur_nodes.web.scene.feed import SceneFeed

HERE = Pose3(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
KINDS = {
    "/cloud": "sensor_msgs/PointCloud2",
    "/one": "visualization_msgs/Marker",
    "/many": "visualization_msgs/MarkerArray",
    "/scan": "sensor_msgs/LaserScan",
}
CUBE = Marker("a", 1, "cube", HERE, (1.0, 1.0, 1.0), (1.0, 0.0, 0.0, 1.0))
CLOUD = PointCloud(0, "lidar", np.array([(1.0, 2.0, 3.0)], [("x", "<f4"), ("y", "<f4"), ("z", "<f4")]))


class SceneWorld:
    """A feed, a robot that publishes, and what was sent to each page, by key."""

    def __init__(self) -> None:
        self.bus = Bus()
        self.sent: list[tuple[int, str, bytes]] = []
        self.feed = SceneFeed(self.bus.node("data"), self._take)
        self.robot = self.bus.node("robot")
        self.clouds = self.robot.publish("cloud", PointCloud)
        self.one = self.robot.publish("one", MarkerChange)
        self.many = self.robot.publish("many", MarkerChanges)
        self.shows: dict[int, Show] = {}

    def _take(self, data: bytes) -> None:
        frame = unpack_frame(data)
        self.sent.append((frame.page, frame.key, frame.body))

    def show(self, page: int, *topics: str) -> None:
        self.shows[page] = Show(scene=topics)

    def run(self, seconds: float = 1.0) -> None:
        for _ in range(round(seconds / 0.05)):
            self.feed.step(self.shows, KINDS)
            self.bus.run(0.05)

    def last(self, page: int, key: str) -> Any:
        return next(json.loads(body) for to, name, body in reversed(self.sent) if (to, name) == (page, key))


def test_topics_that_can_be_shown_are_offered_and_only_those_that_are_shown_are_subscribed_to() -> None:
    world = SceneWorld()
    world.run()
    assert world.sent == []
    world.show(7, "/one", "/scan", "/unknown")
    world.run()
    offered = [["/cloud", KINDS["/cloud"]], ["/many", KINDS["/many"]], ["/one", KINDS["/one"]]]
    assert world.last(7, "scene")["topics"] == offered
    assert (world.one.subscribers(), world.many.subscribers(), world.clouds.subscribers()) == (1, 0, 0)
    world.shows.clear()
    world.run()
    assert world.one.subscribers() == 0


def test_frames_are_sent_when_they_change_and_to_each_new_page() -> None:
    world = SceneWorld()
    world.robot.transforms.send(Transform(0, "map", "world", HERE, fixed=True))
    world.show(1)
    world.run()
    world.robot.transforms.send(Transform(0, "odom", "base", HERE))
    world.run()
    assert [row[:2] for row in world.last(1, "tf")["frames"]] == [["base", "odom"], ["world", "map"]]
    count = len([each for each in world.sent if each[:2] == (1, "tf")])
    world.show(2)
    world.run()
    assert world.last(2, "tf") == world.last(1, "tf")
    assert len([each for each in world.sent if each[:2] == (1, "tf")]) == count


def test_markers_of_both_types_are_sent_and_outlive_themselves() -> None:
    world = SceneWorld()
    world.show(1, "/one", "/many")
    world.run()
    world.one.send(MarkerChange(0, "map", "put", CUBE, lifetime=2.0))
    world.many.send(MarkerChanges((MarkerChange(0, "map", "put", CUBE), MarkerChange(0, "map", "delete", CUBE))))
    world.run()
    assert [each["kind"] for each in world.last(1, "markers:/one")["markers"]] == ["cube"]
    assert world.last(1, "markers:/many")["markers"] == []
    world.run(2.0)
    assert world.last(1, "markers:/one")["markers"] == []


def test_clouds_are_sent_a_few_times_a_second_to_the_pages_that_show_them() -> None:
    world = SceneWorld()
    world.show(1, "/cloud")
    world.show(2, "/one")
    world.run()
    world.robot.every(0.05, lambda: world.clouds.send(CLOUD))
    world.run(2.0)
    clouds = [to for to, key, _ in world.sent if key == "cloud:/cloud"]
    assert set(clouds) == {1}
    assert 8 <= len(clouds) <= 11


def test_latched_frames_are_known_to_a_page_that_comes_later() -> None:
    world = SceneWorld()
    world.robot.publish("/tf_static", tuple, Quality.LATCHED).send((Transform(0, "a", "b", HERE, fixed=True),))
    world.bus.run(60.0)
    world.show(1)
    world.run()
    assert [row[:2] for row in world.last(1, "tf")["frames"]] == [["b", "a"]]
