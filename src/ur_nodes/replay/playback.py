"""Playback of a recording: the messages that are due, with pause, speed and jumps, published with its clock."""

import os
import sys
from collections.abc import Callable, Iterator, Mapping, Set
from pathlib import Path

from ur.recordings.mcap_channels import Dialect
from ur.recordings.mcap_file import RecordingFile, RecordingTopic, StoredMessage, open_recording
from ur.recordings.message_types import MessageTypes
from ur.recordings.replays import (
    FASTEST,
    MOST_BYTES,
    SLOWEST,
    ReplayCommand,
    ReplayState,
    describe_state,
    read_command,
    sockets_folder,
)
from ur.source.diagnostic import user_error_about
from ur.source.foreign.json_values import write_json
from ur_nodes.datagram_socket import DatagramSocket
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import ros1_name
from ur_nodes.ports.values import ClockTime

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


_STEP = 0.01  # s
_SETTLE = 2.0  # s, in which subscribers connect before the first message
_STATUS_TYPES = ("actionlib_msgs/GoalStatusArray", "std_msgs/msg/String")  # of goals, on ROS 1 and ROS 2
_NOT_PLAYED = frozenset({"/rosout", "/rosout_agg", "/clock"})
_PRINT_EVERY = 10.0  # s
_WARN_EVERY = 60.0  # s
_CONTROL_EVERY = 0.05  # s


class ReplayNode:
    """Publishes the topics of a recording whose types are installed; the others are reported once."""

    def __init__(self, node: Node) -> None:
        self._node = node
        own = node.parameters
        path = own.text("recording", "")
        if not path:
            message = "without a recording, expected the path of an MCAP file"
            raise user_error_about("replay", message, rule="bad-recording", help="ur replay FILE")
        self._recording = recording = open_recording(Path(path).expanduser())
        speed = own.number("playback_speed", 1.0, minimum=SLOWEST, maximum=FASTEST)
        left_out = _NOT_PLAYED | set(own.texts("left_out", ()))
        self._types = MessageTypes() if node.raw.encoding else None
        self._played: dict[RecordingTopic, RecordingTopic] = {}
        publishers = {}
        kept = recording.kept_topics
        missing: dict[str, None] = {}
        for name, topic in recording.topics.items():
            if name in left_out or not (bool(topic.type_name) and topic.encoding in ("ros1", "cdr")):
                continue
            quality = Quality.LATCHED if name in kept else Quality.EVERY
            try:
                own_name = self._name_here(name, topic)
                publishers[name] = self._node.raw.publish(own_name, self._convert_topic(topic).type_name, quality)
            except LookupError:
                missing[topic.type_name] = None
        if missing:
            self._node.log.warn(f"not played, because their packages are not installed: {', '.join(missing)}")
        self._publishers = publishers
        self._clock = node.publish("/clock", ClockTime, Quality.NEWEST) if node.facts.simulated_time else None
        self._player = Player(recording, self._publishers.keys(), node.steady() + _SETTLE, speed=speed)
        self._printed = 0.0
        self._on_goals(recording)
        self._print(f"{path}: {recording.seconds:.1f} s, {len(self._publishers)} topics")
        start = own.number("playback_start", 0.0, minimum=0.0)
        node.after(_SETTLE, lambda: self._jump(start), steady=True)
        node.every(_STEP, self._step, steady=True)
        node.on_end(open_control_socket(node, os.environ, self._control).close)

    def _on_goals(self, recording: RecordingFile) -> None:
        # Clients wait for who takes their goals; here nothing does.
        for name, topic in recording.topics.items():
            action, _, part = name.rpartition("/")
            if part == "status" and topic.type_name in _STATUS_TYPES:
                for each in ("goal", "cancel"):
                    self._node.raw.subscribe(self._name_here(f"{action}/{each}", topic), lambda _message: None)

    def _name_here(self, name: str, topic: RecordingTopic) -> str:
        """Return a name as the ROS that runs has it; on ROS 2, the node itself converts names of ROS 1."""
        return ros1_name(name) if (topic.encoding, self._node.raw.encoding) == ("cdr", "ros1") else name

    def _print(self, text: str) -> None:
        sys.stdout.write(f"{text}\n")
        sys.stdout.flush()

    def _convert_topic(self, topic: RecordingTopic) -> RecordingTopic:
        """Return a topic as the ROS that runs has it."""
        made = self._played.get(topic)
        if made is None:
            dialect: Dialect = "ros2" if self._node.raw.encoding == "cdr" else "ros1"
            made = topic if self._types is None else self._types.convert_topic(topic, dialect)
            self._played[topic] = made
        return made

    def _send(self, message: StoredMessage) -> None:
        topic, data = message.topic, message.data
        made = self._convert_topic(topic)
        kind = self._convert_topic(self._recording.topics[topic.name])
        if made.type_name != kind.type_name:
            text = f"{topic.name} changes its type: messages of {made.type_name} are left out"
            self._node.log.warn(text, every=_WARN_EVERY)
            return
        try:
            if self._types is not None:
                data = self._types.convert(topic, made, data)
            self._publishers[topic.name].send(data)
        except ValueError as problem:
            self._node.log.warn(f"{message.topic.name}: a message is left out: {problem}")

    def _step(self) -> None:
        before = self._player.state
        self._player.step(self._node.steady(), self._send)
        if self._clock is not None:
            self._clock.send(ClockTime(self._player.time))
        state = self._player.state
        if state.ended and not before.ended:
            self._print(f"end of the recording, at {state.length:.1f} s; a key of 'ur replay' plays it again")
        elif state.position - self._printed >= _PRINT_EVERY or state.position < self._printed:
            self._printed = state.position - state.position % _PRINT_EVERY
            self._print(f"{state.position:.0f} of {state.length:.0f} s")

    def _jump(self, seconds: float) -> None:
        if seconds > 0.0 or self._player.state.position > 0.0:
            for message in self._player.jump(seconds):
                self._send(message)

    def _control(self, command: ReplayCommand) -> ReplayState:
        player = self._player
        if command.name == "state":
            return player.state
        if command.name == "pause":
            player.pause()
        elif command.name == "play":
            player.play()
        elif command.name == "speed":
            player.set_speed(command.value)
        elif command.name == "jump":
            self._jump(command.value)
        else:
            self._jump(max(0.0, player.state.position + command.value * (1 if command.name == "ahead" else -1)))
        self._print(describe_state(player.state))
        return player.state


def open_control_socket(
    node: Node, environment: Mapping[str, str], callback: Callable[[ReplayCommand], ReplayState]
) -> DatagramSocket:
    """Open the socket for commands of `ur replay`; `callback` gets each, and returns the state after it."""

    def on_datagram(data: bytes) -> bytes:
        command = read_command(data)
        return b"" if command is None else write_json(callback(command)).encode()

    without = "the keys of 'ur replay' have no effect"
    return DatagramSocket(node, sockets_folder(environment), _CONTROL_EVERY, MOST_BYTES, on_datagram, without)
