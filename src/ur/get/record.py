"""The record of the packages that `ur get` has installed, so that it can remove them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from msgspec import Meta

from ur.get.tables import PYPI
from ur.source.diagnostic import UserError, error
from ur.source.foreign.json_values import BadJsonError, read_json, write_json
from ur.source.replace import replace_file
from ur.source.user_folders import user_folder

DebianName = Annotated[str, Meta(pattern=r"^[a-z0-9][a-z0-9+.-]*\Z", description="the name of a package")]


@dataclass(frozen=True, slots=True)
class InstallRecord:
    """Debian packages and packages from PyPI that were not installed before `ur get` installed them."""

    debian: tuple[DebianName, ...] = ()
    pypi: tuple[str, ...] = ()

    def adding(self, debian: Iterable[str] = (), pypi: Iterable[str] = ()) -> InstallRecord:
        """Return a record with more packages, each once."""
        return InstallRecord(tuple(dict.fromkeys((*self.debian, *debian))), tuple(dict.fromkeys((*self.pypi, *pypi))))


def record_path(environment: Mapping[str, str]) -> Path:
    """Return the file of the record."""
    return Path(user_folder("XDG_STATE_HOME", environment)) / "ubiquity_launches" / "get.json"


def load_record(path: Path) -> InstallRecord:
    """Read the record; empty if there is none. Raises UserError if it is damaged."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        return InstallRecord()
    except (OSError, ValueError) as problem:
        raise _damaged(path, str(problem)) from None
    try:
        record = read_json(text, InstallRecord)
    except BadJsonError as problem:
        raise _damaged(path, str(problem)) from None
    if not all(name in PYPI for name in record.pypi):
        raise _damaged(path, "a name in it is no package's")
    return record


def store_record(record: InstallRecord, path: Path) -> None:
    """Write the record, or remove it if it is empty. Raises UserError, with the record unchanged."""
    try:
        if record == InstallRecord():
            path.unlink(missing_ok=True)
        else:
            replace_file(path, write_json(record) + os.linesep, parents=True)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"{path}: the record of what is installed cannot be written: {reason}; nothing was changed"
        raise UserError(
            error(message, rule="unwritable-file", help="make room on the disk, then run this again")
        ) from None


def _damaged(path: Path, reason: str) -> UserError:
    message = f"{path}: the record of 'ur get' is damaged: {reason}, expected what 'ur get' has written"
    return UserError(error(message, rule="damaged-record", help=f"remove packages with apt-get, then: rm {path}"))
