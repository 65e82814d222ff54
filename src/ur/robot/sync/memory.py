"""The state at the last sync with a robot, stored on this computer."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from ur.robot.sync.steps import Agreed
from ur.source.diagnostic import UserError, error_about
from ur.source.foreign.json_values import BadJsonError, read_json_names, write_json_names
from ur.source.replace import replace_file
from ur.source.user_folders import user_folder

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
        raise UserError(error_about(path, f"cannot be written: {reason}", rule="no-memory")) from None


def known_files(agreed: Mapping[str, Agreed], side: str) -> dict[str, tuple[int, int, str]]:
    """Return size, time and hash of a side's files: those with the same size and time need not be read again."""
    files = ((path, each.here if side == "here" else each.there) for path, each in agreed.items())
    return {path: (file.size, file.time, file.content) for path, file in files if file.kind == "file"}
