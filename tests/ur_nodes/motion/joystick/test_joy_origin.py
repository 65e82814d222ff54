from __future__ import annotations

import pytest

from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.motion.joystick.joy_origin import JoyOrigin
from ur_nodes.ports.node import Location


class Asking:
    """A node on a bus, and for which nodes it has asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.bus = Bus()
        self.bus.node("here")
        self.bus.hosts["/there"] = "192.0.2.7"
        self.node: MemoryNode = self.bus.node("teleop")
        self.asked: list[str] = []
        locate = self.node.locate

        def note(name: str) -> Location | None:
            self.asked.append(name)
            return locate(name)

        monkeypatch.setattr(self.node, "locate", note)

    def accepts(self, origin: JoyOrigin, name: str) -> bool:
        """Whether a node is accepted once it was looked up."""
        for _ in range(3):
            origin.accepts(name)
            self.bus.run(0.01)
        return origin.accepts(name)


@pytest.fixture
def asking(monkeypatch: pytest.MonkeyPatch) -> Asking:
    return Asking(monkeypatch)


def test_joystick_of_this_computer_is_accepted_and_looked_up_once(asking: Asking) -> None:
    assert asking.accepts(JoyOrigin(asking.node, remote=False), "/here")
    assert asking.asked == ["/here"]


def test_joystick_of_another_computer_is_refused_unless_it_is_wanted(asking: Asking) -> None:
    assert not asking.accepts(JoyOrigin(asking.node, remote=False), "/there")
    assert JoyOrigin(asking.node, remote=True).accepts("/there")
    assert asking.asked == ["/there"]
    assert any("/there runs on 192.0.2.7, expected it on this computer" in text for _, text in asking.node.lines)


def test_joystick_that_cannot_be_found_is_refused_and_looked_up_again_later(asking: Asking) -> None:
    origin = JoyOrigin(asking.node, remote=False)
    assert not asking.accepts(origin, "/nowhere")
    assert asking.asked == ["/nowhere"]
    asking.bus.node("nowhere")
    asking.bus.run(6.0)
    assert asking.accepts(origin, "/nowhere")
