"""The process that records: its limits, its end, and a real one with a real master."""

import asyncio
import os
import signal
import subprocess
import sys
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from tests.ros_session import RosSession

from ur.recordings.mcap_file import open_recording
from ur.web.server.recordings.recorder import Recorder, RecorderError, RecordingLimits, find_reason
from ur.web.server.recordings.recording_pages import list_topics
from ur.web.server.recordings.store import Store

LIMITS = RecordingLimits(all=1000, seconds=60.0)
STEM = "recording_2026-03-01_14-05-31_001"
# Writes a file as the node does: under another name until SIGINT.
WRITES = 'trap "mv $0.mcap.part $0.mcap; exit" INT; echo 12345678 > $0.mcap.part; while :; do sleep 0.05; done'
STUBBORN = 'trap "" INT; echo 1 > $0.mcap.part; while :; do sleep 0.05; done'


def script_of(script: str) -> Any:
    """Return a maker of commands that are a shell's script, whose $0 begins the name of its file."""
    return lambda _, folder, topics: ["/bin/sh", "-c", script, f"{folder}/{STEM}", *topics]


@asynccontextmanager
async def record(
    folder: Path, script: str, limits: RecordingLimits | None = None
) -> AsyncIterator[tuple[Recorder, Store]]:
    store = Store(folder / "recordings")
    recorder = Recorder(store, dict(os.environ), lambda _: None, limits, script_of(script))
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
    ("used", "seconds", "reason"), [(999, 59.9, ""), (1000, 0.0, "delete some"), (0, 60.0, "minutes at most")]
)
def test_limit_names_the_reason_of_the_end(used: int, seconds: float, reason: str) -> None:
    found = find_reason(LIMITS, used, seconds)
    assert reason in found
    assert bool(found) == bool(reason)


async def test_recording_is_private_and_ends_when_it_is_stopped(tmp_path: Path) -> None:
    async with record(tmp_path, WRITES) as (recorder, store):
        assert not await recorder.stop("nothing")
        store.prepare()
        (store.folder / "recording_2025-01-01_00-00-00_001.mcap").write_bytes(b"of another one")
        recorder.start(("/scan",))
        with pytest.raises(RecorderError, match="under way"):
            recorder.start(())
        await wait_until(lambda: recorder.running and recorder.running.size)
        assert recorder.running is not None
        assert (recorder.running.size, recorder.running.topics) == (9, 1)
        other = Recorder(store, dict(os.environ), lambda _: None, None, script_of(WRITES))
        with pytest.raises(RecorderError, match="another page"):
            other.start(())
        assert await recorder.stop("stopped by Linux")
        assert recorder.end == "stopped by Linux"
        file = store.list()[0]
        assert (file.name, file.cut) == (f"{STEM}.mcap", False)
        assert store.folder.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize(
    ("limits", "reason"),
    [(RecordingLimits(all=5), "delete some"), (RecordingLimits(seconds=0.1), "minutes at most")],
)
async def test_recording_ends_at_a_limit(tmp_path: Path, limits: RecordingLimits, reason: str) -> None:
    script = WRITES if limits.all == 5 else WRITES.replace("12345678", "")
    async with record(tmp_path, script, limits) as (recorder, store):
        recorder.start(())
        await wait_until(lambda: recorder.running is None)
        assert reason in recorder.end
        assert len(store.list()) == 1
        if limits.all == 5:
            with pytest.raises(RecorderError, match="delete some"):
                recorder.start(())


async def test_process_that_does_not_end_is_killed_and_its_file_is_listed_as_cut(tmp_path: Path) -> None:
    async with record(tmp_path, STUBBORN, RecordingLimits(patience=0.2)) as (recorder, store):
        recorder.start(())
        await wait_until(lambda: recorder.running and recorder.running.size)
        assert await recorder.stop("x")
        assert [each.cut for each in store.list()] == [True]


async def test_recording_ends_with_the_server_and_none_starts_after_it(tmp_path: Path) -> None:
    async with record(tmp_path, WRITES) as (recorder, store):
        recorder.start(())
        await wait_until(lambda: recorder.running and recorder.running.size)
        await recorder.close()
        assert "server" in recorder.end
        assert len(store.list()) == 1
        with pytest.raises(RecorderError, match="server ends"):
            recorder.start(())


async def test_program_that_ends_by_itself_is_reported_with_its_last_line(tmp_path: Path) -> None:
    async with record(tmp_path, "printf 'a\\n\\033[31mno disk\\n' >&2; exit 3") as (recorder, _):
        recorder.start(())
        await wait_until(lambda: recorder.running is None)
        assert "no disk" in recorder.end
        assert "\033" not in recorder.end


async def test_node_of_ur_record_records_the_topics_of_a_real_master(tmp_path: Path) -> None:
    session = RosSession(tmp_path / "ros")
    try:
        for topic, kind in (("chatter", "std_msgs/String"), ("image_raw", "sensor_msgs/Image")):
            session.start("/usr/bin/python3", "/usr/bin/rostopic", "pub", "-r", "50", topic, kind, "{}")
        names = {"/chatter", "/image_raw"}
        master = session.env["ROS_MASTER_URI"]
        await wait_until(lambda: names <= {each.name for each in list_topics(master)})
        store = Store(tmp_path / "recordings")
        recorder = Recorder(store, session.env, lambda _: None)
        for count, (topics, found) in enumerate((((), {"/chatter"}), (("/image_raw",), {"/image_raw"})), 1):
            recorder.start(topics)
            await wait_until(lambda: not recorder.running or recorder.running.size > 500)
            await recorder.stop("stopped by Linux")
            assert recorder.end == "stopped by Linux"
            assert len(store.list()) == count
            path = store.folder / store.list()[0].name
            assert path.stat().st_mode & 0o777 == 0o600
            assert set(open_recording(path).topics) & names == found
    finally:
        session.close()


async def test_recorder_ends_when_the_server_is_killed(tmp_path: Path) -> None:
    code = f"""
import asyncio, os
from pathlib import Path
from ur.web.server.recordings.recorder import Recorder
from ur.web.server.recordings.store import Store
from tests.web.server.recordings.test_recorder import WRITES, script_of
async def main():
    store = Store(Path({str(tmp_path)!r}) / "recordings")
    recorder = Recorder(store, dict(os.environ), print, None, script_of(WRITES))
    recorder.start(())
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
    store = Store(tmp_path / "recordings")
    await wait_until(store.list)
