"""A recording as it is played: the messages that are due, with pause, speed and jumps. It knows no middleware."""

from collections.abc import Callable, Iterator, Set

from ur.recordings.mcap_file import RecordingFile, StoredMessage
from ur.recordings.replays import FASTEST, SLOWEST, ReplayState

_MOST_AT_ONCE = 2000  # messages of one step at most; the next step continues


class Player:
    """Plays a recording against a clock in seconds that is never set, from `begin` on that clock.

    Times of messages are ns since 1970.
    """

    def __init__(self, recording: RecordingFile, topics: Set[str], begin: float, *, speed: float = 1.0) -> None:
        self._recording = recording
        self._topics = topics
        self._speed = min(max(speed, SLOWEST), FASTEST)
        self._playing = True
        self._kept = recording.kept_topics & topics
        self._waiting: Iterator[StoredMessage] = iter(())
        self._next: StoredMessage | None = None
        self.time = recording.start
        self._seen = begin
        self._begin(recording.start)

    @property
    def state(self) -> ReplayState:
        """The state of now."""
        position = (self.time - self._recording.start) / 1e9
        return ReplayState(position, self._recording.seconds, self._speed, self._playing, self._next is None)

    def pause(self) -> None:
        """Stay at the position of now."""
        self._playing = False

    def play(self) -> None:
        """Go on; from the start, where the end is reached."""
        if self._next is None:
            self._begin(self._recording.start)
        self._playing = True

    def set_speed(self, speed: float) -> None:
        """Play so many times as fast as it was recorded, within limits."""
        self._speed = min(max(speed, SLOWEST), FASTEST)

    def jump(self, seconds: float) -> list[StoredMessage]:
        """Go on at a position, counted from the start.

        Returns what subscribers need there: of each topic that keeps its newest message, such as a map, the one before
        it.
        """
        start, end = self._recording.start, self._recording.end
        time = min(max(start + int(seconds * 1e9), start), end)
        newest: dict[str, StoredMessage] = {}
        if self._kept:
            for message in self._recording.messages(topics=self._kept):
                if message.time >= time:
                    break
                newest[message.topic.name] = message
        self._begin(time)
        return list(newest.values())

    def step(self, now: float, send: Callable[[StoredMessage], None]) -> None:
        """Send the messages that are due at a time of the clock; none before the time at which it begins."""
        if now <= self._seen:
            return
        passed, self._seen = now - self._seen, now
        if not self._playing or self._next is None:
            return
        until = self.time + int(passed * 1e9 * self._speed)
        for _ in range(_MOST_AT_ONCE):
            if self._next is None or self._next.time > until:
                break
            self.time = max(self.time, self._next.time)
            send(self._next)
            self._next = next(self._waiting, None)
        else:
            return  # the rest is as late as the sending is slow
        self.time = min(until, self._recording.end) if self._next is None else until

    def _begin(self, time: int) -> None:
        self.time = time
        self._waiting = self._recording.messages(time, self._topics)
        self._next = next(self._waiting, None)
