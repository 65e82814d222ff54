"""Recorded failures, replayed: nodes do again what they did, and viewers show what they showed."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.ur_nodes.lock_step.failures import FAILURES, FailingDrive, Viewer, plan_replay, record

from ur.recordings.mcap_file import open_recording
from ur.source.diagnostic import UserError
from ur_nodes.lock_step.bus import StepBus
from ur_nodes.lock_step.digest import fingerprint
from ur_nodes.lock_step.run import replay
from ur_nodes.ros1.stored import find_reader

Failure = Callable[[FailingDrive], None]


@pytest.fixture(autouse=True)
def _without_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_VERSION", "0")


@pytest.mark.parametrize("failure", FAILURES, ids=lambda each: each.__name__)
def test_failure_is_replayed_as_it_was_recorded(failure: Failure, tmp_path: Path) -> None:
    drive, path = record(failure, tmp_path)
    sent = [(time, topic, value) for sender, time, topic, value in drive.wire.sent if sender == "/move_base"]
    report = replay(plan_replay(path, "/move_base"), find_reader, sent=len(sent))
    assert report.differences == []
    assert report.recorded.endings == report.replayed.endings
    assert len(sent) == pytest.approx(report.sent, abs=5)  # the recording ends DELAY later
    assert report.digest == fingerprint(sent)
    assert shown_in_a_viewer(path) == drive.viewer.shown


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of a goal that was refused."""
    (failure,) = (each for each in FAILURES if each.__name__ == "goal_in_a_wall")
    return record(failure, tmp_path_factory.mktemp("failure"))[1]


@pytest.mark.parametrize(
    ("module", "reason"), [("ur_nodes.no_such_node", "No module named ur_nodes.no_such_node"), ("this", "it has ended")]
)
def test_node_that_does_not_start_is_named_with_the_reason(module: str, reason: str, recording: Path) -> None:
    plan = plan_replay(recording, "/move_base")
    nodes = (dataclasses.replace(plan.nodes[0], words=(module,)),)
    with pytest.raises(UserError, match=f"/move_base does not start: .*{reason}"):
        replay(dataclasses.replace(plan, nodes=nodes), find_reader)


def shown_in_a_viewer(path: Path) -> list[object]:
    recording = open_recording(path)
    bus = StepBus(recording, find_reader, frozenset({"/viewer"}), frozenset(), lambda *_: None)
    viewer = Viewer(bus.node("viewer"))
    for message in recording.messages():
        bus.advance(message.time)
        bus.deliver(message)
    bus.advance(recording.end)
    return list(viewer.shown)
