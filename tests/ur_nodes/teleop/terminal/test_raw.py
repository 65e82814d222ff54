import contextlib
import fcntl
import os
import select
import struct
import termios
import time
from collections.abc import Iterator
from dataclasses import dataclass

import pytest

from ur_nodes.teleop.terminal.raw import own_terminal


@dataclass
class Pty:
    """Both ends of a terminal of 80 x 24."""

    user: int
    program: int

    def written(self, until: bytes = b"", limit: float = 5.0) -> bytes:
        """What the program wrote, up to and with `until`, else all that is there."""
        data, deadline = b"", time.monotonic() + limit
        while time.monotonic() < deadline:
            if not select.select([self.user], [], [], 0.05 if until else 0.0)[0]:
                if not until:
                    break
                continue
            data += os.read(self.user, 65536)
            if until and until in data:
                break
        return data


@pytest.fixture
def pty() -> Iterator[Pty]:
    user, program = os.openpty()
    fcntl.ioctl(program, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 80, 0, 0))
    yield Pty(user, program)
    for end in (user, program):
        with contextlib.suppress(OSError):
            os.close(end)


def test_keys_come_at_once_and_unechoed(pty: Pty) -> None:
    with own_terminal(pty.program, pty.program) as terminal:
        pty.written()
        os.write(pty.user, b"i\x03")
        assert terminal.read(5.0) == b"i\x03"
        assert pty.written() == b""


def test_terminal_is_restored_after_the_end(pty: Pty) -> None:
    before = termios.tcgetattr(pty.program)
    with own_terminal(pty.program, pty.program):
        assert termios.tcgetattr(pty.program) != before
    assert termios.tcgetattr(pty.program) == before
    end = pty.written()
    for sequence in (b"\x1b[<u", b"\x1b[?1004l", b"\x1b[?25h", b"\x1b[?1049l"):
        assert sequence in end


@pytest.mark.parametrize("problem", [RuntimeError, KeyboardInterrupt, SystemExit])
def test_terminal_is_restored_after_an_exception(pty: Pty, problem: type[BaseException]) -> None:
    before = termios.tcgetattr(pty.program)
    with pytest.raises(problem), own_terminal(pty.program, pty.program):
        raise problem
    assert termios.tcgetattr(pty.program) == before
    assert b"\x1b[?1049l" in pty.written()


def test_terminal_that_is_gone_reads_as_none(pty: Pty) -> None:
    with own_terminal(pty.program, pty.program) as terminal:
        os.close(pty.user)
        assert terminal.read(5.0) is None
        terminal.show(["nobody sees this"])


def test_only_changed_lines_are_sent(pty: Pty) -> None:
    with own_terminal(pty.program, pty.program) as terminal:
        terminal.show(["one", "two"])
        pty.written()
        terminal.show(["one", "two"])
        assert pty.written() == b""
        terminal.show(["one", "2"])
        assert pty.written() == b"\x1b[2;1H2\x1b[K"
        terminal.show(["one", "2"], again=True)
        assert b"one" in pty.written()


def test_size_is_that_of_the_moment(pty: Pty) -> None:
    with own_terminal(pty.program, pty.program) as terminal:
        assert terminal.size() == (80, 24)
        fcntl.ioctl(pty.program, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 132, 0, 0))
        assert terminal.size() == (132, 40)
