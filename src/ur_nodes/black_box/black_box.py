"""The black box: chooses topics, records them in memory, and writes them to a file after an event."""

import re
import socket
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ur.recordings.black_boxes import REPORT_REQUEST
from ur.source.printable import printable
from ur_nodes.black_box.history import LARGE_BYTES, HistoryTopic, MessageHistory
from ur_nodes.black_box.recording_file import RecordingError
from ur_nodes.black_box.ring import Ring
from ur_nodes.black_box.triggers import Triggers
from ur_nodes.ports.graph import Graph, Topic
from ur_nodes.ports.node import Node
from ur_nodes.ports.raw import RecordedMessage, RecordedTopic, RecordedType
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result

MOST_TOPICS = 500

PICTURE_PERIOD = 1.0
"""Seconds from one picture or cloud to the next."""

_CAMERA_INFO = "CameraInfo"
_SELDOM = frozenset(
    {"Image", "CompressedImage", _CAMERA_INFO, "PointCloud", "PointCloud2", "DisparityImage", "CompressedPointCloud2"}
)
_STREAM = "Packet"  # of a film, of which one picture in many cannot be shown
_PACKED = ("/compressed", "/compressedDepth")


def select_topics(graph: Graph, wake: bool, large: frozenset[str] = frozenset()) -> tuple[RecordedTopic, ...]:
    """Select at most MOST_TOPICS topics of a graph, sorted by name.

    Pictures and clouds, and the topics in `large`, are recorded once a second. Without `wake` they are taken only while
    another node subscribes to them, since cameras and their drivers do nothing before. A raw picture is left out where
    it is published compressed, too, and the log of all nodes where each of them publishes its own.
    """
    topics = [each for each in graph.topics.values() if each.publishers]
    names = {each.name for each in topics}
    chosen = []
    for each in topics:
        kind = each.kind.rpartition("/")[2]
        if kind == _STREAM or (each.name == "/rosout_agg" and "/rosout" in names):
            continue
        if kind == "Image" and _has_packed(each, names):
            continue
        if kind in _SELDOM and not wake and not each.subscribers:
            continue
        period = PICTURE_PERIOD if kind in _SELDOM or each.name in large else 0.0
        chosen.append(RecordedTopic(each.name, each.publishers, period, each.kind))
    return tuple(chosen)


def _has_packed(topic: Topic, names: set[str]) -> bool:
    # image_transport adds to the whole name, raspicam_node to the one of the camera's pictures
    return any(f"{stem}{each}" in names for each in _PACKED for stem in (topic.name, topic.name.removesuffix("_raw")))


_BUMPER = re.compile(r"/(?:\w+/)*(bumper|cliff)/\w+", re.ASCII)
_LOOK = 1.0  # s between two looks at the graph
_MOST_REASONS = 50
_AT_ONCE = 0.2  # s, in which what has been sent arrives


@dataclass(frozen=True, slots=True)
class BlackBoxSettings:
    """`after` s pass between an event and its file, which begins `seconds` before it.

    `mux`, `navigation` and `localiser` are names of nodes, whose topics report events. With `cameras`, pictures
    are taken also where no other node subscribes to them.
    """

    seconds: float = 120.0
    after: float = 5.0
    mux: str = "cmd_vel_mux"
    navigation: str = "move_base"
    localiser: str = "amcl"
    cameras: bool = True


Write = Callable[[Sequence[str]], str]
"""Writes what is in the ring, with the reasons, and returns the path of the file. Raises RecordingError."""


class BlackBox:
    """Records topics into a ring. `steady_ns` reads a clock that is never set."""

    def __init__(
        self,
        node: Node,
        settings: BlackBoxSettings,
        ring: Ring,
        write: Write,
        steady_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._node, self._settings, self._write_file = node, settings, write
        self._steady = steady_ns
        self._history = MessageHistory(ring, settings.seconds)
        self._types: dict[RecordedType, HistoryTopic] = {}
        self._large: set[str] = set()
        self._bumpers: set[str] = set()
        self._reasons: list[str] = []
        self._waiting: list[Callable[[Result], None]] = []
        self._full_reported = False
        self._triggers = Triggers(self.happened, steady_ns)
        self._triggers.subscribe(node, settings.mux, settings.navigation, settings.localiser)
        node.serve_later("~write", Trigger, self._write_on_request)
        node.on_end(self._end, within=10.0)
        self._recorder = node.raw.record(self._take, steady_ns)
        node.on_end(self._recorder.close)
        node.read_graph(self._compare)

    def happened(self, text: str) -> None:
        """Schedule a file because of an event."""
        now = self._steady()
        self._history.note_event(now, text)
        first = not self._reasons
        if len(self._reasons) < _MOST_REASONS:
            self._reasons.append(text)
        if first:
            after = _AT_ONCE if text == REPORT_REQUEST else self._settings.after
            self._node.after(after, self._write, steady=True)

    def _write_on_request(self, _request: Trigger, give: Callable[[Result], None]) -> None:
        self._waiting.append(give)
        self.happened("requested")

    def _compare(self, graph: Graph | None) -> None:
        self._node.after(_LOOK, lambda: self._node.read_graph(self._compare), steady=True)
        if graph is None:
            return
        topics = select_topics(graph.without(self._node.name), self._settings.cameras, frozenset(self._large))
        if len(topics) > MOST_TOPICS:
            self._report_full(topics[MOST_TOPICS].name)
        self._recorder.record(topics[:MOST_TOPICS])
        for name in (each.name for each in topics if each.name not in self._bumpers and _BUMPER.fullmatch(each.name)):
            self._bumpers.add(name)
            self._triggers.listen_to_bumper(self._node, name)

    def _report_full(self, name: str) -> None:
        if not self._full_reported:
            self._full_reported = True
            self._node.log.warn(f"{name} and later topics are not recorded: the limit is {MOST_TOPICS} topics")

    def _take(self, batch: Sequence[RecordedMessage]) -> None:
        for kind, moment, data in batch:
            topic = self._types.get(kind)
            if topic is None:
                topic = HistoryTopic(kind.topic, kind.type_name, kind.schema, kind.sender, kind.latched)
                self._types[kind] = topic
            if len(data) > LARGE_BYTES:
                self._large.add(kind.topic)
            self._history.note(topic, moment, data)

    def _write(self) -> None:
        reasons, self._reasons = self._reasons, []
        waiting, self._waiting = self._waiting, []
        if not reasons:
            return

        def write() -> tuple[str, str]:
            try:
                return self._write_file([printable(each) for each in reasons]), ""
            except RecordingError as problem:
                return "", str(problem)

        def report(written: tuple[str, str]) -> None:
            path, problem = written
            if path:
                self._node.log.info(f"wrote {path}: {reasons[0]}")
            else:
                self._node.log.error(f"no recording of '{reasons[0]}': {problem}")
            for give in waiting:
                give(Result(bool(path), f"{socket.gethostname()}:{path}" if path else problem))
            for name, count in self._history.left_out.items():
                self._node.log.warn(f"{name}: {count} messages were too large for the black box")
            self._history.left_out.clear()

        self._node.work(write, report, "black box")

    def _end(self) -> None:
        self._write()
