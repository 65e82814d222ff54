"""`ur launch` on a terminal: the interface is a process beside the supervisor, and nothing it does harms the run."""

import fcntl
import os
import signal
import struct
import termios
import time

import psutil
import pytest
from tests.run.conftest import Launched, RunWorld

pytestmark = pytest.mark.ros
BODY = '<node pkg="little_nodes" type="sleeper" name="one"/>'


def start(world: RunWorld, *words: str, size: tuple[int, int] = (100, 30)) -> Launched:
    world.environment["TERM"] = "xterm-256color"
    launched = world.launch(BODY, *words, terminal=True)
    fcntl.ioctl(launched.keeper, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
    return launched


def find_viewer(launched: Launched) -> psutil.Process:
    end = time.monotonic() + 60
    while time.monotonic() < end:
        for child in psutil.Process(launched.process.pid).children():
            if "ur.tui" in child.cmdline():
                return child
        launched.read(0.02)
    raise AssertionError(launched.text)


def press(launched: Launched, keys: str) -> None:
    os.write(launched.output, keys.encode())


def is_plain(launched: Launched) -> bool:
    flags = termios.tcgetattr(launched.keeper)[3]
    return bool(flags & termios.ICANON and flags & termios.ECHO)


def test_interface_shows_the_run_and_ctrl_c_ends_it(world: RunWorld) -> None:
    launched = start(world)
    launched.until("\x1b[?1049h", "one", "not ready")
    press(launched, "\x03")
    assert launched.wait() == 0
    assert "\x1b[?1049l" in launched.text
    assert is_plain(launched)
    launched.wait_nothing_left()


def test_interface_that_is_killed_leaves_the_terminal_whole_and_the_run_going(world: RunWorld) -> None:
    launched = start(world)
    launched.until("\x1b[?1049h", "not ready")
    find_viewer(launched).send_signal(signal.SIGKILL)
    launched.until("\x1b[?1049l")
    end = time.monotonic() + 60
    while not (is_plain(launched) and os.tcgetpgrp(launched.output) == launched.process.pid):
        assert time.monotonic() < end
        launched.read(0.02)
    assert launched.process.poll() is None
    press(launched, "\x03")  # a signal again
    assert launched.wait() == 0
    launched.wait_nothing_left()


def test_supervisor_that_is_killed_takes_the_interface_with_it(world: RunWorld) -> None:
    launched = start(world)
    launched.until("\x1b[?1049h", "not ready")
    viewer = find_viewer(launched)
    launched.look()
    assert viewer in launched.seen.values()
    launched.process.kill()
    launched.wait()
    launched.until("\x1b[?1049l")
    launched.wait_nothing_left()  # the interface is among what it has seen


@pytest.mark.parametrize(("words", "size"), [(("--calm",), (100, 30)), ((), (40, 10))])
def test_calm_line_instead_of_a_screen(world: RunWorld, words: tuple[str, ...], size: tuple[int, int]) -> None:
    if not words:
        world.environment |= {"COLUMNS": "40", "LINES": "10"}
    launched = start(world, *words, size=size)
    launched.until("1 starting")
    assert "\x1b[?1049h" not in launched.text
    press(launched, "\x03")
    assert launched.wait() == 0
    assert is_plain(launched)
    launched.wait_nothing_left()


def test_plain_lines_when_asked_for_and_ctrl_c_is_recorded_in_words(world: RunWorld) -> None:
    launched = start(world, "--plain")
    launched.until("[/one] started")
    assert not any("ur.tui" in child.cmdline() for child in psutil.Process(launched.process.pid).children())
    press(launched, "\x03")
    assert launched.wait() == 0
    assert "stopping: Ctrl-C" in launched.text
    ended = world.ur("ps", "--ended")
    assert ended.wait() == 0
    assert ended.text.rstrip().endswith("in a terminal  by Ctrl-C")


def test_run_that_never_begins_does_not_touch_the_screen(world: RunWorld) -> None:
    world.environment["TERM"] = "xterm-256color"
    launched = world.launch('<node pkg="little_nodes" type="missing" name="one"/>', terminal=True)
    assert launched.wait() == 1
    assert "has no executable" in launched.text
    assert "\x1b[?1049h" not in launched.text
    assert is_plain(launched)
