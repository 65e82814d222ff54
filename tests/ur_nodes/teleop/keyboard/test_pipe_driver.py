"""Keys of a pipe on a bus."""

import os
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.ur_nodes.motion.mux_robot import LeaseDriver, MuxRobot
from tests.ur_nodes.teleop.keyboard.rig import AHEAD, LEFT, RATE, SETTINGS, STILL, Rig

from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Twist
from ur_nodes.teleop.keyboard.pipe_driver import PipeDriver, drive_by_pipe
from ur_nodes.teleop.terminal.keys import decode_keys

pytestmark = pytest.mark.usefixtures("home")


class Pipe(Rig):
    """The driver of a pipe."""

    def __init__(self, bus: Bus | None = None, topic: str = "cmd_vel") -> None:
        super().__init__(bus, topic=topic)
        self.driver = PipeDriver(self.node, SETTINGS, RATE, self.commander)

    def press(self, keys: bytes) -> None:
        self.driver.press(decode_keys(keys, final=True)[0])
        self.driver.close()


def test_each_key_drives_for_half_a_second_and_the_end_stops() -> None:
    pipe = Pipe()
    pipe.press(b"i\nj\n")
    assert pipe.bus.run_until(lambda: pipe.driver.ended, 10.0)
    assert pipe.changes == [AHEAD, LEFT, STILL]
    assert pipe.sent.count(AHEAD) == pytest.approx(0.5 * RATE, abs=1)
    assert pipe.sent.count(LEFT) == pytest.approx(0.5 * RATE, abs=1)
    assert pipe.sent.count(STILL) == 3


def test_speed_keys_take_no_time_and_ctrl_c_ends() -> None:
    pipe = Pipe()
    pipe.press(b"zi\x03i")
    assert pipe.bus.run_until(lambda: pipe.driver.ended, 10.0)
    assert pipe.changes == [Twist(0.4 * 0.9, 0.0), STILL]


def test_first_key_waits_for_a_subscriber_and_then_drives_with_a_warning() -> None:
    bus = Bus()
    pipe = Pipe(bus)
    for listener in list(bus.topics["/cmd_vel"].subscribers):
        bus.topics["/cmd_vel"].subscribers.remove(listener)
    pipe.press(b"i")
    bus.run(4.9)
    assert (pipe.driver.busy, pipe.driver.warning) == (True, "")
    bus.run(0.3)
    assert pipe.driver.warning == "no subscriber on /cmd_vel after 5 s; is the robot running? Driving anyway"
    assert bus.run_until(lambda: pipe.driver.ended, 2.0)


def test_commands_come_as_often_as_challenges_while_these_come(home: Path) -> None:
    robot = MuxRobot(home)
    pipe, stamps = Pipe(robot.bus, "key_vel"), list[int]()
    robot.person.subscribe("key_vel_stamped", StampedTwist, lambda sent: stamps.append(sent.stamp), Quality.EVERY)
    pipe.press(b"ii")
    assert robot.bus.run_until(lambda: len(stamps) > 10, 10.0)
    del stamps[:]
    robot.bus.run(0.5)
    assert len(stamps) == len(set(stamps)) == pytest.approx(25, abs=2)


def test_pipe_drives_through_the_mux(home: Path) -> None:
    robot = MuxRobot(home)
    pipe = Pipe(robot.bus, "key_vel")
    pipe.press(b"i")
    assert robot.bus.run_until(lambda: pipe.driver.ended, 10.0)
    robot.bus.run(0.5)
    assert max(twist.forward for _, twist in robot.outputs) > 0.2
    assert robot.outputs[-1][1] == STILL
    assert pipe.driver.problem == ""


def test_pipe_does_not_drive_while_another_client_does(home: Path) -> None:
    robot = MuxRobot(home)
    other = LeaseDriver(robot.bus, "a")
    other.lease.acquire()
    robot.bus.run(0.5)
    pipe = Pipe(robot.bus, "key_vel")
    pipe.press(b"i")
    assert robot.bus.run_until(lambda: pipe.driver.ended, 20.0)
    assert pipe.driver.problem.startswith("a-host (test) drives the robot since ")
    assert pipe.driver.problem.endswith("; expected a robot that no client drives (UR_LEASE=take takes over)")
    assert not any(twist.forward for _, twist in robot.outputs)


def test_pipe_to_a_mux_that_sends_no_challenges_is_refused_after_ten_seconds() -> None:
    bus = Bus()
    bus.parameters["/keys/lease"] = "true"
    pipe = Pipe(bus)
    pipe.press(b"i")
    bus.run(14.5)
    assert not pipe.driver.ended
    bus.run(1.0)
    assert pipe.driver.problem.startswith("no challenge from the mux")
    assert pipe.sent == []


def run_beside(pipe: Pipe, source: int, ended: threading.Event, until: Callable[[], bool]) -> list[int]:
    """The exit code of `drive_by_pipe`, while the bus runs."""
    codes: list[int] = []
    thread = threading.Thread(target=lambda: codes.append(drive_by_pipe("keys", source, pipe.driver, ended)))
    thread.start()
    while thread.is_alive():
        pipe.bus.run(0.05)
        if until():
            ended.set()
        thread.join(0.001)
    return codes


def test_keys_are_read_to_the_end_of_the_pipe() -> None:
    source, sink = os.pipe()
    os.write(sink, b"i\nj\n")
    os.close(sink)
    pipe = Pipe()
    assert run_beside(pipe, source, threading.Event(), lambda: False) == [0]
    os.close(source)
    assert pipe.changes == [AHEAD, LEFT, STILL]


def test_pipe_that_stays_open_is_left_when_the_program_has_to_end() -> None:
    source, sink = os.pipe()
    os.write(sink, b"i")
    pipe = Pipe()
    assert run_beside(pipe, source, threading.Event(), lambda: STILL in pipe.sent) == [0]
    assert not pipe.driver.ended
    os.close(sink)
    os.close(source)


def test_refusal_is_an_error_and_an_exit_code(capsys: pytest.CaptureFixture[str]) -> None:
    pipe = Pipe()
    pipe.driver.problem, pipe.driver.ended, pipe.driver.warning = "it must not", True, ""
    assert drive_by_pipe("keys", -1, pipe.driver, threading.Event()) == 1
    assert capsys.readouterr().err == "error: keys: it must not\n"
