"""Long recordings: files that are split and complete, the disk guard, and the choice of topics."""

from __future__ import annotations

from pathlib import Path

import pytest

from ur.recordings.mcap_file import open_recording
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.graph import Graph, Topic
from ur_nodes.ports.raw import RecordedMessage, RecordedType
from ur_nodes.recorder.split_writer import NearlyFullError, SplitSettings, SplitWriter
from ur_nodes.recorder.topic_recording import RecordNode, choose_topics

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


def record_on_a_bus(folder: Path, **parameters: object) -> tuple[Bus, MemoryNode]:
    bus = Bus()
    bus.schemas[STRING] = "string data\n"
    for name, value in {"folder": str(folder), "free_megabytes": 10.0, **parameters}.items():
        bus.parameters[f"/record/{name}"] = value
    robot = bus.node("robot")
    for topic in ("words", "numbers"):
        publisher = robot.raw.publish(topic, STRING)
        robot.every(0.1, lambda publisher=publisher: publisher.send(b"7"))  # type: ignore[misc]
    node = bus.node("record")
    RecordNode(node, lambda: bus.now, lambda: bus.now + 10**18)
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
