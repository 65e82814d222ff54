"""Who sees a secret: command lines and environments of all processes, all files that were written, the logs."""

from __future__ import annotations

import os
import socket
import struct
import subprocess
import threading
import time
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from tests.hosts.bench import Machine

# The kernel tells who starts a program: linux/netlink.h, linux/connector.h, linux/cn_proc.h.
_NETLINK_CONNECTOR, _CN_IDX_PROC, _CN_VAL_PROC, _LISTEN, _EVENT_EXEC = 11, 1, 1, 1, 2
_HEADERS = 36  # bytes: of netlink and of the connector
_SO_RCVBUFFORCE = 33
# What is written to while a computer runs; /tmp and /run are in memory.
_PLACES = "/tmp /run /dev/shm"


@dataclass
class Watcher:
    """Looks, while it is entered, for texts in the command line and environment of each process that starts a program.

    The kernel tells of each at once, so that those that live for some milliseconds only are seen too. Everybody is
    looked at twice a second: who changes the own command line. `seen` holds what was found, `looked` counts programs.
    """

    texts: tuple[str, ...]
    seen: set[str] = field(default_factory=set)
    looked: int = 0

    def __enter__(self) -> Watcher:
        self._socket = socket.socket(socket.AF_NETLINK, socket.SOCK_DGRAM, _NETLINK_CONNECTOR)
        self._socket.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, 1 << 24)
        self._socket.bind((0, _CN_IDX_PROC))
        message = struct.pack("=IIIIHHI", _CN_IDX_PROC, _CN_VAL_PROC, 0, 0, 4, 0, _LISTEN)
        self._socket.send(struct.pack("=IHHII", 16 + len(message), 3, 0, 0, os.getpid()) + message)
        self._socket.settimeout(0.1)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._watch)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self._socket.close()

    def _watch(self) -> None:
        everybody = 0.0
        while not self._stop.is_set():
            with suppress(TimeoutError):
                data = self._socket.recv(4096)
                event, number = struct.unpack_from("=I12xI", data, _HEADERS)
                if event == _EVENT_EXEC:
                    self.looked += 1
                    self._look_at(number)
            if time.monotonic() > everybody:
                for entry in Path("/proc").iterdir():
                    if entry.name.isdigit():
                        self._look_at(int(entry.name))
                everybody = time.monotonic() + 0.5

    def _look_at(self, number: int) -> None:
        for part in ("cmdline", "environ"):
            with suppress(OSError):  # it has ended
                content = Path(f"/proc/{number}/{part}").read_bytes()
                if any(text.encode() in content for text in self.texts):
                    self.seen.add(content.decode(errors="replace"))


def find_written(machine: Machine, texts: Iterable[str]) -> list[str]:
    """The files written on a computer since it was made that hold one of these texts, and such lines of its log.

    Its shared root is the same for all, so what was written lies in the upper layer of its file system.
    """
    words = list(texts)
    done = machine.run(f"grep -rlaFs -D skip -f - {_PLACES}", stdin=_lines(words))
    upper = machine.root.parent / "upper"
    here = subprocess.run(
        ["grep", "-rlaFs", "-D", "skip", "-f", "-", str(upper)],
        input=_lines(words),
        capture_output=True,
        text=True,
        check=False,
    )
    said = [line for line in machine.journal().splitlines() if any(word in line for word in words)]
    return done.out.splitlines() + here.stdout.splitlines() + said


def _lines(words: Iterable[str]) -> str:
    """Patterns for the standard input of grep: on its command line it would find itself."""
    return "".join(f"{word}\n" for word in words)
