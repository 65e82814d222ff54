"""The newest picture of a topic, and how its pictures arrive, or why a topic carries nothing."""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ur.source.printable import printable
from ur_nodes.pictures.decode import BadPictureError, Pixels, decode_picture, read_size, unpack_picture
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import LogLine, PackedPicture, Picture

_ASK_EVERY = 2.0  # s
_LOG = "/rosout"


def explain_silence(publishers: Sequence[str], connections: int, errors: Mapping[str, str]) -> str:
    """Explain why nothing is received, in a clause.

    `publishers` are the nodes that publish the topic, `connections` how many of them are connected, `errors` the last
    error that each node has logged.
    """
    if not publishers:
        return "no node publishes it"
    for node in publishers:
        if errors.get(node):
            return f"{node}: {errors[node]}"
    names = " and ".join(publishers)
    if not connections:
        return f"{names} publishes it, but cannot be reached"
    return f"{names} publishes it, but sends nothing"


class SilenceMonitor:
    """Explains why a topic carries nothing. Costs nothing before `explain` is called.

    Nodes latch their last log message, so an error from before the first call is found too.
    """

    def __init__(self, node: Node, topic: str) -> None:
        self._node = node
        self._topic = topic
        self._publishers: tuple[str, ...] | None = None
        self._errors: dict[str, str] = {}
        self._log: Subscription | None = None
        self._asked_at = 0.0
        self._asking = False

    def explain(self, connections: int) -> str:
        """Return the reason as far as it is known by now; empty at first."""
        now = self._node.steady()
        if self._log is None:
            self._log = self._node.subscribe(_LOG, LogLine, self._on_line, Quality.LATCHED_EVERY)
            self._asked_at = now - _ASK_EVERY
        if not self._asking and now - self._asked_at >= _ASK_EVERY:
            self._asked_at, self._asking = now, True
            self._node.read_graph(self._on_graph)
        if self._publishers is None:
            return ""
        return explain_silence(self._publishers, connections, self._errors)

    def stop(self) -> None:
        """Forget everything: the topic carries messages again."""
        if self._log is not None:
            self._log.close()
            self._log, self._publishers, self._errors = None, None, {}

    def _on_line(self, line: LogLine) -> None:
        if line.level == "error":
            self._errors[line.node] = printable(line.text)

    def _on_graph(self, graph: Graph | None) -> None:
        self._asking = False
        if self._log is not None and graph is not None:
            topic = graph.topics.get(self._topic)
            self._publishers = topic.publishers if topic else ()


_WINDOW = 2.0  # s over which the rate is averaged
_SILENT = 3.0  # s after which the reason is determined
_PERIOD = 0.2  # s
_LOGGED_EVERY = 10.0  # s


@dataclass(frozen=True, slots=True)
class FeedView:
    """Pictures of a topic at one moment: the newest one, undecoded, and `number` of those that have arrived.

    `size` in pixels, `length` in bytes, `rate` in pictures a second; `silence` is the time in s since the last one, or
    since the start, and `reason` explains it after 3 s, as far as that is known.
    """

    topic: str
    picture: Picture | PackedPicture | None = None
    number: int = 0
    size: tuple[int, int] = (0, 0)
    length: int = 0
    rate: float = 0.0
    silence: float = 0.0
    publishers: int = 0
    reason: str = ""

    @property
    def silent(self) -> bool:
        """True when nothing has arrived for so long that the reason is shown."""
        return self.silence >= _SILENT


class PictureFeed:
    """Subscribes to `IMAGE/compressed` or `IMAGE`. `view` is replaced as a whole: any thread may read it."""

    def __init__(self, node: Node, image: str, *, packed: bool = True) -> None:
        kind: type[Picture | PackedPicture] = PackedPicture if packed else Picture
        topic = node.resolve(image) + ("/compressed" if packed else "")
        self._node = node
        self._times: deque[float] = deque(maxlen=400)
        self._began = node.steady()
        self._silence = SilenceMonitor(node, topic)
        self._newest: tuple[Picture | PackedPicture | None, tuple[int, int]] = (None, (0, 0))
        self._number = 0
        self.view = FeedView(topic)
        self._subscription = node.subscribe(topic, kind, self._on_picture)
        node.every(_PERIOD, self._update, steady=True)

    def _on_picture(self, picture: Picture | PackedPicture) -> None:
        try:
            size = read_size(picture.data) if isinstance(picture, PackedPicture) else (picture.width, picture.height)
        except BadPictureError as problem:
            self._node.log.warn(f"{self.view.topic}: {problem}", every=_LOGGED_EVERY)
            return
        self._newest = picture, size
        self._number += 1
        self._times.append(self._node.steady())
        self._update()

    def _update(self) -> None:
        now = self._node.steady()
        silence = now - (self._times[-1] if self._times else self._began)
        publishers, reason = self._subscription.publishers(), ""
        if silence >= _SILENT:
            reason = self._silence.explain(publishers)
        else:
            self._silence.stop()
        picture, size = self._newest
        length = len(picture.data) if picture else 0
        self.view = FeedView(
            self.view.topic, picture, self._number, size, length, self._rate(now), silence, publishers, reason
        )

    def _rate(self, now: float) -> float:
        """Pictures a second of late; 0 when none has arrived lately."""
        recent = [time for time in self._times if now - time <= _WINDOW]
        if len(recent) < 2:
            return 0.0
        return (len(recent) - 1) / max(recent[-1] - recent[0], 1e-6)


def decode_view(view: FeedView, smallest: tuple[int, int] | None = None) -> Pixels | None:
    """Decode the newest picture, see `decode_picture`; None before the first. Raises BadPictureError."""
    picture = view.picture
    if picture is None:
        return None
    if isinstance(picture, PackedPicture):
        return decode_picture(picture.data, smallest)
    return unpack_picture(picture.data, picture.width, picture.height, picture.step, picture.encoding)
