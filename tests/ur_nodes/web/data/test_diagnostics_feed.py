"""Diagnostics of a page, on a bus."""

import json
import struct

from ur.web.wire.data_requests import unpack_frame
from ur_nodes.memory.bus import Bus
from ur_nodes.web.data.diagnostics import KIND, StatusFeed

SCHEMA = """Header header
DiagnosticStatus[] status
================================================================================
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
================================================================================
MSG: diagnostic_msgs/DiagnosticStatus
byte level
string name
string message
string hardware_id
KeyValue[] values
================================================================================
MSG: diagnostic_msgs/KeyValue
string key
string value
"""


def text(word: str) -> bytes:
    return struct.pack("<I", len(word)) + word.encode()


def diagnosis(level: int, name: str) -> bytes:
    header = struct.pack("<III", 0, 0, 0) + text("")
    return header + struct.pack("<IB", 1, level) + text(name) + text("hot") + text("") + struct.pack("<I", 0)


def test_diagnostics_are_heard_while_a_page_shows_them() -> None:
    bus = Bus()
    bus.schemas[KIND] = SCHEMA
    frames: list[bytes] = []
    node, driver = bus.node("web"), bus.node("driver")
    feed = StatusFeed(node, frames.append)
    shown: list[int] = []
    node.every(0.05, lambda: feed.step(shown))
    publisher = driver.raw.publish("/diagnostics", KIND)
    bus.run(1.0)
    assert publisher.subscribers() == 0
    shown.append(4)
    bus.run(0.5)
    publisher.send(diagnosis(2, "motors"))
    publisher.send(b"no message")
    bus.run(2.0)
    first, second = (json.loads(unpack_frame(each).body) for each in frames)
    assert first == {"t": "status", "components": []}
    (component,) = second["components"]
    assert (component["name"], component["level"], component["text"]) == ("motors", "error", "hot")
    assert [level for level, line in node.lines if "/diagnostics: message of 10 bytes" in line] == ["warn"]
    shown.clear()
    bus.run(1.0)
    assert publisher.subscribers() == 0


def test_page_that_is_new_gets_the_state_at_once() -> None:
    bus = Bus()
    frames: list[bytes] = []
    feed = StatusFeed(bus.node("web"), frames.append)
    feed.step([1])
    bus.run(0.1)
    feed.step([1, 2])
    bus.run(0.1)
    assert [unpack_frame(each).page for each in frames] == [1, 1, 2]
