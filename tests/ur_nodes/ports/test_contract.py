"""One contract for all backends."""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.ros2_session import PYTHON, Ros2Session
from tests.ros_session import RosSession
from tests.ur_nodes.ports.contract import CHECKS
from tests.ur_nodes.ports.stage import Described, GoalClient, TopicGoalClient

from ur_nodes.memory.bus import Bus
from ur_nodes.ports.node import Node


class MemoryStage:
    raw_senders_unknown = False
    moments_known = False
    silent_services_hide_failures = False
    keeps_for_all = False
    only_live_parameters = False
    string_type = "std_msgs/String"
    wire = b"hello"

    def __init__(self) -> None:
        self._bus = Bus()
        self._bus.schemas[self.string_type] = "string data"
        self.one: Node = self._bus.node("one")
        self.other: Node = self._bus.node("other")

    def begin(self) -> None:
        pass

    def until(self, condition: Callable[[], bool]) -> None:
        assert self._bus.run_until(condition, 10.0), "waited for 10 s of the bus's time"

    def spoil(self, topic: str) -> None:
        self._bus.spoil(f"/{topic}", "map with resolution 0, expected 0.0001 to 1000 m")

    def set_parameter(self, name: str, value: object) -> str:
        return self.one.parameters.change({f"~{name}": value})

    def describe(self, name: str) -> Described:
        found = self.one.parameters.declared()[self.one.resolve(f"~{name}")]
        return Described(found.live or found.expected, *found.limits, not found.live)

    def client(self, action: str) -> GoalClient:
        return TopicGoalClient(self._bus.node("client"), action, lambda: self._bus.run(0.01))


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


@pytest.fixture(scope="module")
def failures_on_ros2(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The failures by name, of the checks of values that ROS 2 has messages for."""
    if not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    session = Ros2Session(tmp_path_factory.mktemp("contract2"))
    program = session.run(str(Path(__file__).with_name("ros2_stage.py")), *CHECKS, within=240.0)
    assert program.stdout, program.stderr
    assert "rcutils" not in program.stderr
    failures: dict[str, str] = json.loads(program.stdout.splitlines()[-1])
    return failures


@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", CHECKS)
def test_ros2_keeps(name: str, failures_on_ros2: dict[str, str]) -> None:
    assert name not in failures_on_ros2, failures_on_ros2[name]


@pytest.mark.ros
@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", CHECKS)
def test_ros1_keeps(name: str, failures_on_ros1: dict[str, str]) -> None:
    assert name not in failures_on_ros1, failures_on_ros1[name]
