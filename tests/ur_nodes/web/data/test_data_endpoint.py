"""What pages show of topics, on a bus."""

import json
import socket
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import pytest

from ur.web.wire.data_requests import unpack_frame
from ur.web.wire.frames import LENGTH
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.web.data.data_endpoint import DataSession
from ur_nodes.web.server_link import Outlet

STRING, PICTURE = "std_msgs/String", "sensor_msgs/Image"
HELLO = b"\x05\x00\x00\x00hello"


class DataWorld:
    def __init__(self, ours: socket.socket, its: socket.socket) -> None:
        self.bus, self._ours = Bus(), ours
        self.bus.schemas.update({STRING: "string data\n", PICTURE: "uint8[] data\n"})
        self.other = self.bus.node("other")
        node = self.bus.node("web")
        self.end = DataSession(node, Outlet(node, its))

    def say(self, page: int, **request: Any) -> None:
        self.end.receive({"page": page, "m": json.dumps(request) if request else ""})

    def frames(self, seconds: float = 1.1) -> list[tuple[int, Any]]:
        """The pages and contents of the frames of the next seconds."""
        self.bus.run(seconds)
        data = b""
        with suppress(BlockingIOError):
            while True:
                data += self._ours.recv(1 << 20, socket.MSG_DONTWAIT)
        found = []
        while data:
            (length,) = LENGTH.unpack_from(data)
            frame = unpack_frame(data[LENGTH.size : LENGTH.size + length])
            found.append((frame.page, json.loads(frame.body)))
            data = data[LENGTH.size + length :]
        return found


@pytest.fixture
def world() -> Iterator[DataWorld]:
    ours, its = socket.socketpair()
    with ours, its:
        yield DataWorld(ours, its)


def test_topics_are_listed_with_the_rates_of_those_in_view(world: DataWorld) -> None:
    words = world.other.raw.publish("words", STRING)
    world.other.raw.publish("picture", PICTURE)
    assert world.frames() == [(0, {"t": "hello"})]
    world.say(7, t="show", topics=["/words", "/picture"])
    (page, first), *_ = world.frames()
    assert page == 7
    assert (first["t"], first["all"]) == ("topics", 2)
    assert [row[:4] for row in first["rows"]] == [["/picture", PICTURE, 1, 0], ["/words", STRING, 1, 0]]
    world.other.every(0.1, lambda: words.send(HELLO))
    world.frames(5.0)
    rows = world.frames()[-1][1]["rows"]
    assert rows[0] == ["/picture", PICTURE, 1, 0], "to measure a picture would make its camera work"
    assert rows[1][4:] == [pytest.approx(10.0, abs=0.5), pytest.approx(90.0, abs=5.0)]


def test_message_is_printed_once_each_time_it_is_sent(world: DataWorld) -> None:
    words = world.other.raw.publish("words", STRING, Quality.LATCHED)
    words.send(HELLO)
    world.say(7, t="show", echo="/words")
    found = [each for _, each in world.frames(2.0) if each["t"] == "echo"]
    assert found == [
        {"t": "echo", "topic": "/words", "kind": STRING, "size": 9, "count": 1, "lines": ['data: "hello"']}
    ]
    words.send(b"\xff\xff\xff\xff")
    (bad,) = [each for _, each in world.frames(2.0) if each["t"] == "echo"]
    assert bad["count"] == 2
    assert "ends within a field" in bad["problem"]


def test_page_that_has_left_gets_nothing_and_topics_are_left(world: DataWorld) -> None:
    words = world.other.raw.publish("words", STRING)
    world.say(7, t="show", topics=["/words"])
    world.frames(3.0)
    assert words.subscribers() == 1
    world.say(7)
    world.frames(3.0)
    assert words.subscribers() == 0
    assert world.frames() == []


def test_diagnostics_are_sent_while_it_is_shown(world: DataWorld) -> None:
    world.say(7, t="show", status=True)
    states = [each for page, each in world.frames(5.0) if page == 7]
    assert {each["t"] for each in states} == {"status"}
    assert len(states) == 3
    assert states[-1]["components"] == []


def test_answer_has_the_number_of_its_request(world: DataWorld) -> None:
    world.bus.parameters["/robot_description"] = "<robot name='r'/>"
    world.say(7, t="model", id=3)
    assert (7, {"t": "answer", "id": 3, "ok": True, "text": "", "value": []}) in world.frames()


def test_requests_without_an_answer_are_limited(world: DataWorld) -> None:
    for number in range(6):
        world.say(7, t="model", id=number)
    answers = [each for _, each in world.frames() if each["t"] == "answer"]
    assert [each["id"] for each in answers if "expected them first" in each["text"]] == [4, 5]


def test_malformed_request_is_dropped(world: DataWorld) -> None:
    world.frames()
    world.say(7, t="nothing")
    assert world.frames() == []
