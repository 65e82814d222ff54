"""The folder of stored maps in the user's data folder: list, find, rename and delete them."""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ur.maps.names import LATEST, check_map_name, is_map_name
from ur.source.diagnostic import user_error
from ur.source.replace import make_folder, replace_file, sync_folder
from ur.source.suggest import did_you_mean
from ur.source.user_folders import user_folder

if TYPE_CHECKING:  # imported late: reading records is slow to import and not needed at the start of a program
    from ur.maps.record import MapRecord

PICTURE = "map.yaml"
"""The file of a stored map in the format of map_server."""

_LOCK = ".lock"
_DELETED = ".deleted-"
_NEW = ".new-"


@dataclass(frozen=True, slots=True)
class MapStore:
    """The stored maps of a user. A map is a folder of its name below `folder` with a file `map.yaml`."""

    folder: Path

    def names(self) -> list[str]:
        """Return the sorted names of all maps; empty without a folder."""
        try:
            found = [each.name for each in self.folder.iterdir() if is_map_name(each.name)]
        except OSError:
            return []
        return sorted(name for name in found if (self.folder / name / PICTURE).is_file())

    def path(self, name: str) -> Path:
        """Return the folder for a map of this name. Raises UserError for an invalid name."""
        return self.folder / check_map_name(name)

    def picture(self, name: str) -> Path:
        """Return the map_server file of a map; the map itself may not exist. Raises UserError as `path`."""
        return self.path(name) / PICTURE

    def resolve(self, name: str) -> str:
        """Return the name of an existing map; `latest` is an alias of one. Raises UserError if it does not exist."""
        if name == LATEST:
            found = self.latest()
            if found is None:
                message = "no map was made with this robot yet, expected one"
                raise user_error(message, rule="unknown-map", help="make one: ur run make_map")
            return found
        if not self.picture(name).is_file():
            names = self.names()
            near = did_you_mean(name, names)
            expected = f"one of {', '.join(names)}" if 0 < len(names) <= 10 else "one that 'ur maps' lists"
            message = f"unknown map {name!r}, expected {expected}"
            help_ = (
                f"did you mean {near!r}?" if near else "'ur run make_map' makes a map, 'ur maps import' takes one in"
            )
            raise user_error(message, rule="unknown-map", help=help_)
        return name

    def record(self, name: str) -> MapRecord:
        """Read the record of a map. Raises UserError."""
        from ur.maps.record import read_record

        return read_record(self.path(name))

    def write_record(self, name: str, record: MapRecord) -> None:
        """Replace the record of a map. Raises OSError."""
        from ur.maps.record import RECORD, render_record

        replace_file(self.path(name) / RECORD, render_record(record))

    def latest(self) -> str | None:
        """Return the latest map that was made with this computer's robot; None if it no longer exists."""
        try:
            name = (self.folder / LATEST).readlink().name
        except OSError:
            return None
        return name if is_map_name(name) and (self.folder / name / PICTURE).is_file() else None

    def set_latest(self, name: str) -> None:
        """Make `latest` an alias of a map. Raises OSError."""
        beside = self.folder / f"{_NEW}{os.urandom(4).hex()}"
        beside.symlink_to(check_map_name(name))
        beside.replace(self.folder / LATEST)

    def rename(self, before: str, after: str) -> None:
        """Rename a map. Raises UserError if it does not exist, the name is taken, or the map is in use."""
        self.resolve(before)
        with self.claim(before):
            if self.path(after).exists():
                raise user_error(
                    f"map {after!r} exists, expected a name without a map",
                    rule="map-exists",
                    help="ur maps",
                    subject=after,
                )
            was_latest = self.latest() == before
            self.path(before).rename(self.path(after))
            if was_latest:
                self.set_latest(after)
            sync_folder(str(self.folder))

    def delete(self, name: str) -> None:
        """Delete a map, completely or not at all. Raises UserError if it does not exist, or is in use."""
        self.resolve(name)
        with self.claim(name):
            was_latest = self.latest() == name
            self.path(name).rename(self.folder / f"{_DELETED}{os.urandom(4).hex()}")
            if was_latest:
                (self.folder / LATEST).unlink()
            sync_folder(str(self.folder))
        self.tidy()

    def tidy(self) -> None:
        """Remove the remains of an interrupted deletion or import."""
        for pattern in (f"{_DELETED}*", f"{_NEW}*"):
            for each in self.folder.glob(pattern):
                shutil.rmtree(each, ignore_errors=True)
                with suppress(OSError):
                    each.unlink()

    @contextmanager
    def arriving(self, name: str) -> Iterator[Path]:
        """Yield an empty folder that becomes the map `name` when the block ends without an exception.

        Raises UserError if the name is invalid or taken.
        """
        target = self.path(name)
        if target.exists() and (target / PICTURE).exists():
            help_ = f"choose another name, or delete it: ur maps delete {name}"
            raise user_error(f"map {name!r} exists, expected a new name", rule="map-exists", help=help_, subject=name)
        make_folder(str(self.folder))
        beside = self.folder / f"{_NEW}{os.urandom(4).hex()}"
        beside.mkdir()
        try:
            yield beside
            shutil.rmtree(target, ignore_errors=True)
            beside.rename(target)
        except BaseException:
            shutil.rmtree(beside, ignore_errors=True)
            raise
        sync_folder(str(self.folder))

    @contextmanager
    def claim(self, name: str) -> Iterator[None]:
        """Lock a map against changes by other programs.

        Raises UserError if one is changing it, for example `make_map`.
        """
        folder = self.path(name)
        make_folder(str(folder))
        with (folder / _LOCK).open("a") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                message = f"map {name!r} is in use, expected one that no program changes"
                raise user_error(
                    message, rule="map-in-use", help="end make_map, or wait for the other command"
                ) from None
            yield


def own_store(environment: Mapping[str, str]) -> MapStore:
    """Return the maps of the user with this environment."""
    return MapStore(Path(user_folder("XDG_DATA_HOME", environment), "ubiquity_launches", "maps"))
