"""The archive of a report: what it holds."""

import socket
import struct
import threading
import zipfile
from contextlib import suppress
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import SummaryOffset
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, Writer
from rosbags.typesys import Stores, get_typestore

from ur.report.archive import MOST_BYTES, list_run_recordings, write_report
from ur.report.sources import RunSources, collect, merge_logs, read_parameters
from ur.run.record.registry import EndedRun, RunEntry

START = 1_700_000_000_000_000_000
STORE = get_typestore(Stores.ROS1_NOETIC)


def odometry(x: float) -> bytes:
    position = struct.pack("<7d", x, 0.5 * x, 0.0, 0.0, 0.0, 0.0, 1.0) + bytes(36 * 8)
    header = struct.pack("<III", 0, 0, 0) + struct.pack("<I", 4) + b"odom" + struct.pack("<I", 4) + b"base"
    return header + position + struct.pack("<6d", 0.3, 0.0, 0.0, 0.0, 0.0, 0.1) + bytes(36 * 8)


def grid() -> bytes:
    cells = bytes([100, 100, 100, 100, 0, 100, 100, 255, 100])
    head = struct.pack("<III", 0, 0, 0) + struct.pack("<I", 3) + b"map" + struct.pack("<IIfII", 0, 0, 0.5, 3, 3)
    return head + struct.pack("<7d", -1.0, -1.0, 0, 0, 0, 0, 1) + struct.pack("<I", 9) + cells


def definition(name: str) -> bytes:
    return STORE.generate_msgdef(name, ros_version=1)[0].encode()


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "black_box.mcap"
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start(profile="ros1", library="test")
        channels = {}
        for topic, kind in (("/odom", "nav_msgs/Odometry"), ("/map", "nav_msgs/OccupancyGrid")):
            full = kind.replace("/", "/msg/")
            schema = writer.register_schema(kind, "ros1msg", definition(full))
            channels[topic] = writer.register_channel(topic, "ros1", schema)
        writer.add_message(channels["/map"], START, grid(), START)
        for number in range(200):
            moment = START + number * 100_000_000
            writer.add_message(channels["/odom"], moment, odometry(number * 0.01), moment)
        writer.add_metadata("events", {f"{START / 1e9 + 15.0:.3f}": "bumper left was touched <b>"})
        writer.finish()  # type: ignore[no-untyped-call]
    return path


SOURCES = RunSources(
    {"logs/move_base.log": "[INFO] <script>alert(1)</script>\n"},
    {"run.json": {"run": "wander.1", "exit code": 1}, "parameters.json": {"speed": 0.5}},
)


def test_archive_holds_recording_and_files(tmp_path: Path, recording: Path) -> None:
    report = write_report(tmp_path / "report.zip", SOURCES, [recording])
    assert report.size < MOST_BYTES
    assert report.path.stat().st_mode & 0o777 == 0o600
    with zipfile.ZipFile(report.path) as archive:
        assert archive.testzip() is None
        names = set(archive.namelist())
        archive.extract("recording.mcap", tmp_path)
    assert names >= {
        "recording.mcap",
        "run.json",
        "parameters.json",
        "logs/move_base.log",
        "removed.txt",
    }
    with recording.open("rb") as before, (tmp_path / "recording.mcap").open("rb") as after:
        old, new = (list(make_reader(file).iter_messages()) for file in (before, after))
    assert [(each[1].topic, each[2].log_time) for each in new] == [(each[1].topic, each[2].log_time) for each in old]
    last = get_typestore(Stores.ROS2_FOXY).deserialize_cdr(new[-1][2].data, "nav_msgs/msg/Odometry")
    assert last.pose.pose.position.x == pytest.approx(1.99)  # type: ignore[attr-defined]


def test_recording_has_an_index_and_right_checksums(tmp_path: Path, recording: Path) -> None:
    write_report(tmp_path / "report.zip", SOURCES, [recording])
    with zipfile.ZipFile(tmp_path / "report.zip") as archive:
        archive.extract("recording.mcap", tmp_path)
    with (tmp_path / "recording.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert summary.statistics.message_count == len(list(reader.iter_messages())) == 201
        file.seek(0)
        offsets = [each for each in StreamReader(file, validate_crcs=True).records if isinstance(each, SummaryOffset)]
        assert all(each.group_length for each in offsets)


def test_broken_recording_is_named_and_left_out(tmp_path: Path, recording: Path) -> None:
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(recording.read_bytes()[:300])
    report = write_report(tmp_path / "report.zip", SOURCES, [broken])
    assert any("recording" in each for each in report.missing)
    with zipfile.ZipFile(report.path) as archive:
        assert "recording.mcap" not in archive.namelist()


def test_nothing_is_left_where_the_archive_cannot_be_written(tmp_path: Path, recording: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "full").write_text("")
    with pytest.raises(OSError, match=r"[Nn]ot a directory"):
        write_report(tmp_path / "folder" / "full" / "report.zip", SOURCES, [recording])
    assert [path.name for path in (tmp_path / "folder").iterdir()] == ["full"]


def test_recordings_are_those_of_the_time_of_the_run(tmp_path: Path, recording: Path) -> None:
    moment = recording.stat().st_mtime
    assert list_run_recordings(tmp_path, moment - 1.0, moment + 1.0) == [recording]
    assert list_run_recordings(tmp_path, moment + 1.0, moment + 2.0) == []
    assert list_run_recordings(tmp_path / "none", 0.0, 1.0) == []


def test_logs_are_merged_by_their_times() -> None:
    logs = {
        "logs/a.log": "no time\n[INFO] 2026-11-26 14:00:02,000: second\ntraceback\n",
        "logs/b.log": "[INFO] 2026-11-26 14:00:01,500: first\n",
    }
    lines = merge_logs(logs).splitlines()
    assert [line.split(" ", 2)[2] for line in lines] == [
        "b: [INFO] 2026-11-26 14:00:01,500: first",
        "a: [INFO] 2026-11-26 14:00:02,000: second",
        "a: traceback",
    ]


def test_run_that_has_ended_is_collected(tmp_path: Path) -> None:
    (tmp_path / "wander.log").write_text("[INFO] 2026-11-26 14:00:02,000: hello\n")
    entry = RunEntry("wander.1", 1, 1, "wander", "", str(tmp_path), 1_700_000_000.0, False, "bob")
    ended = EndedRun(entry, 1_700_000_100.0, 1, "/wander died", ("[/wander] died",))
    sources = collect(entry, ended, {"ROS_DISTRO": "noetic", "OTHER": "x"})
    assert sources.texts["logs/wander.log"].endswith("hello\n")
    assert sources.values["environment.json"] == {"ROS_DISTRO": "noetic"}
    run = sources.values["run.json"]
    assert isinstance(run, dict)
    assert (run["exit code"], run["cause"]) == (1, "/wander died")


def test_parameters_of_a_master_that_is_not_there_are_none() -> None:
    assert read_parameters("http://127.0.0.1:9") == {}
    assert read_parameters("") == {}


@pytest.mark.parametrize("block", [b" ", b" " * 65536])
def test_master_whose_answer_never_ends_has_no_parameters(block: bytes) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer() -> None:
            connection, _ = server.accept()
            with connection, suppress(OSError):
                connection.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 1000000000\r\n\r\n")
                while True:
                    connection.sendall(block)

        thread = threading.Thread(target=answer)
        thread.start()
        assert read_parameters(f"http://127.0.0.1:{server.getsockname()[1]}") == {}
        thread.join()


def test_report_is_written_without_the_recording_where_its_readers_cannot_be_installed(
    tmp_path: Path, recording: Path
) -> None:
    reason = "rosbags could not be installed"
    report = write_report(tmp_path / "report.zip", SOURCES, [recording], reason)
    with zipfile.ZipFile(report.path) as archive:
        assert {"run.json", "logs/move_base.log"} <= set(archive.namelist())
        assert "recording.mcap" not in archive.namelist()
        assert f"missing: the recording: {reason}" in archive.read("removed.txt").decode()
