from __future__ import annotations

import pytest

from ur_nodes.motion.joystick.joy_origin_node import JoyOrigin


class Master:
    """A master that knows where nodes run."""

    asked: list[str]

    def __init__(self, hosts: dict[str, str]) -> None:
        self.hosts = hosts
        self.asked = []

    def lookupNode(self, name: str) -> str:  # noqa: N802 - rosgraph's name
        self.asked.append(name)
        if name not in self.hosts:
            raise OSError("no answer")
        return f"http://{self.hosts[name]}:1234/"


@pytest.fixture
def master(monkeypatch: pytest.MonkeyPatch) -> Master:
    made = Master({"/here": "localhost", "/there": "192.0.2.7"})
    monkeypatch.setattr("rosgraph.Master", lambda _name: made)
    return made


def test_joystick_of_this_computer_is_accepted_and_looked_up_once(master: Master) -> None:
    origin = JoyOrigin(remote=False)
    assert all(origin.accepts("/here") for _ in range(3))
    assert master.asked == ["/here"]


def test_joystick_of_another_computer_is_refused_unless_it_is_wanted(master: Master) -> None:
    assert not JoyOrigin(remote=False).accepts("/there")
    assert JoyOrigin(remote=True).accepts("/there")
    assert master.asked == ["/there"]


def test_joystick_that_cannot_be_found_is_refused(master: Master) -> None:
    origin = JoyOrigin(remote=False)
    assert not any(origin.accepts("/nowhere") for _ in range(3))
    assert master.asked == ["/nowhere"]
