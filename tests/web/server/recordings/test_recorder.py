"""The process that records: its limits, its end, and a real one with a real master."""

from __future__ import annotations

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path

import pytest
from tests.ros_session import RosSession

from ur.web.server.recordings.recorder import Recorder, RecorderError, RecordingLimits, find_reason
from ur.web.server.recordings.store import Store
from ur.web.server.recordings.topics import TopicSelection, list_topics, select
from ur.web.server.recordings.writer import NoWriterError, Rosbag

LIMITS = RecordingLimits(all=1000, free=100, seconds=60.0)
# Writes a file as rosbag does: under another name until SIGINT.
WRITES = 'trap "mv $0_0.bag.active $0_0.bag; exit" INT; echo 12345678 > $0_0.bag.active; while :; do sleep 0.05; done'
STUBBORN = 'trap "" INT; echo 1 > $0_0.bag.active; while :; do sleep 0.05; done'


class ScriptWriter:
    """A writer that is a shell's script."""

    ending, unfinished = ".bag", ".bag.active"

    def __init__(self, script: str) -> None:
        self.script = script

    def make_command(self, stem: Path, _selection: TopicSelection) -> list[str]:
        return ["/bin/sh", "-c", self.script, str(stem)]


@asynccontextmanager
async def record(
    folder: Path, script: str, limits: RecordingLimits | None = None
) -> AsyncIterator[tuple[Recorder, Store]]:
    store = Store(folder / "recordings", ".bag", ".bag.active")
    recorder = Recorder(
        store, ScriptWriter(script), dict(os.environ), lambda _: None, limits or RecordingLimits(free=0)
    )
    try:
        yield recorder, store
    finally:
        await recorder.close()


async def wait_until(holds: Callable[[], object]) -> None:
    async def poll() -> None:
        while not holds():
            await asyncio.sleep(0.02)

    await asyncio.wait_for(poll(), 30)


@pytest.mark.parametrize(
    ("used", "free", "seconds", "reason"),
    [
        (999, 100, 59.9, ""),
        (1000, 100, 0.0, "delete some"),
        (0, 99, 0.0, "free on the disk"),
        (0, 100, 60.0, "minutes at most"),
    ],
)
def test_limit_names_the_reason_of_the_end(used: int, free: int, seconds: float, reason: str) -> None:
    found = find_reason(LIMITS, used, free, seconds)
    assert reason in found
    assert bool(found) == bool(reason)


async def test_recording_is_private_and_ends_when_it_is_stopped(tmp_path: Path) -> None:
    async with record(tmp_path, WRITES) as (recorder, store):
        assert not await recorder.stop("nothing")
        recorder.start(TopicSelection(("/scan",)))
        with pytest.raises(RecorderError, match="under way"):
            recorder.start(TopicSelection())
        await wait_until(lambda: recorder.running and recorder.running.size)
        assert recorder.running is not None
        assert (recorder.running.size, recorder.running.topics) == (9, 1)
        other = Recorder(store, ScriptWriter(WRITES), dict(os.environ), lambda _: None, RecordingLimits(free=0))
        with pytest.raises(RecorderError, match="another page"):
            other.start(TopicSelection())
        assert await recorder.stop("stopped by Linux")
        assert recorder.end == "stopped by Linux"
        (file,) = store.list()
        assert not file.cut
        assert (store.folder / file.name).stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize(
    ("limits", "reason"),
    [(RecordingLimits(all=5, free=0), "delete some"), (RecordingLimits(free=0, seconds=0.1), "minutes at most")],
)
async def test_recording_ends_at_a_limit(tmp_path: Path, limits: RecordingLimits, reason: str) -> None:
    script = WRITES if limits.all == 5 else WRITES.replace("12345678", "")
    async with record(tmp_path, script, limits) as (recorder, store):
        recorder.start(TopicSelection())
        await wait_until(lambda: recorder.running is None)
        assert reason in recorder.end
        assert len(store.list()) == 1
        if limits.all == 5:
            with pytest.raises(RecorderError, match="delete some"):
                recorder.start(TopicSelection())


async def test_full_disk_refuses_the_start(tmp_path: Path) -> None:
    async with record(tmp_path, WRITES, replace(LIMITS, free=1 << 62)) as (recorder, _):
        with pytest.raises(RecorderError, match="free on the disk"):
            recorder.start(TopicSelection())
        assert recorder.running is None


async def test_process_that_does_not_end_is_killed_and_its_file_is_listed_as_cut(tmp_path: Path) -> None:
    async with record(tmp_path, STUBBORN, RecordingLimits(free=0, patience=0.2)) as (recorder, store):
        recorder.start(TopicSelection())
        await wait_until(lambda: recorder.running and recorder.running.size)
        assert await recorder.stop("x")
        assert [each.cut for each in store.list()] == [True]


async def test_recording_ends_with_the_server_and_none_starts_after_it(tmp_path: Path) -> None:
    async with record(tmp_path, WRITES) as (recorder, store):
        recorder.start(TopicSelection())
        await wait_until(lambda: recorder.running and recorder.running.size)
        await recorder.close()
        assert "server" in recorder.end
        assert len(store.list()) == 1
        with pytest.raises(RecorderError, match="server ends"):
            recorder.start(TopicSelection())


async def test_program_that_ends_by_itself_is_reported_with_its_last_line(tmp_path: Path) -> None:
    async with record(tmp_path, "printf 'a\\n\\033[31mno disk\\n' >&2; exit 3") as (recorder, _):
        recorder.start(TopicSelection())
        await wait_until(lambda: recorder.running is None)
        assert "no disk" in recorder.end
        assert "\033" not in recorder.end


def test_computer_without_rosbag_is_named(tmp_path: Path) -> None:
    with pytest.raises(NoWriterError, match="python3-rosbag"):
        Rosbag({"PATH": str(tmp_path)}).make_command(tmp_path / "x", TopicSelection())


async def test_rosbag_records_the_topics_of_a_real_master(tmp_path: Path) -> None:
    session = RosSession(tmp_path / "ros")
    try:
        text = "x" * 20_000  # rosbag writes chunks of 768 kB
        for topic in ("chatter", "image_raw"):
            session.start("/usr/bin/python3", "/usr/bin/rostopic", "pub", "-r", "50", topic, "std_msgs/String", text)
        names = {"/chatter", "/image_raw"}
        master = session.env["ROS_MASTER_URI"]
        await wait_until(lambda: names <= {each.name for each in list_topics(master)})
        writer = Rosbag(os.environ)
        store = Store(tmp_path / "recordings", writer.ending, writer.unfinished)
        recorder = Recorder(store, writer, session.env, lambda _: None, RecordingLimits(free=0))
        recorder.start(select((), list_topics(master)))
        await wait_until(lambda: recorder.running and recorder.running.size > 5000)  # more than the head of a bag
        await recorder.stop("stopped by Linux")
        assert recorder.end == "stopped by Linux"
        (file,) = store.list()
        path = store.folder / file.name
        assert path.stat().st_mode & 0o777 == 0o600
        info = session.start("/usr/bin/python3", "/usr/bin/rosbag", "info", "--yaml", str(path))
        report, _ = info.communicate(timeout=60)
        session.running.remove(info)
        assert "/chatter" in report
        assert "lz4" in report
        assert "/image_raw" not in report
    finally:
        session.close()


async def test_recorder_ends_when_the_server_is_killed(tmp_path: Path) -> None:
    code = f"""
import asyncio, os
from pathlib import Path
from ur.web.server.recordings.recorder import Recorder, RecordingLimits
from ur.web.server.recordings.store import Store
from ur.web.server.recordings.topics import TopicSelection
from tests.web.server.recordings.test_recorder import WRITES, ScriptWriter
async def main():
    store = Store(Path({str(tmp_path)!r}) / "recordings", ".bag", ".bag.active")
    recorder = Recorder(store, ScriptWriter(WRITES), dict(os.environ), print, RecordingLimits(free=0))
    recorder.start(TopicSelection())
    while not recorder.running.size:
        await asyncio.sleep(0.02)
    print("up", flush=True)
    await asyncio.sleep(60)
asyncio.run(main())
"""
    root = Path(__file__).parents[4]
    server = subprocess.Popen([sys.executable, "-c", code], cwd=root, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    assert server.stdout.readline() == "up\n"
    server.send_signal(signal.SIGKILL)
    server.communicate()
    store = Store(tmp_path / "recordings", ".bag", ".bag.active")
    await wait_until(store.list)
