"""What a node lacks to be up: decided from what the master and publishers say."""

import socket
import struct
import threading
from collections import deque
from collections.abc import Collection

import pytest

from ur.launchfile.plan.specs import ReadyCondition
from ur.run.master.tcpros import NoTopic, TopicConnection, read_frames
from ur.run.middleware.protocol import ReceivedMessages, RunGraph
from ur.run.startup.readiness import check_clock, find_missing, measure_rate

GRAPH = RunGraph(
    {"/chat": ["/talker"], "/act/status": ["/server"], "/lonely/status": ["/server"]},
    {"/act/goal": ["/server"]},
    {"/talker/get_loggers": ["/talker"]},
)


def missing(
    *conditions: ReadyCondition, node: str = "/talker", received: dict[str, ReceivedMessages] | None = None
) -> tuple[str, ...]:
    return find_missing(node, conditions, GRAPH, received or {}, now=10.0)


def times(rate: float, count: int, end: float = 10.0) -> ReceivedMessages:
    return ReceivedMessages(deque(end - number / rate for number in reversed(range(count))))


def test_registered_node_without_conditions_is_up() -> None:
    assert missing() == ()
    assert missing(node="/unknown") == ("it runs, but is not registered yet",)
    assert missing(ReadyCondition("process", ""), node="/unknown") == ()


@pytest.mark.parametrize(
    ("condition", "unmet"),
    [
        (ReadyCondition("topic", "/chat"), ""),
        (ReadyCondition("topic", "/none"), "topic /none is not published"),
        (ReadyCondition("service", "/talker/get_loggers"), ""),
        (ReadyCondition("service", "/none"), "service /none is not offered"),
        (ReadyCondition("action", "/act"), ""),
        (ReadyCondition("action", "/lonely"), "action /lonely has no server"),
        (ReadyCondition("frame", "map"), "tf frame map is not there, only: none at all"),
        (ReadyCondition("topic", "/chat", 5.0), "topic /chat is published by /talker, but no message has come"),
    ],
)
def test_conditions_name_what_is_not_there(condition: ReadyCondition, unmet: str) -> None:
    assert missing(condition) == ((unmet,) if unmet else ())


def test_rate_is_reached_or_told() -> None:
    condition = ReadyCondition("topic", "/chat", 10.0)
    assert missing(condition, received={"/chat": times(10.0, 20)}) == ()
    assert missing(condition, received={"/chat": times(4.0, 20)}) == (
        "topic /chat comes too slowly: 4.0 Hz, expected 10 Hz",
    )
    assert missing(condition, received={"/chat": times(10.0, 2)}) == (
        "topic /chat comes too slowly: 2 messages so far, expected 10 Hz",
    )


def test_rate_of_a_topic_that_no_longer_comes_is_unknown() -> None:
    received = times(10.0, 20)
    assert measure_rate(tuple(received.times), 10.0, 10.1) == pytest.approx(10.0)
    assert measure_rate(tuple(received.times), 10.0, 20.0) is None


def test_frames_come_from_both_tf_topics() -> None:
    received = {"/tf": ReceivedMessages(frames={"odom"}), "/tf_static": ReceivedMessages(frames={"laser"})}
    assert missing(ReadyCondition("frame", "odom"), ReadyCondition("frame", "laser"), received=received) == ()
    assert missing(ReadyCondition("frame", "map"), received=received) == (
        "tf frame map is not there, only: laser, odom",
    )


def test_frames_are_read_from_messages_and_broken_ones_are_harmless() -> None:
    def transform(parent: bytes, child: bytes) -> bytes:
        head = struct.pack("<III", 1, 2, 3)
        return head + b"".join(struct.pack("<I", len(name)) + name for name in (parent, child)) + bytes(56)

    message = struct.pack("<I", 2) + transform(b"/map", b"odom") + transform(b"odom", b"base_link")
    assert read_frames(message) == {"map", "odom", "base_link"}
    assert "map" in read_frames(message[:60])
    assert read_frames(b"") == set()


def test_listener_takes_messages_in_any_pieces_and_keeps_only_their_beginning() -> None:
    ours, theirs = socket.socketpair()
    listener = TopicConnection(ours, keep=3)
    stream = b"".join(struct.pack("<I", len(body)) + body for body in (b"header", b"abcdef", b"", b"xy" * 40))
    got = []
    for index in range(len(stream)):
        theirs.send(stream[index : index + 1])
        got += listener.receive()
    assert got == [b"abc", b"", b"xyx"]
    theirs.close()
    with pytest.raises(NoTopic):
        listener.receive()
    listener.close()


def test_listener_reports_a_publisher_that_refuses() -> None:
    ours, theirs = socket.socketpair()
    listener = TopicConnection(ours, keep=3)
    header = struct.pack("<I", 8) + b"error=no"
    theirs.send(struct.pack("<I", len(header)) + header)
    with pytest.raises(NoTopic, match="no"):
        listener.receive()
    listener.close()
    theirs.close()


class OneLook:
    """A view that returns one graph, and records that it is no longer needed."""

    def __init__(self, *publishers: str) -> None:
        self.received: dict[str, ReceivedMessages] = {}
        self.forgotten = threading.Event()
        self._graph = RunGraph({topic: ["/node"] for topic in publishers}, {}, {})

    def look(self, topics: Collection[str]) -> RunGraph:
        assert not topics
        return self._graph

    def wait(self, seconds: float) -> None:
        raise AssertionError(seconds)

    def forget(self) -> None:
        self.forgotten.set()


@pytest.mark.parametrize(("publishers", "reports"), [((), 1), (("/scan",), 1), (("/scan", "/clock"), 0)])
def test_simulated_time_is_reported_where_no_node_publishes_it(publishers: tuple[str, ...], reports: int) -> None:
    view, lines = OneLook(*publishers), list[str]()
    check_clock(lambda: view, threading.Event(), lines.append, patience=0.0)
    assert view.forgotten.is_set()
    assert len(lines) == reports


def test_clock_that_a_view_finds_only_after_a_while_is_not_reported_as_missing() -> None:
    class LateView(OneLook):
        looks = 0

        def look(self, topics: Collection[str]) -> RunGraph:
            self.looks += 1
            return super().look(topics) if self.looks > 3 else RunGraph({}, {}, {})

    view, lines = LateView("/clock"), list[str]()
    check_clock(lambda: view, threading.Event(), lines.append, patience=0.0)
    assert view.forgotten.is_set()
    assert lines == []
