"""Places with names, kept per map in a small YAML file that people may edit."""

from __future__ import annotations

import contextlib
import math
import os
import re
import tempfile
from collections.abc import Mapping
from hashlib import sha1
from pathlib import Path

from ur.source.diagnostic import UserError, error
from ur.source.section import read_section
from ur.source.suggest import did_you_mean
from ur_nodes.teleop.navigator import MapGrid, Place

_HEAD = "# Waypoints of the map {name}: name: [x, y, angle], in m, m and degrees, in the map frame.\n"


def waypoint_path(map_name: str, environment: Mapping[str, str]) -> Path:
    """Where the waypoints of a map are kept: below XDG_DATA_HOME, which is ~/.local/share unless set.

    `map_name` may be a path; then its stem counts.
    """
    data = environment.get("XDG_DATA_HOME") or str(Path(environment.get("HOME", "~")).expanduser() / ".local/share")
    stem = Path(map_name).stem if "/" in map_name else map_name
    return Path(data) / "ubiquity_launches" / "waypoints" / f"{re.sub(r'[^A-Za-z0-9_.-]', '_', stem)}.yaml"


def name_of_map(grid: MapGrid) -> str:
    """A name for a map that nobody named: the same map always gets the same one."""
    digest = sha1(repr((grid.resolution, grid.origin)).encode(), usedforsecurity=False)
    digest.update(grid.cells.tobytes())
    return f"map-{digest.hexdigest()[:8]}"


class WaypointStore:
    """The waypoints of one map. Every call reads the file anew, so several programs may share it."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def places(self) -> dict[str, Place]:
        """All of them, sorted by name. Raises UserError, with the line, when the file cannot be used."""
        if not self.path.exists():
            return {}
        section = read_section(self.path, "a waypoint file")
        found = {}
        for name in section.keys:
            x, y, degrees = section.numbers(name, 3)
            found[name] = Place(x, y, math.radians(degrees))
        return dict(sorted(found.items()))

    def find(self, name: str) -> Place:
        """The place of a name. Raises UserError: did you mean."""
        places = self.places()
        if name not in places:
            near = did_you_mean(name, places)
            known = ", ".join(places) or "none yet: 'w NAME' remembers a place"
            raise UserError(
                error(
                    f"{name!r} is not a waypoint, expected one of: {known}",
                    rule="unknown-waypoint",
                    help=f"did you mean {near!r}?" if near else None,
                )
            )
        return places[name]

    def remember(self, name: str, place: Place) -> bool:
        """Keep a place under a name; whether the name is new. Raises UserError when the file cannot be written."""
        places = self.places()
        fresh = name not in places
        self._write({**places, name: place})
        return fresh

    def forget(self, name: str) -> None:
        """Drop a name. Raises UserError when there is no such waypoint."""
        self.find(name)
        self._write({key: place for key, place in self.places().items() if key != name})

    def _write(self, places: Mapping[str, Place]) -> None:
        lines = [
            f"{_key(name)}: [{place.x:.3f}, {place.y:.3f}, {math.degrees(place.yaw):.1f}]\n"
            for name, place in sorted(places.items())
        ]
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            _replace_file(self.path, _HEAD.format(name=self.path.stem) + "".join(lines or ["{}\n"]))
        except OSError as problem:
            reason = (problem.strerror or str(problem)).lower()
            raise UserError(
                error(f"{self.path}: {reason}, expected a waypoint file that can be written", rule="unwritable-file")
            ) from None


def _key(name: str) -> str:
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'  # 007 and yes are names, not values


def _replace_file(path: Path, text: str) -> None:
    """Whole or not at all, also when the power goes: write beside, flush to the disk, rename."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        Path(temporary).chmod(0o644)
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise
