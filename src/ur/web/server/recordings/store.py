"""The folder of recordings: names of files, their list, their removal, and the recorder's lock.

File names are those of `ur record`: `recording_2026-03-01_14-05-31_001.mcap`. One whose recorder was killed is
incomplete: `recording_2026-03-01_14-05-31_001_cut.mcap`.
"""

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

_NAME = re.compile(r"recording_(\d{4}-\d\d-\d\d_\d\d-\d\d-\d\d)_(\d{3,4})(_cut)?", re.ASCII)
_TIME = "%Y-%m-%d_%H-%M-%S"
_CUT = "_cut"
_ENDING, _UNFINISHED = ".mcap", ".mcap.part"
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


class Store:
    """The files; incomplete ones have another ending."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def list(self) -> tuple[Recorded, ...]:
        """List the complete files, the newest first."""
        found = [_describe(name.removesuffix(_ENDING), name, size) for name, size in self._sizes().items()]
        return tuple(sorted((each for each in found if each), key=lambda each: each.name, reverse=True))

    def find(self, name: object) -> Path | None:
        """Return the path of a listed file; None for any other name."""
        return next((self.folder / each.name for each in self.list() if each.name == name), None)

    def names(self) -> Collection[str]:
        """Return the names of all files, complete or not."""
        return self._sizes().keys()

    def measure(self, without: Collection[str] = ()) -> int:
        """Return the bytes of all files but those of some names, complete or not."""
        return sum(size for name, size in self._sizes().items() if name not in without)

    def prepare(self) -> None:
        """Create the folder with access for its user only. Raises OSError."""
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        self.folder.chmod(0o700)

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
            stem = name.removesuffix(_UNFINISHED)
            if name.endswith(_UNFINISHED) and _NAME.fullmatch(stem):
                with suppress(OSError):
                    (self.folder / name).rename(self.folder / f"{stem}{_CUT}{_ENDING}")

    def _sizes(self) -> dict[str, int]:
        """Return the sizes of recordings by name. Symbolic links are ignored."""
        sizes: dict[str, int] = {}
        with suppress(OSError), os.scandir(self.folder) as entries:
            for entry in entries:
                with suppress(OSError):
                    if entry.name.endswith((_ENDING, _UNFINISHED)) and entry.is_file(follow_symlinks=False):
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
    return Recorded(name, size, started, int(match[2]), match[3] is not None)
