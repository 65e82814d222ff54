"""The newest picture of a topic, and how its pictures arrive or why none does."""

from collections import deque
from dataclasses import dataclass

from ur_nodes.pictures.decode import BadPictureError, Pixels, decode_picture, read_size, unpack_picture
from ur_nodes.pictures.silence import SilenceMonitor
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import PackedPicture, Picture

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
        self._subscription = node.subscribe(topic, kind, self._take)
        node.every(_PERIOD, self._update, steady=True)

    def _take(self, picture: Picture | PackedPicture) -> None:
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
