"""Frames, markers and point clouds, sent while a page shows them; the robot's model and its meshes when asked for."""

from __future__ import annotations

import base64
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import rospkg
import rospy
from sensor_msgs.msg import PointCloud2
from tf2_msgs.msg import TFMessage

from ur.robot.description.mesh_file import read_mesh
from ur.web.wire.data_frames import pack_frame, pack_json
from ur.web.wire.data_requests import Show
from ur_nodes.ports.graph import Graph
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.scene.clouds import BadCloudError, pack_cloud, unpack_cloud
from ur_nodes.web.scene.frames import FrameTree
from ur_nodes.web.scene.markers import Markers
from ur_nodes.web.scene.model import BadModelError, find_mesh, package_of, read_model

_FRAMES_EVERY = 0.1  # s
_LIST_EVERY = 2.0  # s
_CLOUD_EVERY = 0.2  # s
_MARKERS_EVERY = 0.2  # s
_BUFFER = 1 << 24  # bytes of one message
_MOST_TOPICS = 6  # of all pages
_MOST_TRIANGLES = 30_000
_LARGEST_MESH = 20_000_000  # bytes
_CLOUD = "sensor_msgs/PointCloud2"
_MARKERS = ("visualization_msgs/Marker", "visualization_msgs/MarkerArray")

Send = Callable[[bytes], None]


class SceneFeed:
    """Sends what pages show. `subscribe` makes subscribers as rospy.Subscriber does."""

    def __init__(self, send: Send, subscribe: Callable[..., Any] = rospy.Subscriber) -> None:
        self._send, self._subscribe = send, subscribe
        self._lock = threading.Lock()
        self._tree = FrameTree()
        self._frames: list[list[Any]] = []
        self._frame_topics: list[Any] = []
        self._topics: dict[str, tuple[str, Any]] = {}
        self._markers: dict[str, Markers] = {}
        self._cloud_due: dict[str, float] = {}
        self._pages: dict[int, tuple[str, ...]] = {}
        self._new: set[int] = set()
        self._frames_every, self._list_every, self._markers_every = (
            Every(_FRAMES_EVERY),
            Every(_LIST_EVERY),
            Every(_MARKERS_EVERY),
        )

    def step(self, now: float, shows: Mapping[int, Show], graph: Graph) -> None:
        """Subscribe to what pages show, and send it; to be called often, from one thread."""
        pages = {page: each.scene for page, each in shows.items() if each.scene is not None}
        self._new = {page for page in pages if pages[page] != self._pages.get(page)}
        with self._lock:
            self._pages = pages
        self._follow_frames(bool(pages))
        if not pages:
            self._follow_topics({})
            return
        if self._list_every.due(now) or self._new:
            kinds = {name: topic.kind for name, topic in graph.topics.items() if topic.publishers}
            offered = sorted((name, kind) for name, kind in kinds.items() if kind in (_CLOUD, *_MARKERS))[:100]
            wanted = sorted({name for each in pages.values() for name in each} & dict(offered).keys())[:_MOST_TOPICS]
            self._follow_topics({name: kinds[name] for name in wanted})
            for page in pages:
                self._send(pack_json(page, "scene", {"t": "scene", "topics": [list(each) for each in offered]}))
        if self._frames_every.due(now):
            self._send_frames()
        if self._markers_every.due(now):
            self._send_markers()

    def _follow_frames(self, wanted: bool) -> None:
        if wanted and not self._frame_topics:
            self._frame_topics = [
                self._subscribe("/tf", TFMessage, self._take_frames, callback_args=False, queue_size=20),
                self._subscribe("/tf_static", TFMessage, self._take_frames, callback_args=True, queue_size=20),
            ]
        elif not wanted and self._frame_topics:
            for each in self._frame_topics:
                each.unregister()
            with self._lock:
                self._frame_topics, self._tree, self._frames = [], FrameTree(), []

    def _follow_topics(self, wanted: Mapping[str, str]) -> None:
        for name in [name for name, (kind, _) in self._topics.items() if wanted.get(name) != kind]:
            self._topics.pop(name)[1].unregister()
            with self._lock:
                self._markers.pop(name, None)
        for name, kind in wanted.items():
            if name in self._topics:
                continue
            if kind == _CLOUD:
                found = self._subscribe(
                    name, PointCloud2, self._take_cloud, callback_args=name, queue_size=1, buff_size=_BUFFER
                )
            else:
                from visualization_msgs.msg import Marker, MarkerArray

                with self._lock:
                    self._markers[name] = Markers()
                message = MarkerArray if kind.endswith("Array") else Marker
                found = self._subscribe(name, message, self._take_markers, callback_args=name, queue_size=20)
            self._topics[name] = kind, found

    def _send_frames(self) -> None:
        with self._lock:
            frames = self._tree.describe(time.monotonic())
        changed, self._frames = frames != self._frames, frames
        for page in self._pages if changed else self._new:
            self._send(pack_json(page, "tf", {"t": "tf", "frames": frames}))

    def _send_markers(self) -> None:
        now = time.monotonic()
        due = {}
        with self._lock:
            for name, markers in self._markers.items():
                if markers.changed or markers.expires(now) or self._new:
                    due[name] = markers.describe(now)
        for name, shown in due.items():
            for page, wanted in self._pages.items():
                if name in wanted:
                    value = {"t": "markers", "topic": name, "markers": shown}
                    self._send(pack_json(page, f"markers:{name}"[:200], value))

    @quiet_at_end
    def _take_frames(self, message: Any, fixed: bool) -> None:
        now = time.monotonic()
        with self._lock:
            for each in message.transforms[:400]:
                self._tree.take(each, now, fixed=fixed)

    @quiet_at_end
    def _take_markers(self, message: Any, name: str) -> None:
        now = time.monotonic()
        with self._lock:
            found = self._markers.get(name)
            if found is not None:
                for each in getattr(message, "markers", [message])[:1000]:
                    found.take(each, now)

    @quiet_at_end
    def _take_cloud(self, message: Any, name: str) -> None:
        now = time.monotonic()
        if now < self._cloud_due.get(name, 0.0):
            return
        self._cloud_due[name] = now + _CLOUD_EVERY
        try:
            points, colours = unpack_cloud(message)
        except BadCloudError as problem:
            rospy.logwarn_throttle(10.0, f"{name}: {problem}")
            return
        body = pack_cloud(name, message.header.frame_id.lstrip("/"), points, colours)
        with self._lock:
            pages = [page for page, wanted in self._pages.items() if name in wanted]
        for page in pages:
            self._send(pack_frame(page, f"cloud:{name}"[:200], body))


def describe_model() -> Mapping[str, Any]:
    """The answer to the question for the robot's model: its shapes."""
    text = rospy.get_param("/robot_description", None)
    if not isinstance(text, str):
        return {"ok": False, "text": "no description of the robot: the parameter /robot_description is not set"}
    try:
        return {"value": read_model(text)}
    except BadModelError as problem:
        return {"ok": False, "text": str(problem)[:300]}


def describe_mesh(address: str) -> Mapping[str, Any]:
    """The answer to the question for a mesh that the description names: its triangles, or its extent."""
    shapes = describe_model().get("value", [])
    if not any(each.get("mesh") == address for each in shapes):
        return {"ok": False, "text": f"{address}: the robot's description does not name it"}
    try:
        path = find_mesh(address, rospkg.RosPack().get_path(package_of(address)))
    except rospkg.ResourceNotFound:
        return {"ok": False, "text": f"{address}: the package is not installed on this computer"}
    if path is None or not path.is_file() or path.stat().st_size > _LARGEST_MESH:
        return {"ok": False, "text": f"{address}: no mesh of at most {_LARGEST_MESH} bytes within its package"}
    points = read_mesh(path)
    if not len(points):
        return {"ok": False, "text": f"{address}: no points in it"}
    extent = [points.min(axis=0).tolist(), points.max(axis=0).tolist()]
    if path.suffix.lower() != ".stl" or len(points) > 3 * _MOST_TRIANGLES:
        return {"value": {"extent": extent}}
    data = base64.b64encode(points.astype(np.float32).tobytes()).decode()
    return {"value": {"extent": extent, "triangles": data}}
