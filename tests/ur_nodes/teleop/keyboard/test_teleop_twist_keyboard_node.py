from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable, Iterator

import pytest

from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.mux import MuxRequest, MuxView
from ur_nodes.motion.lease.view import Conduct, LeaseView
from ur_nodes.teleop.keyboard.drive import STILL, DriveSettings, Motion
from ur_nodes.teleop.keyboard.drive_screen import Link
from ur_nodes.teleop.keyboard.teleop_twist_keyboard_node import drive_pipe, drive_terminal
from ur_nodes.teleop.terminal.raw import own_terminal
from ur_nodes.teleop.terminal.wake import Wake

SETTINGS = DriveSettings(speed=0.4, turn=0.8, speed_limit=0.5, turn_limit=1.0)
FORWARD = Motion(x=0.4)


class FakeMux:
    """A mux that does what it is asked at once."""

    def __init__(self) -> None:
        self.stopped = False
        self.asked: list[MuxRequest] = []

    def view(self) -> MuxView:
        return MuxView(self.stopped)

    def ask(self, request: MuxRequest) -> None:
        self.asked.append(request)
        self.stopped = request == "stop"


class FakeCommander:
    """A commander that keeps commands in a list. A request about the lease takes effect at once."""

    conduct: Conduct = "drive"

    def __init__(self, lease: LeaseView | None = None) -> None:
        self.wake = Wake()
        self.sent: list[Motion] = []
        self.lease = lease
        self.requests: list[DriverRequest] = []

    def publish(self, motion: Motion) -> None:
        self.sent.append(motion)

    def link(self) -> Link:
        return Link("/cmd_vel", 1)

    def view(self) -> LeaseView | None:
        return self.lease

    def request(self, request: DriverRequest) -> None:
        self.requests.append(request)

    def close(self) -> None:
        pass


class Driver:
    """The program on a terminal of its own; what it published, and the user's end of the terminal."""

    def __init__(self, user: int) -> None:
        self.user = user
        self.commander = FakeCommander()
        self.sent = self.commander.sent
        self.screen = b""
        self.mux = FakeMux()

    def type(self, data: bytes) -> None:
        os.write(self.user, data)

    def wait(self, what: Callable[[], bool], limit: float = 60.0) -> None:
        deadline = time.monotonic() + limit
        while not what():
            assert time.monotonic() < deadline, f"sent {self.sent[-5:]}, screen {self.screen[-300:]!r}"
            time.sleep(0.005)

    def read_screen(self) -> None:
        with contextlib.suppress(OSError):  # the terminal was closed: the end
            while data := os.read(self.user, 65536):
                self.screen += data


@contextlib.contextmanager
def driving() -> Iterator[Driver]:
    user, program = os.openpty()
    driver, ended = Driver(user), threading.Event()

    def run() -> None:
        with own_terminal(program, program) as terminal:
            drive_terminal(terminal, SETTINGS, 20.0, driver.commander, driver.mux, ended)

    threads = [threading.Thread(target=run), threading.Thread(target=driver.read_screen, daemon=True)]
    for thread in threads:
        thread.start()
    try:
        driver.wait(lambda: b"keyboard drive" in driver.screen)
        yield driver
    finally:
        ended.set()
        threads[0].join(60.0)
        os.close(program)
        threads[1].join(5.0)
        os.close(user)
        assert not threads[0].is_alive()


def test_key_drives_and_then_falls_silent_on_a_plain_terminal() -> None:
    with driving() as driver:
        driver.type(b"i")
        driver.wait(lambda: STILL in driver.sent)
        assert driver.sent[0] == FORWARD
        driver.wait(lambda: driver.sent.count(STILL) == 3)
        assert set(driver.sent) == {FORWARD, STILL}


def test_key_that_repeats_faster_than_commands_are_sent_drives_all_the_same() -> None:
    with driving() as driver:
        end = time.monotonic() + 60.0
        while driver.sent.count(FORWARD) < 10:
            assert time.monotonic() < end, driver.sent
            driver.type(b"i")
            time.sleep(0.02)  # 50 repeats a second, 20 commands


def test_release_stops_where_the_terminal_reports_it() -> None:
    with driving() as driver:
        driver.wait(lambda: b"\x1b[>15u\x1b[?u" in driver.screen)
        driver.type(b"\x1b[?15u\x1b[1;1:1A")
        driver.wait(lambda: len(driver.sent) > 5)
        assert set(driver.sent) == {FORWARD}
        asked = driver.screen.count(b"\x1b[?u")
        driver.wait(lambda: driver.screen.count(b"\x1b[?u") > asked)  # wants a sign of life while a key is held
        driver.type(b"\x1b[?15u")
        driver.type(b"\x1b[1;1:3A")
        driver.wait(lambda: driver.sent[-1] == STILL)
        assert b"the robot stops when you let go" in driver.screen


def test_space_stops_the_mux_and_r_releases_it_on_any_terminal() -> None:
    with driving() as driver:
        driver.type(b"i")
        driver.wait(lambda: FORWARD in driver.sent)
        driver.type(b" ")
        driver.wait(lambda: b"EMERGENCY STOP" in driver.screen)
        assert driver.sent[-1] == STILL
        driver.type(b"r")
        driver.wait(lambda: driver.screen.rfind(b" stopped") > driver.screen.rfind(b"EMERGENCY STOP"))
        driver.type(b"\x1b[?15u\x1b[32;1:1u\x1b[32;1:2u\x1b[32;1:3u")  # press, repeat, release, told apart
        driver.wait(lambda: driver.mux.stopped)
        assert driver.mux.asked == ["stop", "release", "stop"]


@pytest.mark.parametrize("end", [b"\x03", b"\x04", b"\x1b[99;5u"])
def test_ctrl_c_ends_in_every_encoding(end: bytes) -> None:
    with driving() as driver:
        driver.type(b"i")
        driver.wait(lambda: bool(driver.sent))
        driver.type(end)
        driver.wait(lambda: b"\x1b[?1049l" in driver.screen)
        assert driver.sent[-1] == STILL


def test_challenge_that_arrives_is_answered_at_once_while_a_key_drives() -> None:
    with driving() as driver:
        driver.type(b"\x1b[?15u")
        driver.wait(lambda: b"the robot stops when you let go" in driver.screen)
        for _ in range(5):
            driver.commander.wake.ring()
        driver.type(b"\x1b[1;1:1A")
        driver.wait(lambda: FORWARD in driver.sent)
        before = len(driver.sent)
        end = time.monotonic() + 60.0
        rung = 0
        while len(driver.sent) < before + 100:
            assert time.monotonic() < end
            driver.commander.wake.ring()
            rung += 1
            time.sleep(0.005)  # 200 challenges a second, against 20 commands without any
            if rung % 20 == 0:
                driver.type(b"\x1b[?15u")  # the terminal is there
        assert rung < 400


def test_screen_names_who_drives_and_keys_request_the_lease() -> None:
    with driving() as driver:
        driver.commander.lease = LeaseView("held", "laptop2", "keyboard_drive", link_age=0.0)
        driver.type(b"i")
        driver.wait(lambda: b"laptop2 (keyboard_drive) drives the robot since" in driver.screen)
        driver.wait(lambda: b"not driving" in driver.screen)
        driver.type(b"ady")
        driver.wait(lambda: driver.commander.requests == ["ask", "take", "grant"])


def test_pipe_that_stays_open_is_left_when_the_node_has_to_end() -> None:
    source, sink = os.pipe()
    ended, codes = threading.Event(), list[int]()
    reader = threading.Thread(target=lambda: codes.append(drive_pipe(source, SETTINGS, 50.0, FakeCommander(), ended)))
    reader.start()
    try:
        ended.set()
        reader.join(60.0)
        assert codes == [0]
    finally:
        os.close(sink)
        reader.join(60.0)
        os.close(source)


def test_pipe_drives_each_key_for_half_a_second() -> None:
    source, sink = os.pipe()
    os.write(sink, b"i\nj\n")
    os.close(sink)
    commander = FakeCommander()
    sent = commander.sent
    try:
        assert drive_pipe(source, SETTINGS, 50.0, commander, threading.Event()) == 0
    finally:
        os.close(source)
    assert [m for i, m in enumerate(sent) if i == 0 or m != sent[i - 1]] == [FORWARD, Motion(yaw=0.8), STILL]
    assert sent.count(FORWARD) > 1
