"""Program that runs another one in a different terminal, as a child of its run, which signals and ends it.

    debug_pane.py NAME PROGRAM [ARG ...]                  opens a tmux pane for it
    debug_pane.py --wait ADDRESS NAME                     lends this terminal to the program that joins
    debug_pane.py --join ADDRESS NAME PROGRAM [ARG ...]   is that program; ADDRESS is a Unix socket
    debug_pane.py --attach PID DEBUGGER [ARG ...]         runs a debugger while the process may be traced

A pane's own processes belong to the tmux server. Here the pane, the window or the terminal holds only a relay; the
program has a pseudo terminal of its own, whose other end the relay is given. Uses the standard library only: it is
started as a file, in the environment of the node.
"""

from __future__ import annotations

import contextlib
import ctypes
import fcntl
import os
import pty
import select
import shlex
import signal
import socket
import subprocess
import sys
import tempfile
import termios
import time
import tty
from collections.abc import Mapping

PATIENCE = 10.0  # s for the pane to open
START_PATIENCE = 60.0  # s for a node to stop and to start again
LOOK_PERIOD = 0.3  # s
RELAY, WAIT, JOIN, ATTACH = "--relay", "--wait", "--join", "--attach"
_PR_SET_PDEATHSIG = 1  # linux/prctl.h
_RESET = b"\x1b[?1049l\x1b[?1000l\x1b[?1002l\x1b[?1006l\x1b[0m\x1b[?25h"  # what a program that was killed left


def main(argv: list[str], patience: float = PATIENCE) -> int:
    """Run a program in another terminal, or be its relay. Returns the program's exit code, 128 + n for signal n."""
    if argv[0] == RELAY:
        return relay(argv[1])
    if argv[0] == WAIT:
        return wait_for(argv[1], argv[2])
    if argv[0] == JOIN:
        return join(argv[1], argv[2], argv[3:], patience)
    if argv[0] == ATTACH:
        return attach(int(argv[1]), argv[2:])
    return run_in_pane(argv[0], argv[1:])


def run_in_pane(name: str, argv: list[str]) -> int:
    """Open the pane, run the program in it, and wait until it ends."""
    controller, end = pty.openpty()
    with tempfile.TemporaryDirectory(prefix="ur-pane-") as folder, socket.socket(socket.AF_UNIX) as listener:
        address = f"{folder}/pane"
        listener.bind(address)
        listener.listen(1)
        listener.settimeout(PATIENCE)
        inside = shlex.join([sys.executable, "-I", __file__, RELAY, address])
        try:
            subprocess.run(["tmux", "split-window", "-h", inside], check=True, stdin=subprocess.DEVNULL)
            link, _ = listener.accept()
        except (OSError, subprocess.CalledProcessError) as problem:
            sys.stderr.write(f"error: {name}: no tmux pane could be opened: {problem}\n")
            return 1
    return _serve(link, controller, argv, end)


def join(address: str, name: str, argv: list[str], patience: float = PATIENCE) -> int:
    """Run the program in the terminal that waits at the address."""
    deadline = time.monotonic() + patience
    while True:
        link = socket.socket(socket.AF_UNIX)
        try:
            link.connect(address)
            break
        except OSError as problem:
            link.close()
            if time.monotonic() > deadline:
                reason = (problem.strerror or str(problem)).lower()
                sys.stderr.write(f"error: {name}: no terminal waits to debug it any more: {reason}\n")
                return 1
            time.sleep(0.05)
    controller, end = pty.openpty()
    return _serve(link, controller, argv, end)


def wait_for(address: str, name: str) -> int:
    """Lend this terminal to the program that joins at the address; Ctrl-C before that cancels."""
    folder = address.rpartition("/")[0]
    os.mkdir(folder, 0o700)  # noqa: PTH102 - what pathlib would do, without its import
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(address)
        listener.listen(1)
        listener.settimeout(START_PATIENCE)
        sys.stdout.write(f"waiting until {name} has stopped and starts in the debugger; Ctrl-C gives up\r\n")
        sys.stdout.flush()
        try:
            link, _ = listener.accept()
        except KeyboardInterrupt:
            return 130
        except OSError:
            sys.stderr.write(f"error: {name} was not started within {START_PATIENCE:g} s\n")
            return 1
        finally:
            with contextlib.suppress(OSError):
                os.unlink(address)  # noqa: PTH108 - likewise
                os.rmdir(folder)  # noqa: PTH106 - likewise
    link.settimeout(None)
    return _relay_on(link)


def attach(pid: int, argv: list[str]) -> int:
    """Run a debugger on a process of another parent, and end it when the process is killed.

    A process that is killed while a debugger holds it stays until the debugger handles it: its run would wait for it.
    """
    for signum in (signal.SIGINT, signal.SIGQUIT):
        signal.signal(signum, lambda *_: None)  # Ctrl-C is for the debugger, which is in this process group
    before = termios.tcgetattr(0) if os.isatty(0) else None
    try:
        process = subprocess.Popen(argv)
    except OSError as problem:
        sys.stderr.write(f"error: {argv[0]}: {(problem.strerror or '').lower()}\n")
        return 127
    dead = 0
    while dead < 2:
        try:
            return process.wait(LOOK_PERIOD)
        except subprocess.TimeoutExpired:  # noqa: PERF203 - a look every third of a second
            dead = dead + 1 if _is_zombie(pid) else 0
    with contextlib.suppress(OSError):  # a process of another user: sudo
        process.kill()
        process.wait()
    if before is not None:
        termios.tcsetattr(0, termios.TCSADRAIN, before)
    sys.stderr.write("\nthe process was killed\n")
    return 0


def _is_zombie(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat", "rb") as file:  # noqa: PTH123 - what pathlib would do, without its import
            return file.read().rpartition(b")")[2].split()[0] == b"Z"
    except OSError:
        return False


def relay(address: str) -> int:
    """Copy between the pane's terminal and the program's, until the program ends."""
    link = socket.socket(socket.AF_UNIX)
    link.connect(address)
    return _relay_on(link)


def _relay_on(link: socket.socket) -> int:
    with link:
        link.sendall(os.environ.get("TERM", "xterm")[:100].encode())
        _, descriptors, _, _ = socket.recv_fds(link, 16, 1)
        if not descriptors:
            return 1
        controller = descriptors[0]
        _copy_size(controller)
        signal.signal(signal.SIGWINCH, lambda *_: _copy_size(controller))
        before = termios.tcgetattr(0)
        tty.setraw(0)
        try:
            _copy(controller)
        finally:
            _write(1, _RESET)
            termios.tcsetattr(0, termios.TCSADRAIN, before)
    return 0


def _serve(link: socket.socket, controller: int, argv: list[str], end: int) -> int:
    with link:
        link.settimeout(PATIENCE)
        try:
            term = link.recv(100).decode("ascii", "replace")  # the program writes to its own terminal, not to this one
        except OSError:
            term = ""
        socket.send_fds(link, [b"pane"], [controller])
        os.close(controller)
        return _run_on(argv, end, {**os.environ, "TERM": term or "xterm"})


def _run_on(argv: list[str], end: int, environment: Mapping[str, str]) -> int:
    libc = ctypes.CDLL(None)

    def own_terminal() -> None:
        os.setsid()
        libc.prctl(_PR_SET_PDEATHSIG, int(signal.SIGKILL), 0, 0, 0)  # a signal to this process is meant for the program
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    try:
        process = subprocess.Popen(argv, stdin=end, stdout=end, stderr=end, env=environment, preexec_fn=own_terminal)
    except OSError as problem:
        sys.stderr.write(f"error: {argv[0]}: {(problem.strerror or '').lower()}\n")
        return 127
    os.close(end)

    def forward(signum: int, _frame: object) -> None:
        # A debugger pauses on SIGINT; a signal from the run is meant to end it.
        wanted = signal.SIGTERM if signum == signal.SIGINT else signum
        with contextlib.suppress(OSError):
            os.killpg(process.pid, wanted)
            os.killpg(process.pid, signal.SIGHUP)

    for signum in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(signum, forward)
    code = process.wait()
    return code if code >= 0 else 128 - code


def _copy(controller: int) -> None:
    while True:
        ready, _, _ = select.select([0, controller], [], [])
        try:
            if controller in ready:
                data = os.read(controller, 65536)
                if not data:
                    return
                _write(1, data)
            if 0 in ready:
                data = os.read(0, 65536)
                if not data:
                    return
                _write(controller, data)
        except OSError:  # EIO: the program has ended
            return


def _write(descriptor: int, data: bytes) -> None:
    while data:
        data = data[os.write(descriptor, data) :]


def _copy_size(controller: int) -> None:
    with contextlib.suppress(OSError):
        fcntl.ioctl(controller, termios.TIOCSWINSZ, fcntl.ioctl(0, termios.TIOCGWINSZ, b"\0" * 8))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit("usage: debug_pane.py NAME PROGRAM [ARG ...]")
    sys.exit(main(sys.argv[1:]))
