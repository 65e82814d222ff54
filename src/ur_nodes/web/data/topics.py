"""Topics for pages: rates of those in view, and the messages of the one that a page prints."""

from collections import deque
from collections.abc import Callable, Mapping
from functools import partial

from ur.web.wire.data_requests import Show, pack_json
from ur_nodes.ports.graph import Graph, Topic
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.messages.decode import BadMessageError, decode, render
from ur_nodes.web.messages.definition import BadDefinitionError, read_definition

ECHO_EVERY = 0.1
"""Seconds between two messages that are printed."""

_LIST_EVERY = 1.0  # s
_MOST_TOPICS = 1000
_MOST_MEASURED = 40  # of all pages
_LONGEST = 1 << 20  # bytes of a message that is printed
_HEAVY = (
    "sensor_msgs/Image",
    "sensor_msgs/CompressedImage",
    "sensor_msgs/PointCloud2",
    "theora_image_transport/Packet",
)
"""Types that are measured only while one is printed: to subscribe makes cameras work."""

Send = Callable[[bytes], None]
SPAN = 3.0
"""Seconds over which is measured."""

_MOST = 2000  # messages that are counted one by one


class RateMeter:
    """Counts messages of one topic. Times are seconds of any steady clock."""

    def __init__(self, began: float) -> None:
        self._began = began
        self._seen: deque[tuple[float, int]] = deque(maxlen=_MOST)

    def note(self, now: float, size: int) -> None:
        """Count a message of `size` bytes."""
        self._seen.append((now, size))

    def measure(self, now: float) -> tuple[float, float]:
        """Return messages per second and bytes per second."""
        while self._seen and self._seen[0][0] < now - SPAN:
            self._seen.popleft()
        full = len(self._seen) == _MOST
        span = max(now - self._seen[0][0], 1e-3) if full else max(min(SPAN, now - self._began), 0.5)
        return len(self._seen) / span, sum(size for _, size in self._seen) / span


class _Watched:
    """A subscribed topic, its rate and its newest message."""

    def __init__(self, node: Node, topic: Topic) -> None:
        self.topic, self.meter = topic, RateMeter(node.steady())
        self.newest: RawMessage | None = None
        self.count = 0
        self._node = node
        self._subscription = node.raw.subscribe(topic.name, self._on_message, Quality.EVERY)

    def end(self) -> None:
        """Unsubscribe."""
        self._subscription.close()

    def _on_message(self, message: RawMessage) -> None:
        self.meter.note(self._node.steady(), len(message.data))
        self.count += 1
        self.newest = message


class TopicWatch:
    """Sends what pages show of topics."""

    def __init__(self, node: Node, send: Send) -> None:
        self._node, self._send = node, send
        self._watched: dict[str, _Watched] = {}
        self._printed: dict[int, tuple[str, int]] = {}
        self._printing: set[int] = set()
        self._list_every, self._echo_every = Every(_LIST_EVERY), Every(ECHO_EVERY)

    def hurry(self) -> None:
        """Let the next `step` send at once: a page shows other topics now."""
        self._list_every.hurry()

    def step(self, shows: Mapping[int, Show], graph: Graph) -> None:
        """Subscribe to what pages show, and send it; to be called often."""
        now = self._node.steady()
        echoed = {each.echo for each in shows.values() if each.echo}
        if self._list_every.due(now):
            chosen = {name: graph.topics[name] for name in echoed & graph.topics.keys()}
            for name in sorted(name for each in shows.values() for name in each.topics or ()):
                topic = graph.topics.get(name)
                if len(chosen) < _MOST_MEASURED and topic is not None and topic.publishers and topic.kind not in _HEAVY:
                    chosen[name] = topic
            self._follow(chosen)
            rows = self._list(now, graph) if any(each.topics is not None for each in shows.values()) else []
            for page, each in shows.items():
                if each.topics is not None:
                    self._send(pack_json(page, "topics", {"t": "topics", "rows": rows, "all": len(graph.topics)}))
        if echoed and self._echo_every.due(now):
            for page, each in shows.items():
                if each.echo:
                    self._print(page, each.echo)
        self._printed = {page: each for page, each in self._printed.items() if page in shows}

    def _follow(self, chosen: Mapping[str, Topic]) -> None:
        for name in [
            name for name, each in self._watched.items() if name not in chosen or each.topic.kind != chosen[name].kind
        ]:
            self._watched.pop(name).end()
        for name, topic in chosen.items():
            if name not in self._watched:
                self._watched[name] = _Watched(self._node, topic)

    def _list(self, now: float, graph: Graph) -> list[list[object]]:
        rows = []
        for name, topic in sorted(graph.topics.items())[:_MOST_TOPICS]:
            row: list[object] = [name[:200], topic.kind[:200], len(topic.publishers), len(topic.subscribers)]
            watched = self._watched.get(name)
            if watched is not None:
                rate, bandwidth = watched.meter.measure(now)
                row += [round(rate, 1), round(bandwidth)]
            rows.append(row)
        return rows

    def _print(self, page: int, name: str) -> None:
        watched = self._watched.get(name)
        if watched is None or watched.newest is None or page in self._printing:
            return
        if self._printed.get(page) == (name, watched.count):
            return
        self._printed[page] = name, watched.count
        self._printing.add(page)
        self._node.work(partial(_describe, name, watched.count, watched.newest), partial(self._pass_on, page), "print")

    def _pass_on(self, page: int, value: Mapping[str, object]) -> None:
        self._printing.discard(page)
        self._send(pack_json(page, "echo", value))


def _describe(name: str, count: int, message: RawMessage) -> Mapping[str, object]:
    kind, size = message.type_name[:200], len(message.data)
    value: dict[str, object] = {"t": "echo", "topic": name, "kind": kind, "size": size, "count": count}
    try:
        # A message as lines of text. Raises BadDefinitionError and BadMessageError.
        if len(message.data) > _LONGEST:
            raise BadMessageError(f"message of {len(message.data)} bytes, expected at most {_LONGEST} to print it")
        value["lines"] = render(decode(read_definition(message.type_name, message.schema), message.data))
    except (BadDefinitionError, BadMessageError) as problem:
        value["problem"] = str(problem)[:300]
    return value
