"""The state at the last sync with a robot, kept on this computer."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ur.robot.sync.steps import Agreed, File
from ur.source.diagnostic import UserError, error_about
from ur.source.replace import replace_file
from ur.source.user_folders import user_folder

VERSION = 1


@dataclass(frozen=True, slots=True)
class WorkspacePair:
    """Two workspaces. `machine` names the other computer's system: it changes when that one is flashed again."""

    here: str
    there: str
    machine: str


@dataclass(frozen=True, slots=True)
class SyncMemory:
    """The last sync of a pair."""

    pair: WorkspacePair
    agreed: Mapping[str, Agreed] = field(default_factory=dict)


def memory_path(robot: str, environment: Mapping[str, str]) -> Path:
    """The file of a robot, below the user's state folder (XDG base directory specification)."""
    return Path(user_folder("XDG_STATE_HOME", environment)) / "ubiquity_launches" / "sync" / f"{robot}.json"


def load_memory(path: Path) -> SyncMemory | None:
    """The last sync; None when there was none. One that cannot be read counts as none: then nothing is deleted."""
    try:
        top = json.loads(path.read_text(encoding="utf-8"))
        if top["version"] != VERSION:
            return None
        agreed = {name: Agreed(File(*row[0]), File(*row[1])) for name, row in top["agreed"].items()}
        return SyncMemory(WorkspacePair(**top["pair"]), agreed)
    except (OSError, ValueError, TypeError, KeyError, IndexError, AttributeError, RecursionError):
        return None


def store_memory(path: Path, memory: SyncMemory) -> None:
    """Write it in one step. Raises UserError."""
    rows = {name: [each.here.as_json(), each.there.as_json()] for name, each in memory.agreed.items()}
    pair = {"here": memory.pair.here, "there": memory.pair.there, "machine": memory.pair.machine}
    try:
        replace_file(path, json.dumps({"version": VERSION, "pair": pair, "agreed": rows}), parents=True)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error_about(path, f"cannot be written: {reason}", rule="no-memory")) from None


def known_files(agreed: Mapping[str, Agreed], side: str) -> dict[str, tuple[int, int, str]]:
    """Size, time and hash of files as a side had them: with the same size and time they need not be read again."""
    files = ((path, each.here if side == "here" else each.there) for path, each in agreed.items())
    return {path: (file.size, file.time, file.content) for path, file in files if file.kind == "file"}
