"""The guard process on a pseudo-terminal: what the boards' motors get when the process of the driver dies or stalls."""

import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest
from tests.json_client import wait_until
from tests.ur_nodes.drivers.guarded import GuardedBoard
from tests.ur_nodes.drivers.rig import one_of
from tests.ur_nodes.drivers.threads import ThreadedNode

from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.run.host.cgroup import Cgroup, make_cgroup
from ur.run.host.descendants import MOTOR_GUARD
from ur_nodes.drivers.lines import guard_program
from ur_nodes.drivers.lines.line import LineSettings, LineUser
from ur_nodes.drivers.lines.serial_line import MotorGuard, SerialLine
from ur_nodes.drivers.registry import BOARDS
from ur_nodes.simulator.devices.bench import DeviceTerminal


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


def find_guard(board: GuardedBoard) -> psutil.Process:
    """The guard of a board that drives, once it has its name."""
    found: list[psutil.Process] = []

    def is_ready() -> bool:
        children = [each for each in psutil.Process(board.driver.pid).children() if each.status() != "zombie"]
        found[:] = [each for each in children if each.name() == MOTOR_GUARD.decode()]
        return bool(found)

    board.run_until(is_ready)
    return found[0]


def test_guard_ignores_what_ends_a_driver_and_ends_with_it_after_the_motors_rest(tmp_path: Path) -> None:
    with GuardedBoard("create2", tmp_path / "device") as board:
        board.run_until(lambda: len(board.turned) > 10)
        guard = find_guard(board)
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
            guard.send_signal(number)
        board.driver.kill()
        board.run_until(lambda: board.rests)
        board.run_until(lambda: not guard.is_running() or guard.status() == psutil.STATUS_ZOMBIE)


def test_guard_that_is_stopped_is_replaced_by_one_that_stops_the_motors_of_a_killed_driver(tmp_path: Path) -> None:
    with GuardedBoard("create2", tmp_path / "device") as board:
        board.run_until(lambda: len(board.turned) > 10)
        stopped = find_guard(board)
        stopped.suspend()
        board.run_until(lambda: not stopped.is_running() or stopped.status() == psutil.STATUS_ZOMBIE)
        assert find_guard(board).pid != stopped.pid
        board.run_until(lambda: not board.rests)
        board.driver.kill()
        board.run_until(lambda: board.rests)


def test_oom_killer_chooses_a_driver_before_its_guard(tmp_path: Path) -> None:
    with GuardedBoard("create2", tmp_path / "device") as board:
        guard = find_guard(board)

        def is_lower() -> bool:
            scores = [int(Path(f"/proc/{pid}/oom_score_adj").read_text()) for pid in (guard.pid, board.driver.pid)]
            return scores[0] < scores[1] and scores[0] <= 0

        board.run_until(is_lower)


def test_guard_outlives_the_control_group_of_its_run(tmp_path: Path) -> None:
    run = make_cgroup(os.getpid())
    if run is None:
        pytest.skip("no cgroup (v2) can be made here")
    try:
        with GuardedBoard("create2", tmp_path / "device", group=run) as board:
            board.run_until(lambda: len(board.turned) > 10)
            guard = find_guard(board)
            if board.driver.pid not in run.list_processes():
                pytest.skip("processes may not be moved here")
            board.run_until(lambda: guard.pid not in run.list_processes())
            run.kill()
            board.run_until(lambda: board.rests)
    finally:
        run.kill()
        assert Cgroup(run.path).remove(60)


def test_each_board_of_a_base_has_a_watchdog_or_is_known_to_drive_on() -> None:
    bases = {name for name, driver in OWN_DRIVERS.items() if not driver.sensor}
    assert bases == set(BOARDS)
    assert {name for name in bases if OWN_DRIVERS[name].drives_on} == {"create2", "loki"}


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


@pytest.fixture
def unit_socket(tmp_path: Path) -> Iterator[socket.socket]:
    """What systemd does for the socket of `ur boot install`: it listens."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
        listener.bind(str(tmp_path / "guard"))
        listener.listen()
        yield listener


def test_guard_in_a_unit_of_its_own_stops_the_motors_of_the_driver_that_connects(unit_socket: socket.socket) -> None:
    def start(*_: object) -> tuple[int, int]:
        raise AssertionError

    out, device = os.pipe()
    guard = MotorGuard(device, b"STOP", b"LEAVE", start, unit_socket.getsockname())
    connection, _ = unit_socket.accept()
    with subprocess.Popen([sys.executable, guard_program.__file__], stdin=connection.fileno()) as unit:
        connection.close()
        guard.report(moving=True)
        assert os.read(out, 100) == b"STOP"
        guard.close()
        assert os.read(out, 100) == b"STOPLEAVE"
    assert unit.returncode == 0
    for each in (out, device):
        os.close(each)


def test_driver_starts_a_guard_where_that_of_the_unit_stops_reading(unit_socket: socket.socket) -> None:
    theirs, ours = os.pipe()
    guard = MotorGuard(ours, b"STOP", b"", lambda *_: (os.dup(ours), 0), unit_socket.getsockname())
    connection, _ = unit_socket.accept()
    unit_socket.close()  # the unit cannot be started again
    with connection:
        wait_until(lambda: not guard.report(moving=True), 20.0, "that it is noticed")
    assert os.read(theirs, 100) == b"STOP"
    guard.close()
    for each in (theirs, ours):
        os.close(each)


def test_driver_stops_the_motors_and_starts_a_guard_itself_where_that_of_the_unit_ended(
    unit_socket: socket.socket,
) -> None:
    theirs, ours = os.pipe()
    guard = MotorGuard(ours, b"STOP", b"", lambda *_: (os.dup(ours), 0), unit_socket.getsockname())
    unit_socket.accept()[0].close()
    assert not guard.report(moving=True)
    assert os.read(theirs, 100) == b"STOP"
    assert guard.report(moving=True)
    assert os.read(theirs, 100) == b"m"
    guard.close()
    for each in (theirs, ours):
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
