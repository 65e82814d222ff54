"""Long recordings: files that are split and complete, the disk guard, and the choice of topics."""

import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.recordings.mcap_file import open_recording
from ur.source.diagnostic import UserError
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.graph import Graph, Topic
from ur_nodes.ports.raw import RecordedMessage, RecordedType
from ur_nodes.recorder.topic_recording import NearlyFullError, RecordNode, SplitSettings, SplitWriter, choose_topics

STRING = "std_msgs/String"
WORDS = RecordedType("/words", STRING, "string data\n")
SECOND = 10**9


def words(first: int, last: int) -> list[RecordedMessage]:
    return [RecordedMessage(WORDS, number * SECOND, b"%d" % number) for number in range(first, last)]


def numbers_in(path: Path) -> list[int]:
    return [int(each.data) for each in open_recording(path).messages()]


def test_files_are_split_by_time_and_complete(tmp_path: Path) -> None:
    writer = SplitWriter(SplitSettings(tmp_path, seconds=9.5, free=0))
    writer.write(words(0, 15), SECOND)
    assert [numbers_in(path) for path in writer.finished] == [list(range(10))]
    (unfinished,) = tmp_path.glob("*.part")
    writer.write(words(15, 25), SECOND)
    writer.finish()
    assert [numbers_in(path) for path in writer.finished] == [[*range(10)], [*range(10, 20)], [*range(20, 25)]]
    assert not unfinished.exists()
    assert {path.stat().st_mode & 0o777 for path in tmp_path.iterdir()} == {0o600}
    assert open_recording(writer.finished[0]).start == SECOND


def test_files_are_split_by_size(tmp_path: Path) -> None:
    writer = SplitWriter(SplitSettings(tmp_path, bytes=300_000, free=0))
    noise = bytes((number * 7919) % 251 for number in range(50_000))
    for number in range(40):
        data = bytes(each ^ number for each in noise[number:]) + number.to_bytes(4, "big") * 500
        writer.write([RecordedMessage(WORDS, number * SECOND, data)], 0)
    writer.finish()
    total = sum(len(list(open_recording(path).messages())) for path in writer.finished)
    assert total == 40


def test_recording_ends_complete_before_the_disk_is_full(tmp_path: Path) -> None:
    space = [1_000]
    writer = SplitWriter(SplitSettings(tmp_path, free=500), lambda _folder: space[0])
    writer.write(words(0, 5), 0)
    space[0] = 400
    with pytest.raises(NearlyFullError, match="0 MB are free"):
        writer.write(words(5, 9), 0)
    assert [numbers_in(path) for path in writer.finished] == [list(range(5))]
    assert list(tmp_path.glob("*.part")) == []


FULL = """
import os, resource, signal, sys
from pathlib import Path
from ur_nodes.ports.raw import RecordedMessage, RecordedType
from ur_nodes.recorder.topic_recording import SplitSettings, SplitWriter
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, 400_000))
writer = SplitWriter(SplitSettings(Path(sys.argv[1]), free=0, seconds=3.5))
words = RecordedType("/words", "std_msgs/String", "string data\\n")
for number in range(100):
    size = 1000 if number < 8 else 150_000
    try:
        writer.write([RecordedMessage(words, number * 10**9, number.to_bytes(4, "little") + os.urandom(size))], 0)
    except OSError as problem:
        sys.exit(f"{number}: {problem.strerror}")
"""


def test_disk_that_is_full_ends_the_recording_and_leaves_what_was_complete(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-I", "-c", FULL, str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert done.stderr.rstrip().endswith(": File too large")
    last = int(done.stderr.split(":")[0])
    complete = [open_recording(path) for path in sorted(tmp_path.glob("*.mcap"))]
    assert all(each.complete for each in complete)
    (part,) = tmp_path.glob("*.part")
    unfinished = open_recording(part)
    assert not unfinished.complete
    numbers = [int.from_bytes(each.data[:4], "little") for file in [*complete, unfinished] for each in file.messages()]
    assert numbers == list(range(len(numbers)))
    assert last - 3 <= len(numbers) <= last


@given(st.integers(0, 3000))
def test_power_cut_loses_no_complete_chunk(tmp_path_factory: pytest.TempPathFactory, kept: int) -> None:
    folder = tmp_path_factory.mktemp("cut")
    writer = SplitWriter(SplitSettings(folder, free=0), chunk_bytes=100)
    writer.write(words(0, 100), 0)
    (part,) = folder.glob("*.part")
    data = part.read_bytes()
    part.write_bytes(data[:kept] + bytes(50))  # what a file system fills with zeros
    try:
        numbers = numbers_in(part)
    except UserError:
        numbers = []
    assert numbers == list(range(len(numbers)))
    whole = data[:kept].count(b"\x28\xb5\x2f\xfd")  # the begins of compressed chunks
    assert len(numbers) >= whole - 1  # each of them has a message


def test_power_cut_loses_only_what_came_after_the_last_sync(tmp_path: Path) -> None:
    writer = SplitWriter(SplitSettings(tmp_path, free=0, sync=0.0))
    writer.write(words(0, 3), 0)
    (part,) = tmp_path.glob("*.part")
    assert numbers_in(part) == [0, 1, 2]
    writer.write([], 0)
    writer.write(words(3, 5), 0)
    assert numbers_in(part) == [0, 1, 2, 3, 4]


def test_clock_that_jumps_does_not_move_messages(tmp_path: Path) -> None:
    clock = [10**18]
    bus, node = record_on_a_bus(tmp_path, unix=lambda: clock[0], topics="/words")
    bus.run(4.0)
    clock[0] -= 3600 * SECOND
    bus.run(4.0)
    node.end("test")
    bus.run(1.0)
    (path,) = tmp_path.iterdir()
    times = [each.time for each in open_recording(path).messages()]
    assert {after - before for before, after in pairwise(times)} == {SECOND // 10}


def test_topic_that_changes_its_type_is_recorded_with_both(tmp_path: Path) -> None:
    numbers = RecordedType("/words", "std_msgs/Int32", "int32 data\n")
    writer = SplitWriter(SplitSettings(tmp_path, free=0))
    writer.write([*words(0, 3), RecordedMessage(numbers, 5 * SECOND, b"\1\0\0\0")], 0)
    writer.finish()
    recording = open_recording(writer.finished[0])
    assert [each.topic.type_name for each in recording.messages()] == [STRING] * 3 + ["std_msgs/Int32"]
    assert recording.topics["/words"].count == 4


def record_on_a_bus(
    folder: Path, unix: Callable[[], int] | None = None, **parameters: object
) -> tuple[Bus, MemoryNode]:
    bus = Bus()
    bus.schemas[STRING] = "string data\n"
    for name, value in {"folder": str(folder), "free_megabytes": 10.0, **parameters}.items():
        bus.parameters[f"/record/{name}"] = value
    robot = bus.node("robot")
    for topic in ("words", "numbers"):
        publisher = robot.raw.publish(topic, STRING)
        robot.every(0.1, lambda publisher=publisher: publisher.send(b"7"))  # type: ignore[misc]
    node = bus.node("record")
    RecordNode(node, lambda: bus.now, unix or (lambda: bus.now + 10**18))
    return bus, node


def test_node_records_what_is_asked_for_until_its_end(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bus, node = record_on_a_bus(tmp_path, topics="/wor*")
    bus.run(6.0)
    node.end("test")
    bus.run(1.0)
    (path,) = tmp_path.iterdir()
    recording = open_recording(path)
    assert set(recording.topics) == {"/words"}
    assert recording.topics["/words"].count > 40
    assert recording.start >= 10**18
    assert f"wrote {path}" in capsys.readouterr().out


def test_disk_that_is_too_slow_costs_large_messages_alone(tmp_path: Path) -> None:
    bus, node = record_on_a_bus(tmp_path, topics="/words /clouds")
    lidar = bus.node("lidar")
    clouds = lidar.raw.publish("clouds", STRING)
    lidar.every(0.005, lambda: clouds.send(bytes(1_000_000)))
    bus.run(4.0)
    node.end("test")
    bus.run(1.0)
    (path,) = tmp_path.iterdir()
    topics = open_recording(path).topics
    assert topics["/words"].count > 20
    assert 0 < topics["/clouds"].count < 300
    assert "messages left out: /clouds" in node.lines[0][1]
    assert not any("/words" in text for _, text in node.lines)


def test_node_ends_when_nothing_can_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    bus, node = record_on_a_bus(tmp_path / "file/below")
    bus.run(3.0)
    assert node.ended is not None
    assert "the recording ends" in node.ended


def test_patterns_choose_topics_with_every_message() -> None:
    topics = {
        name: Topic(name, kind, ("/robot",), ())
        for name, kind in {"/scan": "sensor_msgs/LaserScan", "/camera/image": "sensor_msgs/Image"}.items()
    }
    graph = Graph(topics)
    assert [each.name for each in choose_topics(graph, ["/camera/*"])] == ["/camera/image"]
    assert [(each.name, each.period) for each in choose_topics(graph, ())] == [("/scan", 0.0)]


def test_pictures_that_somebody_sees_are_recorded_unless_they_are_left_out() -> None:
    topics = {"/eye": Topic("/eye", "sensor_msgs/Image", ("/robot",), ("/viewer",))}
    assert [each.name for each in choose_topics(Graph(topics), ())] == ["/eye"]
    assert choose_topics(Graph(topics), (), pictures=False) == ()
