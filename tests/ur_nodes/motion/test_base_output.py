"""Velocities leave as the messages that the base takes."""

import pytest

from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.motion.mux_events import STILL, Velocity
from ur_nodes.motion.mux_runner import BaseOutput
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Twist

AHEAD = Velocity(0.3, 0.1)


class OutputBench:
    """An output that sends 50 times a second, and what arrives at subscribers, by their names."""

    def __init__(self) -> None:
        self.bus = Bus()
        self.mux: MemoryNode = self.bus.node("mux")
        self.got: dict[str, list[Twist | StampedTwist]] = {}

    def begin(self) -> None:
        output = BaseOutput(self.mux, "cmd_vel", lambda: STILL)
        self.mux.every(0.02, lambda: output.send(AHEAD))
        self.bus.run(1.0)

    def listen(self, name: str, kind: type[Twist] | type[StampedTwist]) -> MemoryNode:
        node = self.bus.node(name)
        got = self.got[name] = []
        node.subscribe("cmd_vel", kind, got.append, Quality.EVERY)
        return node

    def lines(self) -> list[str]:
        return [text for _, text in self.mux.lines if "velocities are sent" in text]


@pytest.fixture
def bench() -> OutputBench:
    return OutputBench()


def test_base_that_takes_twists_gets_them(bench: OutputBench) -> None:
    bench.listen("base", Twist)
    bench.begin()
    assert bench.got["base"][-1] == Twist(0.3, 0.1)
    assert bench.lines() == ["/cmd_vel: velocities are sent as Twist, which the base takes"]


def test_base_that_takes_stamped_twists_gets_them_with_the_time_of_all_nodes(bench: OutputBench) -> None:
    bench.listen("base", StampedTwist)
    bench.begin()
    newest = bench.got["base"][-1]
    assert isinstance(newest, StampedTwist)
    assert (newest.twist, newest.frame) == (Twist(0.3, 0.1), "base_link")
    assert 0 <= bench.bus.now - newest.stamp < 50_000_000
    assert bench.lines() == ["/cmd_vel: velocities are sent as TwistStamped, which the base takes"]


def test_base_that_starts_later_is_stopped_first_and_then_driven(bench: OutputBench) -> None:
    bench.begin()
    assert bench.lines() == []
    bench.listen("base", StampedTwist)
    bench.bus.run(1.0)
    twists = [each.twist for each in bench.got["base"] if isinstance(each, StampedTwist)]
    assert twists[0] == Twist(0.0, 0.0)
    assert twists[-1] == Twist(0.3, 0.1)


def test_type_changes_with_the_subscriber(bench: OutputBench) -> None:
    old = bench.listen("base", Twist)
    bench.begin()
    old.end("another driver is started")
    bench.bus.run(1.0)
    bench.listen("new", StampedTwist)
    bench.bus.run(1.0)
    assert isinstance(bench.got["new"][-1], StampedTwist)
    assert len(bench.lines()) == 2


def test_type_stays_while_its_subscriber_is_there(bench: OutputBench) -> None:
    bench.listen("base", Twist)
    bench.begin()
    bench.listen("other", StampedTwist)
    bench.bus.run(1.0)
    assert bench.got["other"] == []
    assert bench.got["base"][-1] == Twist(0.3, 0.1)
    warning = "/cmd_vel: programs use Twist and TwistStamped here, expected one of them; this one uses Twist"
    assert [text for level, text in bench.mux.lines if level == "warn"] == [warning]
