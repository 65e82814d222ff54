"""Runs a program in a new tmux pane while it stays our child: `debug_pane.py NAME PROGRAM [ARG ...]`.

A pane's own processes belong to the tmux server, so a run could neither signal nor outlive them. Here the pane holds
only a relay; the program has a pseudo terminal of its own, whose other end the relay is given. Uses the standard
library only: it is started as a file, in the environment of the node.
"""

from __future__ import annotations

import contextlib
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
import tty

PATIENCE = 10.0  # s for the pane to open
RELAY = "--relay"


def main(words: list[str]) -> int:
    """Run a program in a pane, or be that pane's relay. Returns the program's exit code, 128 + n for signal n."""
    if words[0] == RELAY:
        return relay(words[1])
    return run_in_pane(words[0], words[1:])


def run_in_pane(name: str, words: list[str]) -> int:
    """Open the pane, run the program in it, wait for its end."""
    controller, end = pty.openpty()
    with tempfile.TemporaryDirectory(prefix="ur-pane-") as folder, socket.socket(socket.AF_UNIX) as listener:
        address = f"{folder}/pane"
        listener.bind(address)
        listener.listen(1)
        listener.settimeout(PATIENCE)
        inside = shlex.join([sys.executable, __file__, RELAY, address])
        try:
            subprocess.run(["tmux", "split-window", "-h", inside], check=True, stdin=subprocess.DEVNULL)
            link, _ = listener.accept()
        except (OSError, subprocess.CalledProcessError) as problem:
            sys.stderr.write(f"error: {name}: no tmux pane could be opened: {problem}\n")
            return 1
    with link:
        socket.send_fds(link, [b"pane"], [controller])
        os.close(controller)
        return _run_on(words, end)


def relay(address: str) -> int:
    """In the pane: copy between its terminal and the program's, until the program ends."""
    with socket.socket(socket.AF_UNIX) as link:
        link.connect(address)
        _, descriptors, _, _ = socket.recv_fds(link, 16, 1)
        controller = descriptors[0]
        _copy_size(controller)
        signal.signal(signal.SIGWINCH, lambda *_: _copy_size(controller))
        before = termios.tcgetattr(0)
        tty.setraw(0)
        try:
            _copy(controller)
        finally:
            termios.tcsetattr(0, termios.TCSADRAIN, before)
    return 0


def _run_on(words: list[str], end: int) -> int:
    def own_terminal() -> None:
        os.setsid()
        fcntl.ioctl(0, termios.TIOCSCTTY, 0)

    try:
        process = subprocess.Popen(words, stdin=end, stdout=end, stderr=end, preexec_fn=own_terminal)
    except OSError as problem:
        sys.stderr.write(f"error: {words[0]}: {(problem.strerror or '').lower()}\n")
        return 127
    os.close(end)

    def forward(signum: int, _frame: object) -> None:
        # A debugger takes SIGINT for a pause and goes on: whoever ends the run means its end.
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
