"""The recorder of ROS 1 with publishers that speak its protocol on real sockets."""

from __future__ import annotations

import queue
import socket
import struct
import threading
import time
from collections.abc import Iterator, Sequence

import pytest
import rosgraph.network

from ur_nodes.loop import Loop
from ur_nodes.ports.raw import RecordedMessage, RecordedTopic
from ur_nodes.ros1.recorder.receiver import TopicConnectionError, connect_topic, read_stamp
from ur_nodes.ros1.recorder.recorder import RosRecorder

LIMIT = 60.0


class Publisher:
    """Publishes one topic: each connection is in `connections` once its header is answered."""

    def __init__(self, **header: str) -> None:
        self.header = {"type": "std_msgs/String", "message_definition": "string data\n", **header}
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address: tuple[str, int] = self.listener.getsockname()
        self.connections: queue.Queue[tuple[socket.socket, dict[str, str]]] = queue.Queue()
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        while True:
            try:
                sock, _ = self.listener.accept()
            except OSError:
                return
            (size,) = struct.unpack("<I", sock.recv(4, socket.MSG_WAITALL))
            asked = rosgraph.network.decode_ros_handshake_header(
                struct.pack("<I", size) + sock.recv(size, socket.MSG_WAITALL)
            )
            sock.sendall(rosgraph.network.encode_ros_handshake_header(self.header))
            self.connections.put((sock, asked))

    def stop(self) -> None:
        self.listener.shutdown(socket.SHUT_RDWR)  # wakes the thread; otherwise it would accept one more
        self.listener.close()

    def connection(self) -> socket.socket:
        return self.connections.get(timeout=LIMIT)[0]


def send(sock: socket.socket, *texts: bytes) -> None:
    sock.sendall(b"".join(struct.pack("<I", len(each)) + each for each in texts))


class RecorderSession:
    """A recorder, what it has taken, and publishers by the names of their nodes."""

    def __init__(self) -> None:
        self.loop = Loop(time.monotonic, steady=True)
        self.loop.start()
        self.taken: queue.Queue[RecordedMessage] = queue.Queue()
        self.publishers: dict[str, Publisher] = {}
        self.searches: list[str] = []
        self.recorder = RosRecorder(self.loop, "/box", self.take, time.monotonic_ns, self.find)

    def find(self, _caller: str, node: str, _topic: str) -> tuple[str, int]:
        self.searches.append(node)
        if node not in self.publishers:
            raise TopicConnectionError(f"{node}: unknown")
        return self.publishers[node].address

    def take(self, batch: Sequence[RecordedMessage]) -> None:
        for each in batch:
            self.taken.put(each)

    def record(self, *topics: RecordedTopic) -> None:
        self.loop.ask(lambda: self.recorder.record(topics), LIMIT)

    def next(self) -> bytes:
        return self.taken.get(timeout=LIMIT).data


@pytest.fixture
def session() -> Iterator[RecorderSession]:
    session = RecorderSession()
    yield session
    session.recorder.close()
    for each in session.publishers.values():
        each.stop()
    session.loop.end(lambda: None, LIMIT)


TOPIC = RecordedTopic("/words", ("/robot",))


def test_all_messages_of_a_topic_are_taken_in_order(session: RecorderSession) -> None:
    session.publishers["/robot"] = publisher = Publisher()
    session.record(TOPIC)
    sock, asked = publisher.connections.get(timeout=LIMIT)
    assert asked["callerid"] == "/box_recorder"
    assert (asked["topic"], asked["type"]) == ("/words", "*")
    before = time.monotonic_ns()
    send(sock, b"one", b"two")
    first = session.taken.get(timeout=LIMIT)
    assert (first.type.topic, first.type.type_name, first.type.schema) == ("/words", "std_msgs/String", "string data\n")
    assert before - 10_000_000 < first.time < time.monotonic_ns()
    assert first.data == b"one"
    send(sock, b"three")
    assert [session.next(), session.next()] == [b"two", b"three"]


def test_topic_with_a_period_is_connected_for_one_message(session: RecorderSession) -> None:
    session.publishers["/robot"] = publisher = Publisher()
    topic = RecordedTopic("/words", ("/robot",), 0.001)
    for number in range(3):
        session.record(topic)
        while publisher.connections.empty():
            session.record(topic)
        sock = publisher.connection()
        send(sock, b"%d" % number, b"more")
        assert session.next() == b"%d" % number
        with pytest.raises(ConnectionResetError):
            sock.recv(1)
    assert session.searches == ["/robot"]
    assert session.taken.empty()


def test_latched_topic_is_not_asked_for_again_and_again(session: RecorderSession) -> None:
    session.publishers["/robot"] = publisher = Publisher(latching="1")
    topic = RecordedTopic("/words", ("/robot",), 0.001)
    session.record(topic)
    sock = publisher.connection()
    send(sock, b"latched")
    assert session.next() == b"latched"
    session.record(topic)
    send(sock, b"newer")
    assert session.next() == b"newer"


def test_publisher_that_was_started_again_is_found(session: RecorderSession) -> None:
    session.publishers["/robot"] = first = Publisher()
    session.record(TOPIC)
    sock = first.connection()
    first.stop()
    session.publishers["/robot"] = second = Publisher()
    sock.close()
    while second.connections.empty():
        session.record(TOPIC)
    send(second.connection(), b"again")
    assert session.next() == b"again"


def test_topic_that_is_no_longer_wanted_ends(session: RecorderSession) -> None:
    session.publishers["/robot"] = publisher = Publisher()
    session.record(TOPIC)
    sock = publisher.connection()
    send(sock, b"one")
    session.next()
    session.record()
    with pytest.raises(ConnectionResetError):
        sock.recv(1)


def test_node_that_cannot_be_reached_is_tried_again_later(session: RecorderSession) -> None:
    session.record(TOPIC)
    while not session.searches:
        session.loop.ask(lambda: None, LIMIT)
    session.record(TOPIC)
    assert session.searches == ["/robot"]


@pytest.mark.parametrize(
    ("header", "text"), [({"error": "no such topic"}, "no such topic"), ({"type": ""}, "without a type")]
)
def test_publisher_that_refuses_is_named(header: dict[str, str], text: str) -> None:
    publisher = Publisher(**header)
    if not publisher.header["type"]:
        del publisher.header["type"]
    with pytest.raises(TopicConnectionError, match=text):
        connect_topic("/box", publisher.address, "/words")
    publisher.stop()


def test_address_without_a_publisher_is_a_problem() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        address = listener.getsockname()
    with pytest.raises(TopicConnectionError, match="refused"):
        connect_topic("/box", address, "/words")


def test_time_of_the_kernel_is_optional() -> None:
    assert read_stamp([]) is None
    assert read_stamp([(socket.SOL_SOCKET, 35, struct.pack("=qq", 2, 5))]) == 2_000_000_005
