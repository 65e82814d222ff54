"""The black box: chooses topics, records them in memory, and writes them to a file after an event."""

import re
import socket
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from ur.recordings.black_boxes import REPORT_REQUEST
from ur.source.printable import printable
from ur_nodes.black_box.history import LARGE_BYTES, HistoryTopic, MessageHistory, Ring
from ur_nodes.black_box.recording_file import RecordingError
from ur_nodes.motion.lease.text import Lease, read_lease
from ur_nodes.ports.actions import GoalState
from ur_nodes.ports.graph import Graph, Topic
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RecordedMessage, RecordedTopic, RecordedType
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result

_MOST_GOALS = 200
_LONGEST = 200  # characters of a text from another node
_IN_FORCE = 5_000_000_000  # ns after the subscription in which a first value may be one of before it


@dataclass(slots=True)
class Triggers:
    """Calls `happened` with a text for each event since the start; repetitions are left out.

    `clock` is in ns. The first message soon after a subscription describes an earlier state.
    """

    happened: Callable[[str], None]
    clock: Callable[[], int]
    _on: dict[str, bool] = field(default_factory=dict)
    _goals: dict[str, None] = field(default_factory=dict)
    _lost: str | None = None
    _driver: str = ""
    _since: dict[str, int] = field(default_factory=dict)

    def subscribe(self, node: Node, mux: str, navigation: str, localiser: str) -> None:
        """Subscribe to the topics of the mux, navigation and localisation, by the names of their nodes."""
        self._listen_to_switch(node, f"{mux}/stopped", "the emergency stop was pressed")
        node.subscribe(f"{mux}/lease", str, self.on_lease, _LATCHED)
        self._since[_LOST] = self.clock()
        node.subscribe(f"{localiser}/lost", str, self.on_lost, _LATCHED)
        node.follow_goals(navigation, self)

    def listen_to_bumper(self, node: Node, topic: str) -> None:
        """Subscribe to a bumper or cliff sensor."""
        name = topic.strip("/").replace("/", " ")
        self._listen_to_switch(node, topic, f"{name} was touched")

    def _listen_to_switch(self, node: Node, topic: str, text: str) -> None:
        self._since[text] = self.clock()
        node.subscribe(topic, bool, lambda on: self.switch(text, on), _LATCHED)

    def switch(self, text: str, on: bool) -> None:
        """Handle the state of a switch: switching on is an event."""
        before, self._on[text] = self._on.get(text, self._is_early(text)), on
        if on and not before:
            self.happened(text)

    def on_lost(self, text: str) -> None:
        """Handle the reason why localisation is lost; empty while it is not."""
        before = self._is_early(_LOST) if self._lost is None else bool(self._lost)
        self._lost = text
        if text and not before:
            self.happened(f"localisation is lost: {text[:_LONGEST]}")

    def _is_early(self, text: str) -> bool:
        return self.clock() - self._since.get(text, 0) < _IN_FORCE

    def on_states(self, states: tuple[GoalState, ...]) -> None:
        """Ignore the states; only ends are events."""

    def on_goal_end(self, state: GoalState) -> None:
        """Handle the end of a goal: one that was given up or refused is one event."""
        if state.state == "aborted" and state.id not in self._goals:
            self._goals[state.id] = None
            self.happened(f"a goal was aborted: {state.text[:_LONGEST]}")
            while len(self._goals) > _MOST_GOALS:
                del self._goals[next(iter(self._goals))]

    def on_lease(self, text: str) -> None:
        """Handle the lease: a new driver is an event, unless the robot was free before."""
        lease: Lease | None = read_lease(text)
        if lease is None or not lease.client:
            self._driver = ""
            return
        before, self._driver = self._driver, lease.client
        if before and before != lease.client:
            self.happened("another client has taken over")


_LOST = "lost"
_LATCHED = Quality.LATCHED


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
        self._recorder = node.raw.record(self._on_batch, steady_ns)
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

    def _on_batch(self, batch: Sequence[RecordedMessage]) -> None:
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
