"""Lease and requests as JSON: their form on topics, untrusted until it is checked here, and on the robot's disk."""

import json
import os
import re
import zlib
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from msgspec import Meta

from ur.source.foreign.json_values import BadJsonError, Stamp, read_json, write_json
from ur.source.replace import PRIVATE, replace_file, sync_folder
from ur_nodes.motion.challenge.freshness import NO_STAMP

Action = Literal["acquire", "renew", "ask", "take", "release", "grant"]
LeaseState = Literal["free", "held", "lost"]

MOST_ASKING = 16
LONGEST_NAME = 64
LONGEST_NOTE = 120
LEASE_TIMEOUT = 2.5
"""Seconds without a request after which a client is lost, unless a parameter says otherwise."""

_LONGEST_REQUEST = 1024  # characters
_LONGEST = 16384  # bytes of the file
_LONGEST_LEASE = 8192
_ID = "[0-9A-Za-z_.:-]"
_CLIENT = re.compile(f"{_ID}{{1,64}}", re.ASCII)
_Client = Annotated[
    str, Meta(pattern=rf"^{_ID}{{1,64}}\Z", description="an id of at most 64 letters, digits, '_', '.', ':' and '-'")
]
_Time = Annotated[float, Meta(ge=0.0, lt=4.2e9)]  # s since 1970


@dataclass(frozen=True, slots=True)
class Viewer:
    """A client, and the name of the computer that it runs on."""

    client: _Client
    name: str = ""


@dataclass(frozen=True, slots=True)
class Terms:
    """Terms on which a client drives: the mux keeps them for all commands while that client has the lease.

    `speed` is the highest (m/s); turning is limited to the same share of the base's speeds. The robot moves only while
    the client's newest request answers a challenge of the last `keep` seconds.
    """

    speed: Annotated[float, Meta(ge=0.01, le=100.0)]
    keep: Annotated[float, Meta(ge=0.05, le=1.0)]


@dataclass(frozen=True, slots=True)
class Lease:
    """The lease: no client drives (`free`), a client (`held`), or one whose renewals have stopped arriving (`lost`).

    `since`, `taken_at` and `until` are seconds since 1970 by the robot's clock, for people to read; `until` is the time
    of the last message of a client that is lost, if known. `attended` is whether a person watches; `asking` who would
    like to drive; `taken_from` who drove before the client took over. `computer` identifies a user of a computer, where
    names may be alike; it is empty for a client that sends none. `terms` are those of the client that drives; `note`
    says why the last one has released the lease, for people.
    """

    state: LeaseState = "free"
    client: Annotated[str, Meta(pattern=rf"^{_ID}{{0,64}}\Z")] = ""
    name: str = ""
    program: str = ""
    since: _Time = 0.0
    attended: bool = True
    asking: Annotated[tuple[Viewer, ...], Meta(max_length=MOST_ASKING)] = ()
    taken_from: Viewer | None = None
    taken_at: _Time | None = None
    computer: str = ""
    until: _Time | None = None
    terms: Terms | None = None
    note: str = ""


@dataclass(frozen=True, slots=True)
class LeaseRequest:
    """A client's request about the lease, and the newest challenge that the client had received.

    `terms` are those on which it drives; `note` says why it releases the lease, for people.
    """

    client: _Client
    name: str
    program: str
    action: Action
    attended: bool = True
    answers: Stamp = NO_STAMP
    computer: str = ""
    terms: Terms | None = None
    note: str = ""


FREE = Lease()


def is_client(text: object) -> bool:
    """Return whether this can be the id of a client."""
    return isinstance(text, str) and _CLIENT.fullmatch(text) is not None


def write_request(request: LeaseRequest) -> str:
    """The request as JSON."""
    return write_json(request)


def read_request(text: str) -> LeaseRequest | str:
    """Parse a request, or return why it is invalid."""
    try:
        found = read_json(text, LeaseRequest, _LONGEST_REQUEST)
    except BadJsonError as problem:
        return str(problem)
    name = clean_name(found.name) or found.client[:8]
    return replace(
        found,
        name=name,
        program=clean_name(found.program),
        computer=clean_computer(found.computer),
        note=clean_name(found.note, LONGEST_NOTE),
    )


def write_lease(lease: Lease) -> str:
    """The lease as JSON."""
    return write_json(lease)


def read_lease(text: object) -> Lease | None:
    """Parse a lease; None if it is invalid."""
    try:
        found = read_json(text, Lease, _LONGEST_LEASE)
    except BadJsonError:
        return None
    if (found.state == "free") is not (found.client == ""):
        return None
    return replace(
        found,
        name=clean_name(found.name),
        program=clean_name(found.program),
        asking=tuple(map(_clean_person, found.asking)),
        taken_from=found.taken_from and _clean_person(found.taken_from),
        computer=clean_computer(found.computer),
        note=clean_name(found.note, LONGEST_NOTE),
    )


def clean_computer(value: object) -> str:
    """Return the identity of a user of a computer, which has the form of a client's id; empty if invalid."""
    return str(value) if is_client(value) else ""


def clean_name(value: object, longest: int = LONGEST_NAME) -> str:
    """Return a name for display: printable, on one line, of a limited length; empty if it is no text."""
    if not isinstance(value, str):
        return ""
    return "".join(each for each in value[: 4 * longest] if each.isprintable()).strip()[:longest]


def _clean_person(person: Viewer) -> Viewer:
    return replace(person, name=clean_name(person.name))


@dataclass(frozen=True, slots=True)
class LeaseStore:
    """The file of the lease of one mux. `run` is the id of the master's run; `sync` flushes a file to disk."""

    path: Path
    run: str = ""
    sync: Callable[[int], object] = os.fsync

    def load(self) -> tuple[Lease | None, bool]:
        """Return the lease and whether it is of this run of the master; None if there is none or it is damaged."""
        try:
            with self.path.open("rb") as file:
                value = read_json(file.read(_LONGEST), dict[str, object])
        except (OSError, BadJsonError):
            return None, True
        return read_lease(value.get("lease")), value.get("run") == self.run

    def save(self, lease: Lease) -> None:
        """Write the lease to disk. Raises OSError, after removing an older lease if possible."""
        try:
            text = json.dumps({"run": self.run, "lease": write_lease(lease)})
            replace_file(self.path, text, mode=PRIVATE, parents=True, sync=self.sync)
        except OSError:
            with suppress(OSError):
                self.clear()
            raise

    def clear(self) -> None:
        """Remove the file. Raises OSError."""
        with suppress(FileNotFoundError):
            self.path.unlink()
            sync_folder(str(self.path.parent))


def make_store(environment: Mapping[str, str], mux: str, run: str) -> LeaseStore:
    """Return the store of the mux with this node name, at the master or domain of the environment."""
    home = environment.get("ROS_HOME") or str(Path(environment.get("HOME") or os.sep) / ".ros")
    ros2 = environment.get("ROS_VERSION") == "2"
    graph = environment.get("ROS_DOMAIN_ID") or "0" if ros2 else environment.get("ROS_MASTER_URI", "")
    key = f"{graph}\0{mux}"
    name = f"{mux.strip('/').replace('/', '.')[:64]}-{zlib.crc32(key.encode()):08x}.json"
    return LeaseStore(Path(home, "ur_lease", name), run)
