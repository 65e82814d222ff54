"""The output of each robot's command: a separate file, which stays until the same command runs again."""

import os
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ur.source.ansi import strip_styles
from ur.source.user_folders import user_folder

TAIL = 4096  # bytes in which the last line is looked for
MOST_BYTES = 1 << 22  # of an output that is printed again; the file has all of it


def logs_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder of these files, below the user's state folder (XDG base directory specification)."""
    return Path(user_folder("XDG_STATE_HOME", environment)) / "ubiquity_launches" / "fleet"


@dataclass(slots=True)
class LogFile:
    """An open file with the output of a command. It is read through its descriptor, since its path may change."""

    path: Path
    descriptor: int

    def read_all(self) -> str:
        """Read the output, or the end of one that is larger than MOST_BYTES."""
        size = os.fstat(self.descriptor).st_size
        return self._read(max(0, size - MOST_BYTES), MOST_BYTES)

    def read_tail(self) -> list[str]:
        """Read the last lines."""
        size = os.fstat(self.descriptor).st_size
        return self._read(max(0, size - TAIL), TAIL).splitlines()

    def size(self) -> int:
        """Return the present number of bytes."""
        return os.fstat(self.descriptor).st_size

    def close(self) -> None:
        """Close the file without deleting it."""
        os.close(self.descriptor)

    def _read(self, start: int, size: int) -> str:
        text = os.pread(self.descriptor, size, start).decode(errors="replace")
        return strip_styles(text.replace("\r\n", "\n").replace("\r", "\n"))


def open_log(folder: Path, command: str, robot: str, kind: str = "log") -> LogFile:
    """Open a new file for the output of a command on a robot.

    Only this user may read it. Raises OSError. An existing file is replaced: a process that still writes to it is not
    affected.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    path = folder / f"{_name(command)}-{_name(robot)}.{kind}"
    with suppress(FileNotFoundError):
        path.unlink()
    flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND | os.O_NOFOLLOW | os.O_CLOEXEC
    return LogFile(path, os.open(path, flags, 0o600))


def _name(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9@._-]+", "_", text)[:100]
