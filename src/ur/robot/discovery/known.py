"""Evidence that a robot exists: it was set up from this computer, seen on the network, or answers now."""

import socket
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from ur.robot.discovery.record import load_records, records_folder
from ur.robot.discovery.seen import load_seen, seen_path

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
