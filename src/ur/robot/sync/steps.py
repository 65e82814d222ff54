"""Values of a sync: the content of a workspace, the state at the last sync, and the plan of the next one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from ur.source.foreign.json_values import ForeignValue

Kind = Literal["file", "link", "folder"]
Side = Literal["here", "there"]
SIDES: tuple[Side, Side] = ("here", "there")


class File(ForeignValue, frozen=True, array_like=True):
    """A file of one side, as `ur.robot.sync.side` writes and reads it.

    `content` is its hash, or the target of a link; `time` is in ns since 1970.
    """

    kind: Kind
    size: int
    time: int
    executable: bool
    content: str

    @property
    def identity(self) -> Identity:
        """The properties that are equal for the same file on the other side."""
        return self.kind, self.executable, self.content


Identity = tuple[str, bool, str]


@dataclass(frozen=True, slots=True)
class Manifest:
    """One side: its files by path, and the paths that cannot be transferred, with the reasons."""

    files: Mapping[str, File] = field(default_factory=dict)
    skipped: Mapping[str, str] = field(default_factory=dict)


class Agreed(ForeignValue, frozen=True, array_like=True):
    """A path that was equal on both sides at the last sync.

    Size and time tell each side whether it was changed since.
    """

    here: File
    there: File

    @property
    def identity(self) -> Identity:
        """The properties that both sides have in common."""
        return self.here.identity


@dataclass(frozen=True, slots=True)
class SyncStep:
    """A change of one side.

    `before` is its present file, `after` its new one; None: no file. `keep`: save the present file.
    """

    path: str
    to: Side
    before: File | None
    after: File | None
    keep: bool = False


@dataclass(frozen=True, slots=True)
class Conflict:
    """A path that stays unchanged on both sides."""

    path: str
    here: File | None
    there: File | None
    reason: str


@dataclass(frozen=True, slots=True)
class SyncPlan:
    """The plan of a sync: `steps`, `conflicts`, and `waiting` steps in the direction that was not requested.

    The paths in `same` are equal on both sides and are the base of the next sync. `skipped` lists the paths that are
    left out, with the reasons.
    """

    steps: tuple[SyncStep, ...] = ()
    conflicts: tuple[Conflict, ...] = ()
    waiting: tuple[SyncStep, ...] = ()
    same: Mapping[str, Agreed] = field(default_factory=dict)
    skipped: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def check_path(path: str) -> str:
    """Return a path of a workspace unchanged. Raises ValueError for one outside of the workspace.

    A path inside is relative, and no part of it is empty, `.` or `..`.
    """
    if "\0" in path or any(part in ("", ".", "..") for part in path.split("/")):
        raise ValueError(f"{path!r} is no path inside of a workspace")
    return path
