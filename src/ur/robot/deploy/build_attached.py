"""Program that runs a command line in a login shell and ends all of its processes when its standard input closes.

It is sent to computers on which this project need not be installed: one file that uses only the standard library. So a
command over ssh ends with Ctrl-C, with ssh and with the terminal, and leaves no process running, without a terminal on
the remote computer. Run as a program: python -I build_attached.py COMMAND-LINE.
"""

import os
import queue
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from pathlib import Path

# Not SIGINT: catkin_make would print a traceback. make deletes incomplete files after either signal.
STEPS = ((signal.SIGTERM, 5.0), (signal.SIGKILL, 5.0))


def main() -> int:
    """Run the command; return its exit code, or 130 if it was ended."""
    to_end: queue.SimpleQueue[None] = queue.SimpleQueue()  # a signal may come while another one is put in
    ended = threading.Event()

    def watch() -> None:
        with suppress(OSError):
            while os.read(0, 4096):
                pass
        to_end.put(None)

    def end() -> None:
        to_end.get()
        if not ended.is_set():
            _end(process.pid)

    # A signal that ends this program ends the command first, also one that arrives while the command starts.
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: to_end.put(None))
    # A separate process group: the children of the command are in it too, and end with it.
    process = subprocess.Popen(["bash", "-lc", sys.argv[1]], stdin=subprocess.DEVNULL, start_new_session=True)
    for each in (watch, end):
        threading.Thread(target=each, daemon=True).start()
    code = process.wait()
    ended.set()
    _end(process.pid)  # processes that the command left running
    return code if code >= 0 else 128 - code


def _end(group: int) -> None:
    for number, patience in STEPS:
        try:
            os.killpg(group, number)
        except (ProcessLookupError, PermissionError):
            return
        limit = time.monotonic() + patience
        while time.monotonic() < limit:
            if not _is_running(group):
                return
            time.sleep(0.05)


def _is_running(group: int) -> bool:
    """Return whether a process group has running members.

    A member that ended and waits for init to reap it does not count.
    """
    for entry in Path("/proc").iterdir():
        with suppress(OSError):
            if entry.name.isdigit():
                state, _, its_group = (entry / "stat").read_text().rpartition(")")[2].split()[:3]
                if int(its_group) == group and state not in ("Z", "X"):
                    return True
    return False


if __name__ == "__main__":
    sys.exit(main())
