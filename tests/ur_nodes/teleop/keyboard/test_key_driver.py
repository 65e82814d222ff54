"""Keys to commands on a bus."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.fakes.mux import FakeMux
from tests.ur_nodes.motion.mux_robot import LeaseDriver, MuxRobot
from tests.ur_nodes.teleop.keyboard.rig import AHEAD, RATE, SETTINGS, STILL, Driving
from tests.ur_nodes.teleop.recordings import SAVED, serve_recordings

from ur_nodes.client.mux import MuxLink
from ur_nodes.client.saving import MapSaving, save_recordings
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result, StampedTwist, Time, Twist
from ur_nodes.teleop.keyboard.key_driver import KeyDriver

pytestmark = pytest.mark.usefixtures("home")

KITTY = b"\x1b[?15u"
UP, UP_RELEASED = b"\x1b[1;1:1A", b"\x1b[1;1:3A"


def test_key_drives_at_the_rate_and_then_falls_silent_after_three_zeros() -> None:
    rig = Driving()
    rig.press(b"i", 0.5)
    assert set(rig.sent) == {AHEAD}
    assert len(rig.sent) == pytest.approx(0.5 * RATE, abs=1)
    rig.bus.run(2.0)
    assert rig.changes == [AHEAD, STILL]
    assert rig.sent.count(STILL) == 3


def test_start_and_stop_are_not_kept_waiting() -> None:
    rig = Driving()
    rig.bus.run(0.01)
    rig.press(KITTY + UP, 0.001)
    assert rig.sent == [AHEAD]
    rig.press(UP_RELEASED, 0.001)
    assert rig.sent == [AHEAD, STILL]


def test_key_that_repeats_faster_than_commands_are_sent_drives_all_the_same() -> None:
    rig = Driving()
    for _ in range(100):
        rig.press(b"i", 0.02)  # 50 repeats a second, 20 commands
    assert rig.changes == [AHEAD]
    assert len(rig.sent) == pytest.approx(2.0 * RATE, abs=2)


def test_release_stops_where_the_terminal_reports_it_and_so_does_its_silence() -> None:
    rig = Driving()
    rig.press(KITTY + UP, 0.9)
    assert set(rig.sent) == {AHEAD}
    rig.press(KITTY, 0.9)  # a sign of life
    assert set(rig.sent) == {AHEAD}
    rig.press(UP_RELEASED, 1.0)
    assert rig.changes == [AHEAD, STILL]
    rig.press(UP, 2.0)
    assert rig.changes == [AHEAD, STILL, AHEAD, STILL]
    assert rig.driver.view().state.note == "stopped: the terminal does not answer"


def test_robot_stops_when_the_user_interface_hangs_while_a_key_is_held() -> None:
    rig = Driving()
    rig.press(KITTY + UP, 0.5)
    rig.bus.run(0.35)  # the terminal does not take the screen
    assert rig.sent[-1] == STILL
    rig.bus.run(1.0)
    assert rig.changes == [AHEAD, STILL]
    assert rig.driver.view().state.note == "stopped: the terminal does not take the screen"
    rig.press(UP, 0.1)
    assert rig.sent[-1] == AHEAD


def test_key_that_the_node_takes_late_does_not_drive(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Driving()
    busy = 700_000_000  # ns, longer than a tap drives
    monkeypatch.setattr(rig.node, "post", lambda call: rig.bus.at(rig.bus.now + busy, call))
    rig.press(b"i", 2.0)
    assert rig.driver.view().state.last_key == "i"
    assert AHEAD not in rig.sent


def test_space_stops_the_mux_and_r_releases_it_on_any_terminal() -> None:
    rig = Driving()
    mux = FakeMux(rig.bus)
    rig.bus.run(0.1)
    rig.press(b"i", 0.3)
    rig.press(b" ", 0.2)
    assert rig.sent[-1] == STILL
    assert rig.driver.view().mux.stopped
    rig.press(b"r", 0.1)
    assert not rig.driver.view().mux.stopped
    rig.press(KITTY + b"\x1b[32;1:1u\x1b[32;1:2u\x1b[32;1:3u", 0.1)  # press, repeat, release, told apart
    assert mux.asked == ["stop", "release", "stop"]


@pytest.mark.parametrize("end", [b"\x03", b"\x04", b"\x1b[99;5u"])
def test_ctrl_c_quits_in_every_encoding_and_stops(end: bytes) -> None:
    rig = Driving()
    rig.press(b"i", 0.2)
    rig.press(end, 0.001)
    assert rig.driver.view().state.quit
    assert rig.sent[-1] == STILL


def test_robot_is_stopped_when_the_node_ends_while_a_key_is_held() -> None:
    rig = Driving()
    rig.press(KITTY + UP, 0.2)
    rig.node.end("the master asks for it")
    rig.bus.run(0.1)
    assert rig.sent[-1] == STILL


def test_keys_drive_the_robot_through_its_mux_and_release_the_lease_at_the_end(home: Path) -> None:
    robot = MuxRobot(home)
    rig = Driving(robot.bus, topic="key_vel")
    rig.bus.run(0.5)
    assert rig.driver.view().link.subscribers == 1
    rig.press(KITTY + UP, 0.9)
    assert robot.outputs[-1][1].forward == pytest.approx(0.4)
    view = rig.commander.view()
    assert view is not None
    assert view.mine
    rig.node.end("the user pressed Ctrl-C")
    robot.bus.run(0.5)
    assert robot.outputs[-1][1] == STILL
    assert '"state":"free"' in robot.newest("lease", str)


def test_commands_answer_each_challenge_of_the_mux(home: Path) -> None:
    robot = MuxRobot(home)
    rig = Driving(robot.bus, topic="key_vel")
    stamps: list[int] = []
    challenges: list[int] = []
    robot.person.subscribe("key_vel_stamped", StampedTwist, lambda sent: stamps.append(sent.stamp))
    rig.bus.run(0.5)
    rig.press(KITTY + UP, 0.2)
    robot.person.subscribe("cmd_vel_mux/challenge", Time, lambda time: challenges.append(time.stamp))
    rig.press(b"", 0.5)
    assert len(challenges) > 5
    assert set(challenges[:-1]) <= set(stamps)


def test_screen_names_who_drives_and_keys_request_the_lease(home: Path) -> None:
    robot = MuxRobot(home)
    other = LeaseDriver(robot.bus, "a")
    other.lease.acquire()
    rig = Driving(robot.bus, topic="key_vel")
    rig.bus.run(0.5)
    rig.press(b"i", 0.3)
    line = rig.driver.view().driver
    assert line.text.startswith("a-host (test) drives the robot since")
    assert line.blocked
    assert not any(twist.forward for _, twist in robot.outputs)
    rig.press(b"a", 0.5)
    assert "asked to hand over" in rig.driver.view().driver.text
    other.lease.grant()
    rig.bus.run(0.5)
    assert not rig.driver.view().driver.blocked
    other.lease.take_over()
    rig.bus.run(0.5)
    assert rig.driver.view().driver.blocked
    rig.press(b"d", 0.5)
    assert not rig.driver.view().driver.blocked


def test_s_saves_the_map_and_stops_the_robot() -> None:
    bus = Bus()
    bus.node("slam").serve("save", Trigger, lambda _: Result(True, "flat"))
    rig = Driving(bus)
    saving = MapSaving(rig.node, "save", hint="")
    settings, recording = rig.driver.view().state.settings, save_recordings(rig.node)
    driver = KeyDriver(rig.node, settings, RATE, rig.commander, MuxLink(rig.node, "m"), recording, saving)
    rig.driver = driver
    rig.press(KITTY + UP, 0.2)
    rig.press(b"s", 0.5)
    assert rig.sent[-1] == STILL
    assert driver.view().state.note == "map 'flat' saved"


def test_n_saves_what_happened_and_stops_the_robot() -> None:
    rig = Driving()
    serve_recordings(rig.bus)
    rig.press(KITTY + UP, 0.2)
    rig.press(b"n", 0.5)
    assert rig.sent[-1] == STILL
    assert rig.driver.view().state.note == SAVED


def test_keys_drive_only_while_the_terminal_is_connected() -> None:
    rig, linked = Driving(), [True]
    rig.driver._linked = lambda: linked[0]
    rig.press(KITTY + UP, 0.2)
    assert rig.changes == [AHEAD]
    linked[0] = False
    rig.bus.run(0.06)  # one command later, and nothing of the terminal arrives
    assert rig.changes == [AHEAD, STILL]
    assert "connection" in rig.driver.view().state.note
    rig.press(UP, 0.2)
    assert rig.changes == [AHEAD, STILL]
    linked[0] = True
    rig.press(UP, 0.5)  # keys that the cut has held back
    assert rig.changes == [AHEAD, STILL]
    rig.press(b"", 1.0)
    rig.press(UP, 0.2)
    assert rig.changes == [AHEAD, STILL, AHEAD]


def test_changed_settings_count_for_a_key_that_is_held() -> None:
    rig = Driving()
    rig.press(KITTY + UP, 0.2)
    rig.driver.use(replace(SETTINGS, speed=0.1))
    rig.press(KITTY, 0.2)
    assert rig.changes == [AHEAD, Twist(0.1, 0.0)]
