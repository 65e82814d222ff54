"""One contract for all backends."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.ros_session import RosSession
from tests.ur_nodes.ports.contract import CHECKS

from ur_nodes.memory.bus import Bus
from ur_nodes.ports.node import Node


class MemoryStage:
    def __init__(self) -> None:
        self._bus = Bus()
        self.one: Node = self._bus.node("one")
        self.other: Node = self._bus.node("other")

    def begin(self) -> None:
        pass

    def until(self, condition: Callable[[], bool]) -> None:
        assert self._bus.run_until(condition, 10.0), "waited for 10 s of the bus's time"


@pytest.mark.parametrize("name", CHECKS)
def test_memory_keeps(name: str) -> None:
    CHECKS[name](MemoryStage())


@pytest.fixture(scope="module")
def failures_on_ros1(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    session = RosSession(tmp_path_factory.mktemp("contract"))
    try:
        program = session.start(sys.executable, str(Path(__file__).with_name("contract.py")), *CHECKS)
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
