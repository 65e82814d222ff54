import pytest

from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.motion.joystick.joy_origin import JoyOrigin
from ur_nodes.ports.node import Location, Sender


class Asking:
    """A node on a bus, and for which nodes it has asked."""

    def __init__(self) -> None:
        self.bus = Bus()
        self.bus.node("here")
        self.bus.hosts["/there"] = "192.0.2.7"
        self.node: MemoryNode = self.bus.node("teleop")
        self.asked: list[str] = []

    def locate(self, name: str) -> Location | None:
        self.asked.append(name)
        return self.node.locate(name)

    def origin(self, *, remote: bool) -> JoyOrigin:
        return JoyOrigin(self.node, remote=remote, locate=self.locate)

    def accepts(self, origin: JoyOrigin, name: str) -> bool:
        """Whether a node is accepted once it was looked up."""
        for _ in range(3):
            origin.accepts(Sender(name))
            self.bus.run(0.01)
        return origin.accepts(Sender(name))


@pytest.fixture
def asking() -> Asking:
    return Asking()


def test_joystick_of_this_computer_is_accepted_and_looked_up_once(asking: Asking) -> None:
    assert asking.accepts(asking.origin(remote=False), "/here")
    assert asking.asked == ["/here"]


def test_joystick_of_another_computer_is_refused_unless_it_is_wanted(asking: Asking) -> None:
    assert not asking.accepts(asking.origin(remote=False), "/there")
    assert asking.origin(remote=True).accepts(Sender("/there"))
    assert asking.asked == ["/there"]
    assert any("/there runs on 192.0.2.7, expected it on this computer" in text for _, text in asking.node.lines)


def test_joystick_that_cannot_be_found_is_refused_and_looked_up_again_later(asking: Asking) -> None:
    origin = asking.origin(remote=False)
    assert not asking.accepts(origin, "/nowhere")
    assert asking.asked == ["/nowhere"]
    asking.bus.node("nowhere")
    asking.bus.run(6.0)
    assert asking.accepts(origin, "/nowhere")


def stamped(sent: float) -> Sender:
    return Sender("/joy", id="1", sent=round(sent * 1e9), arrived=0.0)


def test_message_that_this_computer_has_just_stamped_is_accepted(asking: Asking) -> None:
    origin = JoyOrigin(asking.node, remote=False, clock=lambda: 10_000_000_000)
    assert origin.accepts(stamped(9.9))
    assert asking.asked == []


def test_message_that_a_network_has_held_back_is_refused(asking: Asking) -> None:
    origin = JoyOrigin(asking.node, remote=False, clock=lambda: 10_000_000_000)
    assert not origin.accepts(stamped(9.0))
    assert any("was sent 1.00 s ago" in text for _, text in asking.node.lines)


def test_joystick_of_a_computer_whose_clock_is_ahead_is_refused_also_when_its_messages_are_late(asking: Asking) -> None:
    now = [10_000_000_000]
    origin = JoyOrigin(asking.node, remote=False, clock=lambda: now[0])
    assert not origin.accepts(stamped(15.0))
    now[0] = 15_050_000_000
    assert not origin.accepts(stamped(15.0))


@pytest.mark.parametrize(("age", "accepted"), [(0.1, True), (0.2, False), (3600.0, False), (1e6, True)])
def test_input_that_is_late_by_its_own_stamp_is_refused_where_nothing_else_shows_its_age(
    age: float, accepted: bool, asking: Asking
) -> None:
    origin = JoyOrigin(asking.node, remote=False, locate=asking.locate, clock=lambda: 10**18)
    assert asking.accepts(origin, "/here")
    assert origin.accepts(Sender("/here"), 10**18 - round(age * 1e9)) is accepted
    assert origin.accepts(Sender("/here"), 0)
