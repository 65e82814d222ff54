"""Sonars, fiducials, other robots, frontiers, the spread of the pose, subscribed to while a page shows them; bumpers.

They are found by the types and names of their topics, since each robot has others.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Range
from std_msgs.msg import Bool
from visualization_msgs.msg import Marker, MarkerArray

from ur.source.printable import printable
from ur.web.wire.frames import Kind, Layer, json_frame
from ur_nodes.codecs.genpy.fiducials import message_classes
from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.geometry import pose_of_message
from ur_nodes.web.layers.pacing import Every

_EVERY = 0.2  # s between two frames of a layer
_LOOK_EVERY = 3.0  # s between two looks for topics
_MOST = 64  # topics of a layer
_MOST_MARKS = 500
_MOST_FRONTIERS, _MOST_CELLS = 200, 60  # of a frontier, evenly
_OVERLAYS = frozenset({Layer.SONARS, Layer.COVARIANCE, Layer.FIDUCIALS, Layer.ROBOTS, Layer.FRONTIERS})

Place = Callable[[str], "Pose2 | None"]
Topic = tuple[str, str]


def choose_topics(layer: int, topics: Sequence[Topic]) -> list[Topic]:
    """The topics of a layer among all topics (full name, type), at most 64.

    Bumpers are `.../bumper/NAME`. Another robot has a namespace, and in it `amcl_pose`, or, where it is simulated and
    has no localiser, `base_pose_ground_truth`.
    """
    return [topic for topic in sorted(topics) if _RULES[layer](*topic)][:_MOST]


def _is_robot(name: str, kind: str) -> bool:
    parts = name.split("/")
    ends = (
        ("amcl_pose", "geometry_msgs/PoseWithCovarianceStamped"),
        ("base_pose_ground_truth", "nav_msgs/Odometry"),
    )
    return len(parts) > 2 and (parts[-1], kind) in ends


_RULES: Mapping[int, Callable[[str, str], bool]] = {
    Layer.SONARS: lambda _, kind: kind == "sensor_msgs/Range",
    Layer.COVARIANCE: lambda name, _: name == rospy.resolve_name("amcl_pose"),
    Layer.FIDUCIALS: lambda _, kind: kind == "fiducial_msgs/FiducialMapEntryArray",
    Layer.ROBOTS: _is_robot,
    Layer.FRONTIERS: lambda name, _: name == rospy.resolve_name("explore/frontiers"),
    Layer.NONE: lambda name, kind: kind == "std_msgs/Bool" and name.split("/")[-2:-1] == ["bumper"],
}
_CLASSES: Mapping[str, Callable[[], Any]] = {
    "sensor_msgs/Range": lambda: Range,
    "geometry_msgs/PoseWithCovarianceStamped": lambda: PoseWithCovarianceStamped,
    "nav_msgs/Odometry": lambda: Odometry,
    "fiducial_msgs/FiducialMapEntryArray": lambda: message_classes("FiducialMapEntryArray")[0],
    "std_msgs/Bool": lambda: Bool,
    "visualization_msgs/MarkerArray": lambda: MarkerArray,
}


class Overlays:
    """Sends the layers that are wanted, and notes bumpers. `place` tells the pose of a frame in the map frame.

    `subscribe` makes subscribers as rospy.Subscriber does; `list_topics` lists names and types of topics.
    """

    def __init__(
        self,
        place: Place,
        send: Callable[[bytes], None],
        list_topics: Callable[[], Sequence[Topic]],
        subscribe: Callable[..., Any] = rospy.Subscriber,
    ) -> None:
        self._place, self._send, self._list_topics, self._subscriber = place, send, list_topics, subscribe
        self._lock = threading.Lock()
        self._wanted: frozenset[int] = frozenset()
        self._watched = False
        self._subscribers: dict[tuple[int, str], Any] = {}
        self._newest: dict[tuple[int, str], Any] = {}
        self._sent: dict[int, dict[str, Any]] = {}
        self._send_every, self._look_every = Every(_EVERY), Every(_LOOK_EVERY)

    def want(self, layers: Collection[int], *, watched: bool) -> None:
        """Have these layers sent; `watched`: a page looks, and is to know the bumpers."""
        wanted = frozenset(layers) & _OVERLAYS
        if wanted - self._wanted or (watched and not self._watched):
            self._look_every.hurry()
        self._wanted, self._watched = wanted, watched

    def pressed(self) -> list[str]:
        """Return the names of the bumpers that are pressed."""
        with self._lock:
            newest = dict(self._newest)
        names = {name for (layer, name), value in newest.items() if layer == Layer.NONE and value.data}
        return sorted(printable(name.rpartition("/")[2])[:40] for name in names)

    def step(self, now: float) -> None:
        """Subscribe to what is wanted, and send what has changed; to be called often, from one thread.

        `now` is time.monotonic().
        """
        if self._look_every.due(now):
            self._look()
        if not self._send_every.due(now):
            return
        with self._lock:
            newest = dict(self._newest)
        for layer in self._wanted:
            found = {name: value for (each, name), value in newest.items() if each == layer}
            self._show(Layer(layer), _DESCRIBE[layer](found, self._place))

    def _look(self) -> None:
        layers = {*self._wanted, *((Layer.NONE,) if self._watched else ())}
        topics = self._list_topics() if layers else []
        wanted = {(layer, *topic) for layer in layers for topic in choose_topics(layer, topics)}
        for key in self._subscribers.keys() - {(layer, name) for layer, name, _ in wanted}:
            self._subscribers.pop(key).unregister()
            with self._lock:
                self._newest.pop(key, None)
        for layer, name, kind in wanted:
            if (layer, name) not in self._subscribers and kind in _CLASSES:
                self._subscribers[layer, name] = self._subscriber(
                    name, _CLASSES[kind](), self._take, callback_args=(layer, name), queue_size=1
                )
        for layer in self._sent.keys() - self._wanted:  # what a page gets that wants the layer again is old
            self._show(Layer(layer), {})
            del self._sent[layer]

    def _show(self, layer: Layer, value: dict[str, Any]) -> None:
        if value != self._sent.get(layer, {}):
            self._sent[layer] = value
            self._send(json_frame(Kind.OVERLAY, value, layer))

    @quiet_at_end
    def _take(self, message: Any, key: tuple[int, str]) -> None:
        with self._lock:
            self._newest[key] = message


def _describe_sonars(found: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """Cones in the map frame: x, y (m), yaw, range (m), field of view (rad), 1 for an echo."""
    cones = []
    for message in found.values():
        mount = place(message.header.frame_id)
        if mount is None or not math.isfinite(message.max_range):
            continue
        echo = message.min_range <= message.range < message.max_range
        reach = message.range if echo else message.max_range
        cones.append([*_round(mount.x, mount.y, mount.yaw, reach, message.field_of_view), int(echo)])
    return {"cones": cones}


def _describe_covariance(found: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """The newest pose of the localiser with its spread: x, y (m), xx, xy, yy (m^2)."""
    for message in found.values():
        frame, pose = place(message.header.frame_id), message.pose
        if frame is not None:
            x, y = pose.pose.position.x, pose.pose.position.y
            own = frame.compose(Pose2(x, y, 0.0))
            xx, xy, yy = pose.covariance[0], pose.covariance[1], pose.covariance[7]
            cos, sin = math.cos(frame.yaw), math.sin(frame.yaw)
            turned = (
                cos * cos * xx - 2 * cos * sin * xy + sin * sin * yy,
                cos * sin * (xx - yy) + (cos * cos - sin * sin) * xy,
                sin * sin * xx + 2 * cos * sin * xy + cos * cos * yy,
            )
            if all(map(math.isfinite, (*own, *turned))):
                return {"at": _round(own.x, own.y), "spread": [round(each, 6) for each in turned]}
    return {}


def _describe_fiducials(found: Mapping[str, Any], _place: Place) -> dict[str, Any]:
    """Fiducials of the map: id, x, y (m)."""
    marks = [
        [int(each.fiducial_id), *_round(each.x, each.y)]
        for message in found.values()
        for each in message.fiducials[:_MOST_MARKS]
        if math.isfinite(each.x) and math.isfinite(each.y)
    ]
    return {"marks": marks}


def _describe_robots(found: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """Other robots by name: x, y (m), yaw. What a localiser says counts before what a simulator knows."""
    robots: dict[str, list[float]] = {}
    for name, message in sorted(found.items(), reverse=True):  # amcl_pose comes last
        frame = place(message.header.frame_id)
        if frame is None:
            continue
        here = frame.compose(pose_of_message(message.pose.pose))
        if all(map(math.isfinite, here)):
            robots[printable(name.rpartition("/")[0].strip("/"))[:40]] = _round(*here)
    return {"robots": robots}


def _describe_frontiers(found: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """Frontiers of an exploration: 1 for one that was given up, then x, y, x, y, ... (m)."""
    frontiers = []
    for message in found.values():
        shown = [each for each in message.markers if each.action == Marker.ADD and each.points]
        for marker in shown[:_MOST_FRONTIERS]:
            frame = place(marker.header.frame_id)
            if frame is None:
                continue
            some = marker.points[:: 1 + len(marker.points) // _MOST_CELLS]
            points = frame.transform_points(np.array([(point.x, point.y) for point in some]))
            if np.isfinite(points).all():
                blocked = marker.color.r > marker.color.b
                frontiers.append([int(blocked), *(round(each, 2) for each in points.ravel().tolist())])
    return {"frontiers": frontiers}


def _round(*numbers: float) -> list[float]:
    return [round(each, 3) if math.isfinite(each) else 0.0 for each in numbers]


_DESCRIBE: Mapping[int, Callable[[Mapping[str, Any], Place], dict[str, Any]]] = {
    Layer.SONARS: _describe_sonars,
    Layer.COVARIANCE: _describe_covariance,
    Layer.FIDUCIALS: _describe_fiducials,
    Layer.ROBOTS: _describe_robots,
    Layer.FRONTIERS: _describe_frontiers,
}
