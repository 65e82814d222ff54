"""Last known addresses of robots, used when a name no longer resolves."""

import fcntl
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path

from ur.source.replace import replace_file
from ur.source.user_folders import user_folder

KEPT = 90 * 86400.0  # s


@dataclass(frozen=True, slots=True)
class SeenRobot:
    """A robot's full name without .local, its IPv4 address, and the time of the sighting (s since 1970)."""

    name: str
    address: str
    time: float


def seen_path(environment: Mapping[str, str]) -> Path:
    """Return the file of the last known addresses, below the user's state folder (XDG base directory specification)."""
    return Path(user_folder("XDG_STATE_HOME", environment)) / "ubiquity_launches" / "seen.json"


def load_seen(path: Path) -> dict[str, SeenRobot]:
    """Load the last known addresses by name; empty if the file is missing or invalid."""
    from ur.source.foreign.json_values import read_json

    try:
        found: tuple[SeenRobot, ...] = read_json(path.read_bytes(), tuple[SeenRobot, ...])
    except (OSError, ValueError):
        return {}
    return {each.name: each for each in found}


def note_seen(path: Path, robots: Iterable[SeenRobot]) -> None:
    """Store the present addresses of robots, and drop those that were not seen for long.

    The file is replaced atomically; a full disk is no error.
    """
    latest = {each.name: each for each in robots if each.address}
    if not latest:
        return
    oldest = max(each.time for each in latest.values()) - KEPT
    with suppress(OSError), _hold(path):  # no fsync: after a power cut it is gathered again
        entries = {name: each for name, each in load_seen(path).items() if each.time >= oldest} | latest
        text = json.dumps([asdict(each) for _, each in sorted(entries.items())])
        replace_file(path, text, parents=True, lasting=False)


@contextmanager
def _hold(path: Path) -> Iterator[None]:
    """Lock the file against other `ur` commands. Raises OSError."""
    path.parent.mkdir(parents=True, exist_ok=True)
    folder = os.open(path.parent, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX)
        yield
    finally:
        os.close(folder)


def describe_age(seconds: float) -> str:
    """Describe an age in words."""
    for unit, length in (("d", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds >= length:
            return f"{seconds / length:.0f} {unit} ago"
    return "just now"
