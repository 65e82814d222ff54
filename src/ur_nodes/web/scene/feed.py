"""Frames, bounded markers and point clouds, sent while a page shows them."""

import math
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ur.source.printable import printable
from ur.web.wire.data_requests import Show, pack_frame, pack_json
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.validation import problem_of
from ur_nodes.ports.values import MarkerChange, MarkerChanges, PointCloud, Transform
from ur_nodes.web.layers.pacing import Every

_MOST_KEPT = 300  # markers of one topic
_MOST_POINTS = 3000  # of one marker
_MOST_POINTS_OF_ALL = 12_000
_FARTHEST_POINT = 1e5  # m


class ShownMarkers:
    """The markers of one topic by namespace and id. Times are seconds of any steady clock."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, int], tuple[float, dict[str, Any]]] = {}
        self.changed = False

    def apply(self, change: MarkerChange, now: float) -> None:
        """Apply a change unless its marker is malformed."""
        key = change.marker.namespace[:200], change.marker.number
        if change.action == "clear":
            self._known.clear()
        elif change.action == "delete":
            self._known.pop(key, None)
        else:
            found = describe_marker(change)
            if found is None or (key not in self._known and len(self._known) >= _MOST_KEPT):
                return
            self._known[key] = (now + change.lifetime if change.lifetime > 0 else math.inf), found
        self.changed = True

    def describe(self, now: float) -> list[dict[str, Any]]:
        """Return the markers that are shown at `now`, at most as many as pages get."""
        alive = {key: each for key, each in self._known.items() if each[0] > now}
        self._known, self.changed = alive, False
        shown, points = [], 0
        for _, each in alive.values():
            points += len(each.get("points", ())) // 3
            if points > _MOST_POINTS_OF_ALL:
                break
            shown.append(each)
        return shown

    def expires(self, now: float) -> bool:
        """Return whether a marker has expired since it was described."""
        return any(until <= now for until, _ in self._known.values())


def describe_marker(change: MarkerChange) -> dict[str, Any] | None:
    """Describe a marker as JSON: frame, kind, pose, scale, colour, points, text; None if it cannot be shown."""
    marker = change.marker
    if not _good((*marker.pose, *marker.size, *marker.colour)):
        return None
    found: dict[str, Any] = {
        "frame": change.frame[:100],
        "kind": marker.shape,
        "pose": _round(marker.pose),
        "scale": _round(marker.size),
        "color": _round(marker.colour),
    }
    points, colours = marker.points[:_MOST_POINTS], marker.colours[:_MOST_POINTS, :3]
    if not _good(points):
        return None
    if len(points):
        found["points"] = points.round(4).ravel().tolist()
        if len(colours) == len(points) and _good(colours):
            found["colors"] = colours.round(4).ravel().tolist()
    if marker.shape == "text":
        found["text"] = printable(marker.text[:200])
    return found


def _good(numbers: Sequence[float] | NDArray[np.float64]) -> bool:
    return bool((np.abs(numbers) < _FARTHEST_POINT).all())


def _round(numbers: Sequence[float]) -> list[float]:
    return [round(each, 4) for each in numbers]


MOST_POINTS = 15_000
"""Points of a cloud that is sent."""

_FARTHEST = 1000.0  # m
_VERSION = 1
_HEAD = struct.Struct("<f3fI?")

Points = NDArray[np.float64]
Colours = NDArray[np.uint8]


def thin_cloud(cloud: NDArray[np.void], most: int = MOST_POINTS) -> tuple[Points, Colours | None]:
    """Return points (n, 3) of a `PointCloud` in m, and their colours (n, 3) if it has colours.

    At most `most` points, evenly chosen; points that are not finite or are too far away are left out.
    """
    table = cloud[:: max(1, -(-len(cloud) // most))]
    points = np.stack([table[name].astype(np.float64) for name in "xyz"], axis=1)
    with np.errstate(invalid="ignore"):
        good = (np.abs(points) < _FARTHEST).all(axis=1)
    colours = None
    if "rgb" in (cloud.dtype.names or ()):
        packed = table["rgb"][good]
        colours = np.stack([packed >> 16, packed >> 8, packed], axis=1).astype(np.uint8)
    return points[good], colours


def pack_cloud(topic: str, frame: str, points: Points, colours: Colours | None) -> bytes:
    """Pack points for a page; `static/data/scene_data.js` reads the bytes."""
    middle = points.mean(axis=0) if len(points) else np.zeros(3)
    reach = float(np.abs(points - middle).max()) if len(points) else 0.0
    unit = max(reach / 32767.0, 0.001)
    small = np.round((points - middle) / unit).astype("<i2")
    names = b"".join(struct.pack("<B", len(each)) + each for each in (topic.encode()[:255], frame.encode()[:255]))
    head = _HEAD.pack(unit, *middle, len(points), colours is not None)
    return (
        struct.pack("<B", _VERSION) + names + head + small.tobytes() + (b"" if colours is None else colours.tobytes())
    )


_FRAMES_EVERY = 0.1  # s
_LIST_EVERY = 2.0  # s
_CLOUD_EVERY = 0.2  # s
_MARKERS_EVERY = 0.2  # s
_MOST_TOPICS = 6  # of all pages
_MOST_OFFERED = 100
_MOST_TRANSFORMS, _MOST_MARKERS = 400, 1000  # of one message
_CLOUD, _MARKER, _MARKERS = "sensor_msgs/PointCloud2", "visualization_msgs/Marker", "visualization_msgs/MarkerArray"

Send = Callable[[bytes], None]
_MOST = 400  # frames
_OLD = 30.0  # s after which a moving frame is left out


class FrameTree:
    """Frames by name. Times are seconds of any steady clock."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[float, list[object]]] = {}

    def add(self, transform: Transform, now: float, *, fixed: bool) -> None:
        """Take a transform unless it is malformed; a `fixed` one does not expire."""
        child, parent, pose = transform.child[:100], transform.parent[:100], transform.pose
        if not child or child == parent or problem_of(pose) or (child not in self._known and len(self._known) >= _MOST):
            return
        self._known[child] = (math.inf if fixed else now), [child, parent, *(round(each, 5) for each in pose)]

    def describe(self, now: float) -> list[list[object]]:
        """Return rows of child, parent, x, y, z in m, and the quaternion x, y, z, w."""
        self._known = {name: each for name, each in self._known.items() if now - each[0] < _OLD}
        return [each for _, each in sorted(self._known.values(), key=lambda each: str(each[1][0]))]


class SceneFeed:
    """Sends frames, markers and point clouds to pages, on the node's thread. `send` does not block."""

    def __init__(self, node: Node, send: Send) -> None:
        self._node, self._send = node, send
        self._tree = FrameTree()
        self._frames: list[list[object]] = []
        self._frame_topics: list[Subscription] = []
        self._topics: dict[str, tuple[str, Subscription]] = {}
        self._markers: dict[str, ShownMarkers] = {}
        self._clouds: dict[str, Every] = {}
        self._pages: dict[int, tuple[str, ...]] = {}
        self._new: set[int] = set()
        self._frames_every, self._list_every, self._markers_every = map(
            Every, (_FRAMES_EVERY, _LIST_EVERY, _MARKERS_EVERY)
        )

    def step(self, shows: Mapping[int, Show], kinds: Mapping[str, str]) -> None:
        """Subscribe to the topics that pages show, and send their contents; to be called often.

        `kinds` are the types of the topics that are published, by name.
        """
        now = self._node.steady()
        pages = {page: each.scene for page, each in shows.items() if each.scene is not None}
        self._new = {page for page in pages if pages[page] != self._pages.get(page)}
        self._pages = pages
        self._follow_frames(bool(pages))
        if not pages:
            self._follow_topics({})
            return
        if self._new:
            for every in (self._list_every, self._frames_every, self._markers_every):
                every.hurry()
        if self._list_every.due(now):
            shown = (_CLOUD, _MARKER, _MARKERS)
            offered = sorted((name, kind) for name, kind in kinds.items() if kind in shown)[:_MOST_OFFERED]
            wanted = sorted({name for each in pages.values() for name in each} & dict(offered).keys())[:_MOST_TOPICS]
            self._follow_topics({name: kinds[name] for name in wanted})
            for page in pages:
                self._send(pack_json(page, "scene", {"t": "scene", "topics": [list(each) for each in offered]}))
        if self._frames_every.due(now):
            self._send_frames(now)
        if self._markers_every.due(now):
            self._send_markers(now)

    def _follow_frames(self, wanted: bool) -> None:
        if wanted and not self._frame_topics:
            fixed, moving = (partial(self._on_frames, fixed=each) for each in (True, False))
            self._frame_topics = [
                self._node.subscribe("/tf_static", tuple, fixed, Quality.LATCHED_EVERY),
                self._node.subscribe("/tf", tuple, moving, Quality.EVERY),
            ]
        elif not wanted and self._frame_topics:
            for each in self._frame_topics:
                each.close()
            self._frame_topics, self._tree, self._frames = [], FrameTree(), []

    def _follow_topics(self, wanted: Mapping[str, str]) -> None:
        for name in [name for name, (kind, _) in self._topics.items() if wanted.get(name) != kind]:
            self._topics.pop(name)[1].close()
            self._markers.pop(name, None)
            self._clouds.pop(name, None)
        for name, kind in wanted.items():
            if name not in self._topics:
                self._topics[name] = kind, self._subscribe(name, kind)

    def _subscribe(self, name: str, kind: str) -> Subscription:
        if kind == _CLOUD:
            self._clouds[name] = Every(_CLOUD_EVERY)
            return self._node.subscribe(name, PointCloud, partial(self._on_cloud, name))
        self._markers[name] = ShownMarkers()
        if kind == _MARKER:
            return self._node.subscribe(
                name, MarkerChange, lambda change: self._on_markers(name, (change,)), Quality.EVERY
            )
        return self._node.subscribe(
            name, MarkerChanges, lambda found: self._on_markers(name, found.changes[:_MOST_MARKERS]), Quality.EVERY
        )

    def _send_frames(self, now: float) -> None:
        frames = self._tree.describe(now)
        changed, self._frames = frames != self._frames, frames
        for page in self._pages if changed else self._new:
            self._send(pack_json(page, "tf", {"t": "tf", "frames": frames}))

    def _send_markers(self, now: float) -> None:
        for name, markers in self._markers.items():
            if not (markers.changed or markers.expires(now) or self._new):
                continue
            value = {"t": "markers", "topic": name, "markers": markers.describe(now)}
            for page in self._showing(name):
                self._send(pack_json(page, f"markers:{name}"[:200], value))

    def _showing(self, topic: str) -> list[int]:
        return [page for page, wanted in self._pages.items() if topic in wanted]

    def _on_frames(self, transforms: tuple[Transform, ...], *, fixed: bool) -> None:
        now = self._node.steady()
        for each in transforms[:_MOST_TRANSFORMS]:
            self._tree.add(each, now, fixed=fixed)

    def _on_markers(self, name: str, changes: Iterable[MarkerChange]) -> None:
        now = self._node.steady()
        for each in changes:
            self._markers[name].apply(each, now)

    def _on_cloud(self, name: str, cloud: PointCloud) -> None:
        if self._clouds[name].due(self._node.steady()):
            body = pack_cloud(name, cloud.frame, *thin_cloud(cloud.points))
            for page in self._showing(name):
                self._send(pack_frame(page, f"cloud:{name}"[:200], body))
