"""Values of a sync: the content of a workspace, the state at the last sync, and the plan of the next one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, cast, get_args

Kind = Literal["file", "link", "folder"]
Side = Literal["here", "there"]
SIDES: tuple[Side, Side] = ("here", "there")


@dataclass(frozen=True, slots=True)
class File:
    """A file of one side. `content` is its hash, or the target of a link; `time` is in ns since 1970."""

    kind: Kind
    size: int
    time: int
    executable: bool
    content: str

    @property
    def identity(self) -> Identity:
        """The identity that it shares with the same file on the other side."""
        return self.kind, self.executable, self.content

    def as_json(self) -> list[Any]:
        """As `ur.robot.sync.side` writes and reads it."""
        return [self.kind, self.size, self.time, self.executable, self.content]


Identity = tuple[str, bool, str]


@dataclass(frozen=True, slots=True)
class Manifest:
    """One side: its files by path, and the paths that cannot be carried, with the reasons."""

    files: Mapping[str, File] = field(default_factory=dict)
    skipped: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Agreed:
    """A path that both had alike at the last sync. Size and time tell either side whether it was changed since."""

    here: File
    there: File

    @property
    def identity(self) -> Identity:
        """The identity of the common version."""
        return self.here.identity


@dataclass(frozen=True, slots=True)
class SyncStep:
    """A change of one side. `before` is what it has, `after` what it gets; None: nothing. `keep`: save what it has."""

    path: str
    to: Side
    before: File | None
    after: File | None
    keep: bool = False


@dataclass(frozen=True, slots=True)
class Conflict:
    """A path that stays as it is on both sides."""

    path: str
    here: File | None
    there: File | None
    reason: str


@dataclass(frozen=True, slots=True)
class SyncPlan:
    """The plan of a sync: `steps`, `conflicts`, and `waiting` steps in the direction that was not asked for.

    With the paths in `same`, which both have alike, the next sync begins. `skipped` says what is left out, and why.
    """

    steps: tuple[SyncStep, ...] = ()
    conflicts: tuple[Conflict, ...] = ()
    waiting: tuple[SyncStep, ...] = ()
    same: Mapping[str, Agreed] = field(default_factory=dict)
    skipped: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def read_files(rows: Mapping[str, list[Any]]) -> dict[str, File]:
    """Files from their JSON, which another computer may have sent. Raises TypeError or ValueError for anything else.

    A path stays inside of the workspace: it is relative, and no part of it is empty, `.` or `..`.
    """
    if not isinstance(rows, Mapping):
        raise TypeError("expected files by path")
    return {check_path(path): _read_file(row) for path, row in rows.items()}


def check_path(path: object) -> str:
    """Return a path of a workspace. Raises TypeError or ValueError for one that leads out of it."""
    if not isinstance(path, str):
        raise TypeError("expected a path")
    if "\0" in path or any(part in ("", ".", "..") for part in path.split("/")):
        raise ValueError(f"{path!r} is no path inside of a workspace")
    return path


def _read_file(row: object) -> File:
    if not isinstance(row, list) or len(row) != 5:
        raise TypeError("expected a file")
    kind, size, time, executable, content = row
    numbers = all(isinstance(each, int) and not isinstance(each, bool) for each in (size, time))
    if kind not in get_args(Kind) or not numbers or not isinstance(executable, bool) or not isinstance(content, str):
        raise TypeError("expected a file")
    return File(cast(Kind, kind), size, time, executable, content)
