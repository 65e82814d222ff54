from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable, Iterator

import pytest

from ur_nodes.teleop.drive import STILL, DriveSettings, Motion
from ur_nodes.teleop.drive_screen import Link
from ur_nodes.teleop.emergency import MuxView, Wish
from ur_nodes.teleop.teleop_twist_keyboard_node import drive_pipe, drive_terminal
from ur_nodes.teleop.terminal import own_terminal

SETTINGS = DriveSettings(speed=0.4, turn=0.8, speed_limit=0.5, turn_limit=1.0)
FORWARD = Motion(x=0.4)


class FakeMux:
    """A mux that does what it is asked at once."""

    def __init__(self) -> None:
        self.stopped = False
        self.asked: list[Wish] = []

    def view(self) -> MuxView:
        return MuxView(self.stopped)

    def ask(self, wish: Wish) -> None:
        self.asked.append(wish)
        self.stopped = wish == "stop"


class Driver:
    """The program on a terminal of its own; what it published, and the user's end of the terminal."""

    def __init__(self, user: int) -> None:
        self.user = user
        self.sent: list[Motion] = []
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
            drive_terminal(terminal, SETTINGS, 20.0, driver.sent.append, lambda: Link("/cmd_vel", 1), driver.mux, ended)

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
        assert b"let go and the robot stops" in driver.screen


def test_space_stops_the_mux_and_r_releases_it_on_any_terminal() -> None:
    with driving() as driver:
        driver.type(b"i")
        driver.wait(lambda: FORWARD in driver.sent)
        driver.type(b" ")
        driver.wait(lambda: b"EMERGENCY STOP" in driver.screen)
        assert driver.sent[-1] == STILL
        driver.type(b"r")
        driver.wait(lambda: driver.screen.rfind(b"standing still") > driver.screen.rfind(b"EMERGENCY STOP"))
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


def test_pipe_that_stays_open_is_left_when_the_node_has_to_end() -> None:
    source, sink = os.pipe()
    ended, codes = threading.Event(), list[int]()
    reader = threading.Thread(target=lambda: codes.append(drive_pipe(source, SETTINGS, 50.0, lambda _: None, ended)))
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
    sent: list[Motion] = []
    try:
        assert drive_pipe(source, SETTINGS, 50.0, sent.append, threading.Event()) == 0
    finally:
        os.close(source)
    assert [m for i, m in enumerate(sent) if i == 0 or m != sent[i - 1]] == [FORWARD, Motion(yaw=0.8), STILL]
    assert sent.count(FORWARD) > 1
