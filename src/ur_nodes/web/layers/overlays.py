"""Overlays of the map, subscribed to while a page shows them: values of topics as JSON, in the map frame; bumpers."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np

from ur.source.printable import printable
from ur.web.wire.frames import Kind, Layer, json_frame
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.fiducials import MappedFiducials
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Markers, Odometry, PoseEstimate, Range
from ur_nodes.web.layers.pacing import Every

_MOST_MARKS = 500
_MOST_FRONTIERS, _MOST_CELLS = 200, 60  # of a frontier, evenly

Value = TypeVar("Value")

Place = Callable[[str], "Pose2 | None"]
"""Gives the pose of a frame in the map frame; None: it is not known."""


def _describe_sonars(found: Mapping[str, object], pose_of: Place) -> dict[str, object]:
    """Describe sonar cones in the map frame: x, y (m), yaw, range (m), field of view (rad), 1 for an echo."""
    cones = []
    for sonar in _only(found, Range).values():
        mount = pose_of(sonar.frame)
        if mount is None:
            continue
        echo = sonar.range_min <= sonar.range < sonar.range_max
        reach = sonar.range if echo else sonar.range_max
        cones.append([*_round(*mount, reach, sonar.field_of_view), int(echo)])
    return {"cones": cones}


def _describe_covariance(found: Mapping[str, object], pose_of: Place) -> dict[str, object]:
    """Describe the newest pose of the localiser and its covariance: x, y (m), xx, xy, yy (m^2)."""
    for estimate in _only(found, PoseEstimate).values():
        frame = pose_of(estimate.frame)
        if frame is not None:
            own = frame.compose(estimate.pose)
            cos, sin = math.cos(frame.yaw), math.sin(frame.yaw)
            turn = np.array([(cos, -sin), (sin, cos)])
            spread = turn @ estimate.covariance[:2, :2] @ turn.T
            shown = (spread[0, 0], spread[0, 1], spread[1, 1])
            return {"at": _round(own.x, own.y), "spread": [round(float(each), 6) for each in shown]}
    return {}


def _describe_fiducials(found: Mapping[str, object], _place: Place) -> dict[str, object]:
    """Describe the fiducials of the map: id, x, y (m)."""
    marks = [
        [each.number, *_round(*each.position[:2])]
        for fiducials in _only(found, MappedFiducials).values()
        for each in fiducials.fiducials[:_MOST_MARKS]
        if all(map(math.isfinite, each.position[:2]))
    ]
    return {"marks": marks}


def _describe_robots(found: Mapping[str, object], pose_of: Place) -> dict[str, object]:
    """Describe other robots by name: x, y (m), yaw. A localiser's pose is preferred to the simulator's."""
    shown = _only(found, PoseEstimate) | _only(found, Odometry)
    robots: dict[str, list[float]] = {}
    for name, value in sorted(shown.items(), key=lambda item: item[0], reverse=True):  # amcl_pose comes last
        frame = pose_of(value.frame)
        if frame is not None:
            robots[printable(name.rpartition("/")[0].strip("/"))[:40]] = _round(*frame.compose(value.pose))
    return {"robots": robots}


def _describe_frontiers(found: Mapping[str, object], pose_of: Place) -> dict[str, object]:
    """Describe the frontiers of an exploration: 1 for one that was given up, then x, y, x, y, ... (m)."""
    frontiers = []
    for shown in _only(found, Markers).values():
        frame = pose_of(shown.frame)
        if frame is None:
            continue
        for marker in [each for each in shown.markers if len(each.points)][:_MOST_FRONTIERS]:
            points = frame.transform_points(marker.points[:: 1 + len(marker.points) // _MOST_CELLS, :2])
            if np.isfinite(points).all():
                blocked = marker.colour[0] > marker.colour[2]
                frontiers.append([int(blocked), *(round(each, 2) for each in points.ravel().tolist())])
    return {"frontiers": frontiers}


def _only(found: Mapping[str, object], kind: type[Value]) -> dict[str, Value]:
    return {name: value for name, value in found.items() if isinstance(value, kind)}


def _round(*numbers: float) -> list[float]:
    return [round(each, 3) for each in numbers]


Kinds = Mapping[str, "tuple[type, Quality]"]


@dataclass(frozen=True, slots=True)
class Overlay:
    """A layer of small objects: the topics that it shows, and its description from their newest values, by topic.

    `kinds` are the types of its topics, each with the kind of its values and their quality. `topic` is the name of the
    only one; without it, `belongs` decides by the parts of a full name and the type.
    """

    kinds: Kinds
    describe: Callable[[Mapping[str, object], Place], dict[str, object]]
    topic: str = ""
    belongs: Callable[[list[str], str], bool] = lambda _parts, _type: True


_POSE, _ODOMETRY = "geometry_msgs/PoseWithCovarianceStamped", "nav_msgs/Odometry"
_POSES: Kinds = {_POSE: (PoseEstimate, Quality.LATCHED)}
_FIDUCIALS: Kinds = {"fiducial_msgs/FiducialMapEntryArray": (MappedFiducials, Quality.LATCHED)}
_MARKERS: Kinds = {"visualization_msgs/MarkerArray": (Markers, Quality.LATCHED)}
_SWITCHES: Kinds = {"std_msgs/Bool": (bool, Quality.LATCHED)}
_ROBOTS = {("amcl_pose", _POSE), ("base_pose_ground_truth", _ODOMETRY)}  # the second where it is simulated

OVERLAYS: Mapping[Layer, Overlay] = {
    Layer.SONARS: Overlay({"sensor_msgs/Range": (Range, Quality.NEWEST)}, _describe_sonars),
    Layer.COVARIANCE: Overlay(_POSES, _describe_covariance, "amcl_pose"),
    Layer.FIDUCIALS: Overlay(_FIDUCIALS, _describe_fiducials),
    Layer.ROBOTS: Overlay(
        {**_POSES, _ODOMETRY: (Odometry, Quality.NEWEST)},
        _describe_robots,
        belongs=lambda parts, kind: len(parts) > 2 and (parts[-1], kind) in _ROBOTS,  # another robot has a namespace
    ),
    Layer.FRONTIERS: Overlay(_MARKERS, _describe_frontiers, "explore/frontiers"),
    # Bumpers, `.../bumper/NAME`, are part of the robot's state.
    Layer.NONE: Overlay(_SWITCHES, lambda _found, _place: {}, belongs=lambda parts, _: parts[-2:-1] == ["bumper"]),
}
"""Overlays that are drawn from JSON, in `static/overlays.js`; in the order in which they are sent."""


_EVERY = 0.2  # s between two frames of a layer
_MOST = 64  # topics of a layer

Topic = tuple[str, str]


def choose_topics(layer: Layer, topics: Sequence[Topic], resolve: Callable[[str], str]) -> list[Topic]:
    """Return the topics of a layer among all topics (full name, type), at most 64; `resolve` returns full names."""
    overlay = OVERLAYS[layer]
    own = resolve(overlay.topic) if overlay.topic else ""

    def belongs(name: str, kind: str) -> bool:
        return kind in overlay.kinds and (name == own if own else overlay.belongs(name.split("/"), kind))

    return [topic for topic in sorted(topics) if belongs(*topic)][:_MOST]


class Overlays:
    """Sends the layers that pages show, and tracks bumpers. `pose_of` returns the pose of a frame in the map frame."""

    def __init__(self, node: Node, pose_of: Place, send: Callable[[bytes], None]) -> None:
        self._node, self._place, self._send = node, pose_of, send
        self._topics: Sequence[Topic] = ()
        self._stale = False  # what is wanted, or the topics, have changed
        self._wanted: frozenset[Layer] = frozenset()
        self._watched = False
        self._subscriptions: dict[tuple[Layer, str], Subscription] = {}
        self._newest: dict[tuple[Layer, str], object] = {}
        self._sent: dict[Layer, dict[str, object]] = {}
        self._send_every = Every(_EVERY)

    def want(self, layers: Collection[int], *, watched: bool) -> None:
        """Choose the layers to send; with `watched`, a page is open and bumpers are tracked."""
        wanted = frozenset(layer for layer in OVERLAYS if layer and layer in layers)
        self._stale = self._stale or (wanted, watched) != (self._wanted, self._watched)
        self._wanted, self._watched = wanted, watched

    def update_topics(self, topics: Sequence[Topic]) -> None:
        """Take the names and types of all topics."""
        self._topics, self._stale = topics, True

    def pressed(self) -> list[str]:
        """Return the names of the bumpers that are pressed."""
        names = {name for (layer, name), value in self._newest.items() if layer == Layer.NONE and value}
        return sorted(printable(name.rpartition("/")[2])[:40] for name in names)

    def step(self, now: float) -> None:
        """Subscribe to the chosen layers, and send changed ones; to be called often. `now` is `Node.steady`."""
        if self._stale:
            self._stale = False
            self._follow()
        if not self._send_every.due(now):
            return
        for layer in self._wanted:
            found = {name: value for (each, name), value in self._newest.items() if each == layer}
            self._show(layer, OVERLAYS[layer].describe(found, self._place))

    def _follow(self) -> None:
        layers = {*self._wanted, *((Layer.NONE,) if self._watched else ())}
        resolve = self._node.resolve
        wanted = {(layer, *topic) for layer in layers for topic in choose_topics(layer, self._topics, resolve)}
        for key in self._subscriptions.keys() - {(layer, name) for layer, name, _ in wanted}:
            self._subscriptions.pop(key).close()
            self._newest.pop(key, None)
        for layer, name, kind in wanted:
            key = layer, name
            if key not in self._subscriptions:
                take = partial(self._newest.__setitem__, key)
                value, quality = OVERLAYS[layer].kinds[kind]
                self._subscriptions[key] = self._node.subscribe(name, value, take, quality)
        for layer in self._sent.keys() - self._wanted:  # what a page gets that wants the layer again is old
            self._show(layer, {})
            del self._sent[layer]

    def _show(self, layer: Layer, value: dict[str, object]) -> None:
        if value != self._sent.get(layer, {}):
            self._sent[layer] = value
            self._send(json_frame(Kind.OVERLAY, value, layer))
