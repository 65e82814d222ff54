"""Values of a sync: a workspace, the stored state at the last sync, and the plan of the next one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ur.source.diagnostic import user_error_about
from ur.source.foreign.json_values import BadJsonError, ForeignValue, read_json_names, write_json_names
from ur.source.replace import replace_file
from ur.source.user_folders import user_folder

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


_LONGEST = 256 << 20  # characters


@dataclass(frozen=True, slots=True)
class WorkspacePair:
    """Two workspaces. `machine` identifies the other computer's system, and changes when it is flashed again."""

    here: str
    there: str
    machine: str


@dataclass(frozen=True, slots=True)
class SyncMemory:
    """The last sync of a pair."""

    pair: WorkspacePair
    agreed: Mapping[str, Agreed] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _StoredMemory:
    version: Literal[1]
    pair: WorkspacePair
    agreed: Mapping[str, Agreed]


def memory_path(robot: str, environment: Mapping[str, str]) -> Path:
    """Return the file of a robot, below the user's state folder (XDG base directory specification)."""
    return Path(user_folder("XDG_STATE_HOME", environment)) / "ubiquity_launches" / "sync" / f"{robot}.json"


def load_memory(path: Path) -> SyncMemory | None:
    """Load the last sync; None if there was none or its file is unreadable: then the next sync deletes nothing."""
    try:
        stored = read_json_names(path.read_text(encoding="utf-8"), _StoredMemory, _LONGEST)
    except (OSError, UnicodeError, BadJsonError):
        return None
    return SyncMemory(stored.pair, stored.agreed)


def store_memory(path: Path, memory: SyncMemory) -> None:
    """Write the file atomically. Raises UserError."""
    try:
        replace_file(path, write_json_names(_StoredMemory(1, memory.pair, memory.agreed)), parents=True)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error_about(path, f"cannot be written: {reason}", rule="no-memory") from None


def known_files(agreed: Mapping[str, Agreed], side: str) -> dict[str, tuple[int, int, str]]:
    """Return size, time and hash of a side's files: those with the same size and time need not be read again."""
    files = ((path, each.here if side == "here" else each.there) for path, each in agreed.items())
    return {path: (file.size, file.time, file.content) for path, file in files if file.kind == "file"}
