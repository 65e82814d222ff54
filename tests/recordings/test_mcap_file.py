"""Reading of recordings: complete ones, those whose writer was killed, and other files."""

import os
import random
import struct
import sys
from pathlib import Path

import pytest
from mcap.reader import SeekingReader
from mcap.writer import CompressionType, Writer

from ur.recordings.mcap_file import describe_recording, open_recording
from ur.source.diagnostic import UserError

SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND


def write_recording(path: Path, seconds: int = 20, *, chunk: int = 200) -> Path:
    """A text ten times a second, and a map once, as the black box writes them."""
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=chunk)
        writer.start(profile="ros1", library="tests")
        schema = writer.register_schema("std_msgs/String", "ros1msg", b"string data\n")
        words = writer.register_channel("/words", "ros1", schema)
        plan = writer.register_channel("/map", "ros1", schema)
        writer.add_message(plan, BEGIN, b"map", BEGIN)
        for number in range(10 * seconds):
            time = BEGIN + number * SECOND // 10
            writer.add_message(words, time, b"%d" % number, time)
        writer.add_metadata("reasons", {"1": "/camera died"})
        writer.add_metadata("events", {f"{BEGIN / 1e9 + 3:.3f}": "a bumper was \x1b[31mtouched"})
        writer.finish()  # type: ignore[no-untyped-call]
    return path


def test_recording_is_read_from_any_time_on(tmp_path: Path) -> None:
    recording = open_recording(write_recording(tmp_path / "one.mcap"))
    assert recording.complete
    assert recording.seconds == pytest.approx(19.9)
    assert {name: topic.count for name, topic in recording.topics.items()} == {"/words": 200, "/map": 1}
    assert recording.topics["/words"].type_name == "std_msgs/String"
    late = list(recording.messages(BEGIN + 19 * SECOND))
    assert [int(each.data) for each in late] == list(range(190, 200))
    assert [each.data for each in recording.messages(topics={"/map"})] == [b"map"]


def test_recording_without_an_end_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    path = write_recording(tmp_path / "cut.mcap")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    recording = open_recording(path)
    assert not recording.complete
    numbers = [int(each.data) for each in recording.messages(topics={"/words"})]
    assert 20 < len(numbers) < 190
    assert numbers == list(range(len(numbers)))
    assert recording.topics["/words"].count == len(numbers)


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04", b"\x89MCAP0\r\n", b"\x89MCAP0\r\n" + b"\xff" * 500])
def test_other_files_are_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "other.mcap"
    path.write_bytes(data)
    with pytest.raises(UserError, match="not an MCAP file"):
        open_recording(path)


def test_missing_file_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no such file"):
        open_recording(tmp_path / "absent.mcap")


def test_description_lists_reasons_events_and_topics(tmp_path: Path) -> None:
    lines = list(describe_recording(open_recording(write_recording(tmp_path / "one.mcap"))))
    assert "19.9 s from 20" in lines[0]
    assert lines[1] == "  because: /camera died"
    assert lines[2].startswith("      3.0 s  a bumper was ")
    assert "\x1b" not in lines[2]
    assert lines[3:] == ["  /map         1 messages  std_msgs/String", "  /words     200 messages  std_msgs/String"]


def test_special_files_are_refused_and_never_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.mcap"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero"), tmp_path):
        with pytest.raises(UserError, match="not a regular file, expected a recording"):
            open_recording(path)


@pytest.mark.parametrize("name", ["zstd_bomb", "zstd_lie", "lz4_lie", "many_chunks"])
def test_chunks_that_unpack_to_more_than_they_declare_or_may_are_refused(name: str) -> None:
    path = Path(__file__).parents[1] / "fuzz/corpus/recording" / f"find-{name}"
    with pytest.raises(UserError, match="no message in it can be read"):
        open_recording(path)


@pytest.mark.parametrize("place", ["no summary", "summary", "metadata"])
def test_no_chunk_is_unpacked_for_what_a_recording_says_of_itself(place: str, tmp_path: Path) -> None:
    path = write_recording(tmp_path / "one.mcap")
    data = bytearray(path.read_bytes())
    with path.open("rb") as file:
        summary = SeekingReader(file).get_summary()
    assert summary is not None
    chunk = summary.chunk_indexes[0].chunk_start_offset
    if place == "metadata":
        metadata = struct.pack("<Q", summary.metadata_indexes[0].offset)
        struct.pack_into("<Q", data, data.rindex(metadata), chunk)
    else:
        struct.pack_into("<Q", data, len(data) - 28, chunk if place == "summary" else 0)
    path.write_bytes(data)
    called = set[str]()
    sys.setprofile(lambda frame, _event, _argument: called.add(frame.f_code.co_name))
    try:
        recording = open_recording(path)
    finally:
        sys.setprofile(None)
    assert "breakup_chunk" not in called  # the library's, which unpacks without a limit
    assert {*recording.topics} == {"/words", "/map"}
    assert len(list(recording.messages())) == 201


@pytest.mark.parametrize("compression", [*CompressionType])
def test_messages_of_chunks_that_overlap_are_in_the_order_of_their_times(
    compression: CompressionType, tmp_path: Path
) -> None:
    path = tmp_path / "late.mcap"
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=100, compression=compression)
        writer.start()
        topics = [writer.register_channel(f"/{name}", "text", 0) for name in "ab"]
        times = random.Random(1).sample(range(1, 1000), 300)
        for time in times:
            writer.add_message(topics[time % 2], time, b"%d" % time, time)
        writer.finish()  # type: ignore[no-untyped-call]
    recording = open_recording(path)
    assert [each.time for each in recording.messages()] == sorted(times)
    assert [each.time for each in recording.messages(500, {"/a"})] == sorted(
        t for t in times if t >= 500 and t % 2 == 0
    )
