"""Servers of assistants and the grants that persons give them: private files in the state folder."""

import math
import os
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from msgspec import Meta
from msgspec.structs import replace

from ur.source.foreign.files import read_text
from ur.source.foreign.json_values import BadJsonError, PrintableValue, read_json, write_json
from ur.source.printable import printable
from ur.source.replace import PRIVATE, replace_file
from ur.source.user_folders import user_folder

_Coordinate = Annotated[float, Meta(ge=-1e5, le=1e5, description="a number of metres from -100000 to 100000")]
MOST_RECTANGLES = 20

_EDGE = 0.05  # m: kept from each border, for the error of the pose
_STOPS_IN = 0.4  # s: to be at rest, and for the age of the pose


class Area(PrintableValue, frozen=True):
    """A rectangle with sides along the axes of the map."""

    left: _Coordinate
    bottom: _Coordinate
    right: _Coordinate
    top: _Coordinate
    name: Annotated[str, Meta(max_length=40)] = ""

    def contains(self, x: float, y: float, margin: float) -> bool:
        """Return whether a place is inside, `margin` m or more from the border (outside of it where negative)."""
        return self.left + margin <= x <= self.right - margin and self.bottom + margin <= y <= self.top - margin


def make_area(x0: float, y0: float, x1: float, y1: float, name: str = "") -> Area:
    """Return the area between two opposite corners."""
    return Area(min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1), name)


Areas = Annotated[tuple[Area, ...], Meta(max_length=MOST_RECTANGLES)]
Speed = Annotated[float, Meta(ge=0.01, le=2.0)]
GrantText = Annotated[str, Meta(max_length=64)]


class DriveGrant(PrintableValue, frozen=True):
    """`seconds` from its arrival on, at most `speed` m/s, in one of `within` (everywhere without any), not in `avoid`.

    `text` describes it on the screens of others.
    """

    seconds: Annotated[float, Meta(ge=0.0, le=86400.0)]
    speed: Speed
    within: Areas = ()
    avoid: Areas = ()
    text: GrantText = "assistant"

    def allows(self, x: float, y: float, ahead: float = 0.0, left: float = 0.0) -> bool:
        """Return whether the robot may be at a place at a velocity (m/s): it is at rest before it leaves the area."""
        margin = _EDGE + _STOPS_IN * math.hypot(ahead, left)
        inside = not self.within or any(each.contains(x, y, margin) for each in self.within)
        return inside and not any(each.contains(x, y, -margin) for each in self.avoid)


LONGEST = 24 * 3600.0
"""Seconds of the longest grant."""

_LARGEST = 1 << 16  # bytes
_Name = Annotated[str, Meta(max_length=200)]


class Request(PrintableValue, frozen=True):
    """The grant that an assistant asks for: minutes, the highest speed (m/s), and why."""

    minutes: float = 30.0
    speed: float = 0.2
    reason: _Name = ""


class ServerRecord(PrintableValue, frozen=True):
    """A server that runs: its process, the client that speaks to it, and what that asks for."""

    pid: Annotated[int, Meta(ge=1)]
    client: _Name = "an assistant"
    asks: Request | None = None


class GrantRecord(PrintableValue, frozen=True):
    """A grant as it is kept: it ends at `until` (s of this boot's clock), and with the boot."""

    boot: str
    until: float
    speed: Speed
    within: Areas = ()
    avoid: Areas = ()
    text: GrantText = "assistant"
    programs: bool = False

    def seconds_left(self) -> float:
        """Seconds until it ends; 0 when it has ended."""
        return max(0.0, self.until - boot_time()) if self.boot == boot_id() else 0.0

    def terms(self) -> DriveGrant:
        """The terms that the robot's end keeps, from now on."""
        return DriveGrant(self.seconds_left(), self.speed, self.within, self.avoid, self.text)


@dataclass(frozen=True, slots=True)
class GrantFiles:
    """The files of servers, each by the id of its server, and the log of all."""

    folder: Path

    @property
    def log(self) -> Path:
        """The log of actions."""
        return self.folder / "actions.log"

    def note_server(self, id: str, record: ServerRecord) -> None:
        """Keep the record of a server. Raises OSError."""
        self._write(self.folder / "servers" / f"{id}.json", record)

    def forget_server(self, id: str) -> None:
        """Remove a server and its grant."""
        self.revoke(id)
        with suppress(OSError):
            (self.folder / "servers" / f"{id}.json").unlink()

    def list_servers(self) -> dict[str, ServerRecord]:
        """The servers that run, by their ids."""
        found = {}
        for path in sorted((self.folder / "servers").glob("*.json")):
            with suppress(OSError, ValueError):
                record = read_json(read_text(path, _LARGEST), ServerRecord)
                if Path(f"/proc/{record.pid}").exists():
                    found[path.stem] = record
        return found

    def give(self, id: str, grant: GrantRecord) -> None:
        """Keep the grant of a server, which answers what it asks for. Raises OSError."""
        self._write(self.folder / "grants" / f"{id}.json", grant)
        self.answer(id)

    def answer(self, id: str) -> None:
        """Note that a person has answered what a server asks for. Raises OSError."""
        record = self.list_servers().get(id)
        if record is not None and record.asks is not None:
            self.note_server(id, replace(record, asks=None))

    def revoke(self, id: str) -> bool:
        """Take the grant of a server back; return whether there was one."""
        try:
            (self.folder / "grants" / f"{id}.json").unlink()
        except OSError:
            return False
        return True

    def find(self, id: str) -> GrantRecord | None:
        """The grant of a server that is in force."""
        try:
            grant = read_json(read_text(self.folder / "grants" / f"{id}.json", _LARGEST), GrantRecord)
        except (OSError, BadJsonError):
            return None
        return grant if grant.seconds_left() > 0.0 else None

    @staticmethod
    def _write(path: Path, value: object) -> None:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        replace_file(path, write_json(value), mode=PRIVATE)


def grant_files(environment: Mapping[str, str] = os.environ) -> GrantFiles:
    """The files of this user."""
    return GrantFiles(Path(user_folder("XDG_STATE_HOME", environment), "ubiquity_launches", "mcp"))


def make_grant(
    minutes: float, speed: float, within: tuple[Area, ...], avoid: tuple[Area, ...], *, programs: bool = False
) -> GrantRecord:
    """A grant from now on, with its text for the screens of others."""
    seconds = min(LONGEST, 60.0 * minutes)
    clock = time.strftime("%H:%M", time.localtime(time.time() + seconds))
    names = "".join(f", not {printable(each.name)}" for each in avoid if each.name)
    text = f"assistant, at most {speed:g} m/s until {clock}{names}"[:64]
    return GrantRecord(boot_id(), boot_time() + seconds, speed, within, avoid, text, programs)


def boot_time() -> float:
    """Seconds since this computer has started, asleep or not: a clock that is set changes no grant."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


def boot_id() -> str:
    """The id of this start of the computer."""
    return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
