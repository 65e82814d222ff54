"""One contract for all backends."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.ros_session import RosSession
from tests.ur_nodes.ports.contract import CHECKS
from tests.ur_nodes.ports.stage import STRING, GoalClient

from ur_nodes.memory.bus import Bus
from ur_nodes.ports.actions import Goal, GoalId, GoalState
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import PlacedPose


class MemoryStage:
    def __init__(self) -> None:
        self._bus = Bus()
        self._bus.schemas[STRING] = "string data"
        self.one: Node = self._bus.node("one")
        self.other: Node = self._bus.node("other")

    def begin(self) -> None:
        pass

    def until(self, condition: Callable[[], bool]) -> None:
        assert self._bus.run_until(condition, 10.0), "waited for 10 s of the bus's time"

    def spoil(self, topic: str) -> None:
        self._bus.spoil(f"/{topic}", "map with resolution 0, expected more than 0 m")

    def client(self, action: str) -> GoalClient:
        return MemoryClient(self._bus, action)


class MemoryClient:
    """See GoalClient."""

    def __init__(self, bus: Bus, action: str) -> None:
        node = bus.node("client")
        self._bus = bus
        self._goals = node.publish(f"{action}/goal", Goal, Quality.EVERY)
        self._cancels = node.publish(f"{action}/cancel", GoalId, Quality.EVERY)
        self._sent: list[int] = []
        self._states: dict[str, GoalState] = {}
        self._heard: PlacedPose | None = None
        node.subscribe(
            f"{action}/state", GoalState, lambda state: self._states.update({state.id: state}), Quality.EVERY
        )
        node.subscribe(f"{action}/feedback", PlacedPose, self._take_feedback)

    def send(self, target: PlacedPose) -> str:
        self._bus.run(0.01)
        self._sent.append(self._bus.now)
        self._goals.send(Goal(str(len(self._sent)), target))
        return str(len(self._sent))

    def cancel(self, id: str) -> None:
        self._cancels.send(GoalId(id))

    def cancel_sent_before(self, id: str) -> None:
        self._cancels.send(GoalId(stamp=self._sent[int(id) - 1]))

    def state(self, id: str) -> tuple[str, str]:
        state = self._states.get(id, GoalState(id, "pending", ""))
        return state.state, state.text

    def report(self) -> PlacedPose | None:
        return self._heard

    def _take_feedback(self, pose: PlacedPose) -> None:
        self._heard = pose


@pytest.mark.parametrize("name", CHECKS)
def test_memory_keeps(name: str) -> None:
    CHECKS[name](MemoryStage())


@pytest.fixture(scope="module")
def failures_on_ros1(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    session = RosSession(tmp_path_factory.mktemp("contract"))
    try:
        program = session.start(sys.executable, str(Path(__file__).with_name("ros1_stage.py")), *CHECKS)
        output, errors = program.communicate(timeout=240)
        session.running.remove(program)
    finally:
        session.close()
    assert output, errors
    failures: dict[str, str] = json.loads(output.splitlines()[-1])
    return failures


@pytest.mark.ros
@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", CHECKS)
def test_ros1_keeps(name: str, failures_on_ros1: dict[str, str]) -> None:
    assert name not in failures_on_ros1, failures_on_ros1[name]
