"""The guard process on a pseudo-terminal: what the boards' motors get when the process of the driver dies or stalls."""

from __future__ import annotations

import os
import signal
import threading
from pathlib import Path

import pytest
from tests.ur_nodes.drivers.guarded import GuardedBoard
from tests.ur_nodes.drivers.rig import one_of
from tests.ur_nodes.drivers.threads import ThreadedNode

from ur_nodes.drivers.boards import BOARDS
from ur_nodes.drivers.lines import guard_program
from ur_nodes.drivers.lines.line import LineSettings, LineUser
from ur_nodes.drivers.lines.serial_line import SerialLine
from ur_nodes.simulator.devices.terminal import DeviceTerminal


@pytest.mark.parametrize("name", one_of(BOARDS, "magni"))
def test_motors_stop_when_the_driver_stalls_or_is_killed_and_not_before(name: str, tmp_path: Path) -> None:
    with GuardedBoard(name, tmp_path / "device") as board:
        board.run_until(lambda: len(board.turned) > 10)
        assert all(speeds != (0.0, 0.0) for speeds in board.turned[2:])
        for sent in (signal.SIGSTOP, signal.SIGKILL):
            os.kill(board.driver.pid, sent)
            board.run_until(lambda: board.rests)
            os.kill(board.driver.pid, signal.SIGCONT)
            if sent is signal.SIGSTOP:
                board.run_until(lambda: not board.rests)


def test_neato_leaves_test_mode_when_its_driver_is_killed(tmp_path: Path) -> None:
    with GuardedBoard("neato", tmp_path / "device") as board:
        board.run_until(lambda: len(board.turned) > 10)
        assert board.firmware.test_mode
        board.driver.kill()
        board.run_until(lambda: not board.firmware.test_mode)


def test_guard_stops_the_motors_when_speeds_stay_away_and_when_the_pipe_ends() -> None:
    (theirs, ours), (out, device) = os.pipe(), os.pipe()
    guard = threading.Thread(target=guard_program.main, args=(theirs, device, b"STOP", b"LEAVE"))
    guard.start()
    os.write(ours, b"mrm")
    assert os.read(out, 100) == b"STOP"
    os.write(ours, b"r")
    os.close(ours)
    assert os.read(out, 100) == b"STOPLEAVE"
    guard.join(20.0)
    assert not guard.is_alive()
    for each in (theirs, out, device):
        os.close(each)


def test_guard_of_a_line_stops_the_device_when_the_line_is_closed(tmp_path: Path) -> None:
    terminal = DeviceTerminal(tmp_path / "device")
    opened = threading.Event()
    user = LineUser(opened.set, lambda _data, _stamp: None, lambda _reason: None)
    line = SerialLine(ThreadedNode(), str(terminal.path), user, LineSettings(115200, b"STOP"))  # type: ignore[arg-type]
    assert opened.wait(20.0)
    line.write(b"go", moving=True)
    line.close()
    data = b""
    for _ in range(2000):
        data += terminal.read()
        if data == b"goSTOP":
            break
        opened.clear()
        opened.wait(0.01)
    terminal.close()
    assert data == b"goSTOP"
