"""Recordings on the disk, read back with the library that viewers use."""

import mmap
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from mcap.reader import make_reader

from ur.recordings.mcap_file import open_recording
from ur_nodes.black_box.guard import GuardedMemory
from ur_nodes.black_box.history import HistoryEvent, HistoryMessage, HistoryTopic, MessageHistory, Ring, copy_ring
from ur_nodes.black_box.recording_file import RecordingError, list_recordings, write_recording

SCAN = HistoryTopic("/scan", "sensor_msgs/LaserScan", "float32[] ranges")
ODOM = HistoryTopic("/odom", "nav_msgs/msg/Odometry", "string child_frame_id")
TAPE = (HistoryMessage(SCAN, 10, b"one"), HistoryEvent(15, "bumper left was touched"), HistoryMessage(SCAN, 20, b"two"))


def test_recording_is_an_mcap_file_with_messages_and_reasons(tmp_path: Path) -> None:
    path = write_recording(tmp_path, TAPE, ["bumper left was touched"], 1_000_000_000, 3)
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        header = reader.get_header()
        assert header.profile == "ros1"
        found = [
            (channel.topic, channel.message_encoding, schema.name, schema.encoding, message.log_time, message.data)
            for schema, channel, message in reader.iter_messages()
            if schema is not None
        ]
        metadata = {each.name: each.metadata for each in reader.iter_metadata()}
    assert found == [
        ("/scan", "ros1", "sensor_msgs/LaserScan", "ros1msg", 1_000_000_010, b"one"),
        ("/scan", "ros1", "sensor_msgs/LaserScan", "ros1msg", 1_000_000_020, b"two"),
    ]
    assert metadata == {
        "reasons": {"1": "bumper left was touched"},
        "events": {"1.000": "bumper left was touched"},
    }
    assert path.stat().st_mode & 0o777 == 0o600


def test_messages_of_ros2_are_cdr(tmp_path: Path) -> None:
    path = write_recording(tmp_path, [HistoryMessage(ODOM, 1, b"\0\1\0\0")], [], 0, 3)
    with path.open("rb") as file:
        (found,) = make_reader(file).iter_messages()
    assert found[0] is not None
    assert (found[0].encoding, found[1].message_encoding) == ("ros2msg", "cdr")


def test_newest_recordings_are_kept(tmp_path: Path) -> None:
    written = [write_recording(tmp_path, TAPE, [], 0, 3) for _ in range(5)]
    assert list_recordings(tmp_path) == sorted(written)[-3:]
    assert len(list(tmp_path.iterdir())) == 3


def full_disk() -> Iterator[HistoryMessage]:
    yield HistoryMessage(SCAN, 10, b"one")
    raise OSError(28, "No space left on device")


def test_full_disk_is_reported_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="10 MB are free, expected 200 MB"):
        write_recording(tmp_path, TAPE, [], 0, 3, free=10_000_000)
    with pytest.raises(RecordingError, match="no space left on device"):
        write_recording(tmp_path, full_disk(), [], 0, 3)
    assert list(tmp_path.iterdir()) == []


KILLED = """
import os, signal, sys
from pathlib import Path
from ur_nodes.black_box.guard import GuardedMemory
from ur_nodes.black_box.history import Ring
from ur_nodes.black_box.history import MessageHistory, HistoryTopic
memory = GuardedMemory(1_000_000, Path(sys.argv[1]), 3)
history = MessageHistory(Ring(memoryview(memory.block)))
for number in range(1000):
    history.note(HistoryTopic("/scan", "sensor_msgs/LaserScan", "float32[] ranges"), number, b"%d" % number)
sys.stdout.write(str(memory.guard.pid))
sys.stdout.flush()
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_guard_writes_all_messages_of_a_process_that_was_killed(tmp_path: Path) -> None:
    with subprocess.Popen(
        [sys.executable, "-I", "-c", KILLED, str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        output, _ = process.communicate(timeout=60)  # until the guard has closed its end, too
    assert process.returncode == -signal.SIGKILL
    (path,) = list_recordings(tmp_path)
    assert str(path) in output.decode()
    with path.open("rb") as file:
        assert [each.data for _, _, each in make_reader(file).iter_messages()] == [b"%d" % n for n in range(1000)]


def test_guard_that_is_ended_writes_nothing(tmp_path: Path) -> None:
    memory = GuardedMemory(100_000, tmp_path, 3)
    MessageHistory(Ring(memoryview(memory.block))).note(SCAN, 1, b"one")
    memory.end()
    assert memory.guard.returncode == 0
    assert list_recordings(tmp_path) == []


def test_file_is_written_by_a_process_of_its_own(tmp_path: Path) -> None:
    memory = GuardedMemory(100_000, tmp_path / "folder", 3)
    history = MessageHistory(Ring(memoryview(memory.block)))
    history.note(SCAN, 1, b"one")
    path = memory.write(["bumper left was touched", "/camera died"])
    history.note(SCAN, 2, b"two")
    assert list_recordings(tmp_path / "folder") == [Path(path)]
    recording = open_recording(Path(path))
    assert [each.data for each in recording.messages()] == [b"one"]
    assert list(recording.metadata["reasons"].values()) == ["bumper left was touched", "/camera died"]
    shutil.rmtree(tmp_path / "folder")
    (tmp_path / "folder").write_text("")
    with pytest.raises(RecordingError, match="file exists"):
        memory.write(["bumper left was touched"])
    memory.end()
    assert memory.guard.returncode == 0


def test_copy_of_a_ring_is_whole_while_a_process_appends_to_it() -> None:
    block = mmap.mmap(-1, 100_000)
    ring = Ring(memoryview(block))
    appended = threading.Event()

    def append() -> None:
        for number in range(40_000):
            record = b"%d" % number * (1 + number % 50)
            while ring.free < len(record) + 4:
                ring.drop()
            ring.append(record)
            if number == 1000:
                appended.set()

    writer = threading.Thread(target=append)
    writer.start()
    appended.wait()
    while writer.is_alive():
        numbers = [find_number(each) for each in copy_ring(block).records()]
        assert all(after == before + 1 for before, after in pairwise(numbers))
    writer.join()


def find_number(record: bytes) -> int:
    """The number of which a record is repetitions, as many as the number asks for."""
    for digits in range(1, 6):
        number = int(record[:digits])
        if record == b"%d" % number * (1 + number % 50):
            return number
    raise AssertionError(record)
