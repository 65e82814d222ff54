"""The folder of recordings: names of files, their list, their removal, and the recorder's lock.

File names consist of the local time at which the recording began, and the number of the part:
`2026-03-01_14-05-31_0.bag`. One whose recorder was killed is incomplete: `2026-03-01_14-05-31_0_cut.bag`.
"""

from __future__ import annotations

import fcntl
import os
import re
import time
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ur.source.replace import PRIVATE
from ur.source.user_folders import user_folder

_NAME = re.compile(r"(\d{4}-\d\d-\d\d_\d\d-\d\d-\d\d)_(\d{1,4})(_cut)?", re.ASCII)
_TIME = "%Y-%m-%d_%H-%M-%S"
_CUT = "_cut"
_LOCK = "lock"


class RecordingBusyError(Exception):
    """Another process is recording."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """A complete file. `size` in bytes, `started` in seconds since 1970. `cut`: its end is missing."""

    name: str
    size: int
    started: float
    part: int
    cut: bool


def recordings_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder of recordings of the user with this environment. It may not exist."""
    return Path(user_folder("XDG_STATE_HOME", environment), "ubiquity_launches", "web", "recordings")


def choose_stem(now: float, names: Collection[str]) -> str:
    """Return the stem for the file names of a new recording, which no file has yet."""
    while any(name.startswith(_format(now)) for name in names):
        now += 1.0
    return _format(now)


class Store:
    """Files with an ending, such as `.bag`; incomplete ones have another ending, such as `.bag.active`."""

    def __init__(self, folder: Path, ending: str, unfinished: str) -> None:
        self.folder, self._ending, self._unfinished = folder, ending, unfinished

    def list(self) -> tuple[Recorded, ...]:
        """List the complete files, the newest first."""
        found = [_describe(name.removesuffix(self._ending), name, size) for name, size in self._sizes().items()]
        return tuple(sorted((each for each in found if each), key=lambda each: each.name, reverse=True))

    def find(self, name: object) -> Path | None:
        """Return the path of a listed file; None for any other name."""
        return next((self.folder / each.name for each in self.list() if each.name == name), None)

    def measure(self, stem: str = "") -> int:
        """Return the bytes of all files, or of those whose names begin with `stem`, complete or not."""
        return sum(size for name, size in self._sizes().items() if name.startswith(stem))

    def free(self) -> int:
        """Return the bytes that are free on the disk for a user."""
        found = os.statvfs(self.folder)
        return found.f_bavail * found.f_frsize

    def prepare(self) -> None:
        """Create the folder with access for its user only. Raises OSError."""
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        self.folder.chmod(0o700)

    def new_stem(self) -> str:
        """Return the stem for the file names of a recording that begins now."""
        return choose_stem(time.time(), self._sizes())

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Hold the lock for recording. Raises RecordingBusyError while another process holds it, or OSError."""
        descriptor = os.open(self.folder / _LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, PRIVATE)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        except BlockingIOError:
            raise RecordingBusyError from None
        finally:
            os.close(descriptor)

    def adopt(self) -> None:
        """Add files that a killed recorder has left to the list. The caller must hold the lock."""
        for name in self._sizes():
            stem = name.removesuffix(self._unfinished)
            if name.endswith(self._unfinished) and _NAME.fullmatch(stem):
                with suppress(OSError):
                    (self.folder / name).rename(self.folder / f"{stem}{_CUT}{self._ending}")

    def _sizes(self) -> dict[str, int]:
        """Return the sizes of recordings by name. Symbolic links are ignored."""
        sizes: dict[str, int] = {}
        with suppress(OSError), os.scandir(self.folder) as entries:
            for entry in entries:
                with suppress(OSError):
                    if entry.name.endswith((self._ending, self._unfinished)) and entry.is_file(follow_symlinks=False):
                        sizes[entry.name] = entry.stat(follow_symlinks=False).st_size
        return sizes


def _describe(stem: str, name: str, size: int) -> Recorded | None:
    match = _NAME.fullmatch(stem)
    if match is None or name == stem:
        return None
    try:
        started = time.mktime(time.strptime(match[1], _TIME))
    except (ValueError, OverflowError):
        return None
    return Recorded(name, size, started, int(match[2]) + 1, match[3] is not None)


def _format(now: float) -> str:
    return time.strftime(_TIME, time.localtime(now))
