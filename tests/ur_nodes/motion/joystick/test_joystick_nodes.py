"""The joystick's reader and its teleop on a bus, before a mux."""

from pathlib import Path

import pytest
import yaml

from ur.source.diagnostic import UserError
from ur.source.project import launch_library
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.joystick.device import RECORD, JoystickSettings
from ur_nodes.motion.joystick.joy_node import start as start_joy
from ur_nodes.motion.joystick.joy_reader import FileDevice, JoyReader
from ur_nodes.motion.joystick.teleop_twist_joy_node import start as start_teleop
from ur_nodes.motion.lease.text import Lease, write_lease
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Joystick, Result, StampedTwist, Time, Twist

HELD, FREE = (0, 0, 0, 0, 1), (0, 0, 0, 0, 0)


class ScriptedDevice:
    """A device that is there from its `there` on, with what is in `data` to read; None: it goes."""

    path = "/dev/input/js0"

    def __init__(self) -> None:
        self.there = True
        self.data: list[bytes | None] = []

    def open(self) -> str:
        return "" if self.there else "no such file or directory, expected a joystick; waiting for one"

    def read(self, wait: float) -> bytes | None:
        assert 0.0 <= wait <= 0.5
        return self.data.pop(0) if self.data else record(0x80, 0, 0)  # of no kind, as time must pass


def record(kind: int, number: int, value: int) -> bytes:
    return RECORD.pack(0, value, kind, number)


def test_reader_publishes_changes_and_repeats_and_lets_go_when_the_device_is_gone() -> None:
    bus = Bus()
    got: list[Joystick] = []
    bus.node("teleop").subscribe("joy", Joystick, got.append, Quality.EVERY)
    node, device = bus.node("joy_node"), ScriptedDevice()
    device.data += [record(0x82, 0, 0), record(0x81, 0, 0)]  # the initial state is no event
    JoyReader(node, device, JoystickSettings(sticky_buttons=False), 0.05, 0.001)
    bus.run(0.01)
    got.clear()
    device.data += [record(2, 0, -32767), record(1, 0, 1)]
    bus.run(0.01)
    assert [(each.axes, each.buttons) for each in got] == [((1.0,), (0,)), ((1.0,), (1,))]
    bus.run(1.0)
    assert len(got) >= 20
    got.clear()
    device.there = False
    device.data.append(None)
    bus.run(0.5)
    assert [(each.axes, each.buttons) for each in got] == [((0.0,), (0,))] * 3
    bus.run(5.0)
    assert len(got) == 3
    assert [text for level, text in node.lines if level == "warn"] == [
        "/dev/input/js0: the joystick was unplugged; waiting for it",
        "/dev/input/js0: no such file or directory, expected a joystick; waiting for one",
    ]
    device.there = True
    device.data.append(record(1, 0, 1))
    bus.run(2.0)
    assert got[-1].buttons == (1,)


def test_device_that_is_a_file_is_read_until_it_ends(tmp_path: Path) -> None:
    path = tmp_path / "js0"
    device = FileDevice(str(path))
    assert device.open() == "no such file or directory, expected a joystick; waiting for one"
    path.write_bytes(record(1, 0, 1))
    assert device.open() == ""
    assert device.read(0.5) == record(1, 0, 1)
    assert device.read(0.5) is None


class Teleop:
    """The teleop, a joystick on this computer, and the mux's end of its topics."""

    def __init__(self, **parameters: object) -> None:
        self.bus = Bus()
        self.bus.parameters |= {f"/teleop/{name}": value for name, value in parameters.items()}
        self.bus.parameters |= {"/teleop/enable_button": 4, "/teleop/stop_button": 1, "/teleop/release_button": 2}
        self.node = self.bus.node("teleop", {"cmd_vel": "joy_vel"})
        self.mux = self.bus.node("cmd_vel_mux")
        self.plain: list[Twist] = []
        self.stamped: list[StampedTwist] = []
        self.asked: list[str] = []
        self.mux.subscribe("joy_vel_stamped", StampedTwist, self.stamped.append, Quality.EVERY)
        for name in ("stop", "release"):
            self.mux.serve(f"~{name}", Trigger, lambda _request, name=name: self.note(name))  # type: ignore[misc]
        start_teleop(self.node)
        self.joy = self.bus.node("joy_node").publish("joy", Joystick, Quality.EVERY)
        self.move(0.0, FREE)

    def note(self, name: str) -> Result:
        self.asked.append(name)
        return Result(True, name)

    def move(self, ahead: float, buttons: tuple[int, ...]) -> None:
        self.joy.send(Joystick(0, (0.0 if not ahead else 0.5, ahead), buttons))
        self.bus.run(0.05)


def test_plain_commands_come_only_while_the_button_is_held_and_end_with_zeros() -> None:
    teleop = Teleop(lease="false", axis_linear=1, scale_linear=1.0, scale_angular=2.0)
    teleop.mux.subscribe("joy_vel", Twist, teleop.plain.append, Quality.EVERY)
    teleop.move(1.0, FREE)
    assert teleop.plain == []
    teleop.move(0.5, HELD)
    for _ in range(5):
        teleop.move(0.5, FREE)
    assert teleop.plain == [Twist(0.5, 1.0)] + [Twist(0.0, 0.0)] * 3


@pytest.mark.parametrize("joystick", ["xbox", "ps4"])
def test_left_stick_drives_to_the_side_and_the_right_one_turns_a_base_that_can(joystick: str) -> None:
    folder = launch_library() / "n_teleop_twist_joy" / "params" / "joysticks"
    own, usual = (yaml.safe_load((folder / f"{name}.yaml").read_text()) for name in (f"{joystick}_sideways", joystick))
    axes = ("axis_linear", "axis_angular")
    assert {key: own[key] for key in own if key not in axes} == {key: usual[key] for key in usual if key not in axes}
    linear = {f"axis_linear/{key}": axis for key, axis in own["axis_linear"].items()}
    scales = {"scale_linear/x": 0.5, "scale_linear/y": 0.4, "scale_angular": 1.0}
    teleop = Teleop(lease="false", axis_angular=own["axis_angular"], **linear, **scales)
    teleop.mux.subscribe("joy_vel", Twist, teleop.plain.append, Quality.EVERY)
    teleop.joy.send(Joystick(0, (1.0, 0.5, 0.0, -0.25), HELD))
    teleop.bus.run(0.05)
    assert teleop.plain == [Twist(0.25, -0.25, 0.4)]


def test_stamped_commands_carry_the_newest_challenge_once_the_lease_allows() -> None:
    teleop = Teleop(lease="true", axis_linear=1)
    challenges = teleop.mux.publish("~challenge", Time)
    lease = teleop.mux.publish("~lease", str, Quality.LATCHED)
    challenges.send(Time(7))
    teleop.move(1.0, HELD)
    assert teleop.stamped == []
    assert any("no mux has sent a lease" in text for _, text in teleop.node.lines)
    lease.send(write_lease(Lease()))
    teleop.move(1.0, HELD)
    teleop.move(1.0, HELD)  # the same answer and the same velocity are not sent again
    assert [(each.stamp, each.twist.forward) for each in teleop.stamped] == [(7, 0.5)]
    lease.send(write_lease(Lease("held", "other", "laptop2", "keys", 1.0)))
    challenges.send(Time(8))
    teleop.move(1.0, HELD)
    teleop.move(1.0, HELD)
    assert [each.stamp for each in teleop.stamped] == [7]
    assert any("laptop2 (keys) drives" in text for _, text in teleop.node.lines)


@pytest.mark.parametrize(
    ("conduct", "way"), [("drive", "UR_LEASE=take lets it take over"), ("take", "press the button")]
)
def test_joystick_that_did_not_get_the_lease_says_what_to_do(
    conduct: str, way: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("UR_LEASE", conduct)
    teleop = Teleop(lease="true", axis_linear=1)
    teleop.mux.publish("~lease", str, Quality.LATCHED).send(write_lease(Lease("lost", "other", "laptop2", "keys", 1.0)))
    teleop.bus.run(0.05)
    teleop.move(1.0, HELD)
    (line,) = (text for _, text in teleop.node.lines if "does not drive" in text)
    assert "laptop2 (keys) drove and is out of reach" in line
    assert way in line


def test_buttons_stop_and_release() -> None:
    teleop = Teleop(lease="false")
    teleop.move(0.0, (0, 1, 0, 0, 0))
    teleop.move(0.0, (0, 1, 1, 0, 0))
    assert teleop.asked == ["stop", "release"]
    assert ("warn", "/cmd_vel_mux/stop: stop") in teleop.node.lines


def test_joystick_of_another_computer_may_stop_and_nothing_else() -> None:
    teleop = Teleop(lease="false", axis_linear=1)
    teleop.mux.subscribe("joy_vel", Twist, teleop.plain.append, Quality.EVERY)
    teleop.bus.hosts["/far"] = "192.0.2.7"
    far = teleop.bus.node("far").publish("joy", Joystick, Quality.EVERY)
    for buttons in ((0, 0, 0, 0, 1), (0, 1, 0, 0, 1), (0, 1, 1, 0, 1)):
        far.send(Joystick(0, (0.0, 1.0), buttons))
        teleop.bus.run(0.05)
    assert teleop.plain == []
    assert teleop.asked == ["stop"]


def test_request_to_a_mux_that_is_not_there_is_reported() -> None:
    teleop = Teleop(lease="false")
    teleop.mux.end("the test needs none")
    teleop.move(0.0, (0, 1, 0, 0, 0))
    teleop.bus.run(31.0)  # a stop may be late
    (line,) = [text for level, text in teleop.node.lines if level == "error"]
    assert line.startswith("/cmd_vel_mux/stop: ")
    assert line.endswith(", expected the answer of a cmd_vel_mux")


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("deadzone", 2, "parameter /joy_node/deadzone: 2, expected a number from 0 to 0.9"),
        ("autorepeat_rate", -1, "expected a number from 0 to 200"),
    ],
)
def test_parameters_that_the_reader_cannot_use_are_named(name: str, value: object, message: str) -> None:
    bus = Bus()
    bus.parameters[f"/joy_node/{name}"] = value
    with pytest.raises(UserError, match=message):
        start_joy(bus.node("joy_node"))


def test_parameters_that_the_teleop_cannot_use_are_named() -> None:
    with pytest.raises(UserError, match="/scale_linear/w: 1, expected one of x, y, z"):
        Teleop(**{"scale_linear/w": 1})
    with pytest.raises(UserError, match="'A', expected a whole number of at least -1"):
        Teleop(enable_turbo_button="A")
