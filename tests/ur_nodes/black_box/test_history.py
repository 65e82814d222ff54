"""Messages in a bounded ring, read back in order of time."""

import mmap
import os
from collections import deque

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur_nodes.black_box.history import (
    SECOND,
    HistoryEvent,
    HistoryMessage,
    HistoryTopic,
    MessageHistory,
    Ring,
    read_history,
)

SCAN = HistoryTopic("/scan", "sensor_msgs/LaserScan", "float32[] ranges")
MAP = HistoryTopic("/map", "nav_msgs/OccupancyGrid", "int8[] data")
IMAGE = HistoryTopic("/image", "sensor_msgs/Image", "uint8[] data")


def make_ring(size: int = 10_000) -> Ring:
    return Ring(memoryview(bytearray(size)))


def messages(ring: Ring, topic: HistoryTopic) -> list[tuple[int, bytes]]:
    return [
        (each.time, each.data)
        for each in read_history(ring)
        if isinstance(each, HistoryMessage) and each.topic == topic
    ]


@given(st.lists(st.binary(max_size=200), max_size=200))
def test_ring_holds_the_newest_records_that_fit(records: list[bytes]) -> None:
    block = bytearray(64 + 500)
    ring = Ring(memoryview(block))
    kept: deque[bytes] = deque()
    for record in records:
        while ring.free < len(record) + 4:
            assert ring.oldest() == kept.popleft()
            ring.drop()
        ring.append(record[:3], record[3:])
        kept.append(record)
    assert list(ring.records()) == list(kept)
    assert list(Ring(memoryview(block), kept=True).records()) == list(kept)


@given(st.lists(st.integers(1, 1_500_000), min_size=5, max_size=40), st.integers(1, 3_500_000))
@settings(max_examples=20, deadline=None)
def test_ring_gives_the_memory_of_dropped_records_back(sizes: list[int], most: int) -> None:
    memory = os.memfd_create("ring")
    os.ftruncate(memory, 5_000_000)
    try:
        with mmap.mmap(memory, 5_000_000) as block, memoryview(block) as view:
            ring, kept = Ring(view), deque[bytes]()
            for number, size in enumerate(sizes):
                record = bytes([number + 1]) * size
                while kept and (sum(map(len, kept)) > most or ring.free < size + 4):
                    kept.popleft()
                    ring.drop()
                ring.append(record)
                kept.append(record)
                assert list(ring.records()) == list(kept)
            whole = os.fstat(memory).st_blocks * 512
            assert whole <= sum(map(len, kept)) + 2 * max(sizes) + 3_200_000
            del ring
    finally:
        os.close(memory)


def test_block_without_a_ring_is_refused() -> None:
    with pytest.raises(ValueError, match="holds no ring"):
        Ring(memoryview(bytearray(1000)), kept=True)
    block = bytearray(1000)
    Ring(memoryview(block))
    block[24:32] = b"\xff" * 8
    with pytest.raises(ValueError, match="damaged"):
        Ring(memoryview(block), kept=True)


def test_messages_older_than_the_age_are_dropped_but_for_the_newest_of_a_topic() -> None:
    ring = make_ring(1_000_000)
    history = MessageHistory(ring, seconds=120.0)
    history.note(MAP, 5 * SECOND, b"map")
    for second in range(1000):
        history.note(SCAN, second * SECOND, b"scan")
    assert messages(ring, MAP) == [(879 * SECOND, b"map")]  # at the begin of the recording
    assert [time // SECOND for time, _ in messages(ring, SCAN)] == list(range(879, 1000))


def test_ring_stays_bounded_and_keeps_descriptions_of_topics() -> None:
    ring = make_ring(20_000)
    history = MessageHistory(ring)
    history.note(MAP, 0, b"m" * 1000)
    history.note_event(1, "the robot was pushed")
    for number in range(5000):
        history.note(SCAN, number, b"s" * (number % 300))
    assert [data for _, data in messages(ring, MAP)] == [b"m" * 1000]
    kept = messages(ring, SCAN)
    assert [time for time, _ in kept] == list(range(5000 - len(kept), 5000))
    assert len(kept) > 80
    assert all(data == b"s" * (time % 300) for time, data in kept)
    assert history.left_out == {}


def test_pictures_are_taken_once_a_second_and_what_is_too_large_is_counted() -> None:
    ring = make_ring(1_000_000)
    history = MessageHistory(ring)
    for number in range(100):
        history.note(IMAGE, number * SECOND // 10, b"picture")
        history.note(SCAN, number * SECOND // 10, b"s" * 30)
        history.note(MAP, number * SECOND // 10, b"m" * 210_000)
    assert [time for time, _ in messages(ring, MAP)] == [6 * SECOND, 7 * SECOND, 8 * SECOND, 9 * SECOND]
    assert len(messages(ring, IMAGE)) == 4
    assert 40 <= len(messages(ring, SCAN)) < 60
    history.note(MAP, 200 * SECOND, b"m" * 600_000)
    assert history.left_out == {"/map": 1}


def test_topic_that_changes_its_type_is_two() -> None:
    ring = make_ring()
    history = MessageHistory(ring)
    other = HistoryTopic("/scan", "std_msgs/String", "string data")
    history.note(SCAN, 1, b"scan")
    history.note(other, 2, b"text")
    assert messages(ring, SCAN) == [(1, b"scan")]
    assert messages(ring, other) == [(2, b"text")]


def test_events_are_read_with_their_time() -> None:
    ring = make_ring()
    history = MessageHistory(ring)
    history.note_event(7, "bumper left was touched")
    assert list(read_history(ring)) == [HistoryEvent(7, "bumper left was touched")]
