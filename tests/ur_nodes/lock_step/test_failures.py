"""Recorded failures, replayed: nodes do again what they did, and viewers show what they showed."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.ur_nodes.lock_step.bus import StepBus
from tests.ur_nodes.lock_step.digest import fingerprint
from tests.ur_nodes.lock_step.failures import FAILURES, FailingDrive, Viewer, plan_replay, record
from tests.ur_nodes.lock_step.run import replay

from ur.recordings.mcap_file import open_recording

Failure = Callable[[FailingDrive], None]


@pytest.fixture(autouse=True)
def _without_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_VERSION", "0")


@pytest.mark.parametrize("failure", FAILURES, ids=lambda each: each.__name__)
def test_failure_is_replayed_as_it_was_recorded(failure: Failure, tmp_path: Path) -> None:
    drive, path = record(failure, tmp_path)
    sent = [(time, topic, value) for sender, time, topic, value in drive.wire.sent if sender == "/move_base"]
    report = replay(plan_replay(path, "/move_base"), sent=len(sent))
    assert report.replayed == report.recorded
    assert len(sent) == pytest.approx(report.sent, abs=5)  # the recording ends DELAY later
    assert report.digest == fingerprint(sent)
    assert shown_in_a_viewer(path) == drive.viewer.shown


def shown_in_a_viewer(path: Path) -> list[object]:
    recording = open_recording(path)
    bus = StepBus(recording, frozenset({"/viewer"}), frozenset())
    viewer = Viewer(bus.node("viewer"))
    for message in recording.messages():
        bus.advance(message.time)
        bus.deliver(message)
    bus.advance(recording.end)
    return list(viewer.shown)
