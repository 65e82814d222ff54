"""Last known addresses of robots, used when a name does not resolve, and the evidence that a robot exists."""

import fcntl
import json
import os
import socket
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from ur.robot.discovery.record import load_records, records_folder
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


Evidence = Literal["set up", "this computer", "seen", "answers", "none"]


@dataclass(frozen=True, slots=True)
class KnownRobot:
    """A robot's name, the evidence that it exists, and the names of all robots that were set up or seen."""

    name: str
    evidence: Evidence
    others: tuple[str, ...]


def look_up_robot(
    name: str, environment: Mapping[str, str], *, hostname: str, resolves: Callable[[str], bool] | None = None
) -> KnownRobot:
    """Find the evidence that a robot exists.

    The network is queried last, and only for a name without other evidence: a `.local` name may take 5 s to fail.
    """
    records = [record.name for record in load_records(records_folder(environment))]
    seen = list(load_seen(seen_path(environment)))
    others = tuple(sorted({*records, *seen}))
    wanted = name.lower()
    evidence: Evidence = "none"
    if wanted in map(str.lower, records):
        evidence = "set up"
    elif wanted == hostname.split(".")[0].lower():
        evidence = "this computer"
    elif wanted in map(str.lower, seen):
        evidence = "seen"
    elif (resolves or _resolves)(f"{name}.local"):
        evidence = "answers"
    return KnownRobot(name, evidence, others)


def _resolves(host: str) -> bool:
    try:
        return bool(socket.getaddrinfo(host, None, type=socket.SOCK_STREAM))
    except (OSError, UnicodeError):
        return False
