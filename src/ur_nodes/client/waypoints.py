"""Named places, kept per map in a small YAML file that users may edit."""

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from hashlib import sha1
from pathlib import Path

import numpy as np

from ur.maps.names import read_places, waypoint_path, write_places
from ur.source.diagnostic import user_error
from ur.source.suggest import did_you_mean
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2


def name_of_map(grid: Grid) -> str:
    """Return a name for a map without one; the same map always gets the same name."""
    resolution = float(np.float32(grid.resolution))  # as in the map's message, so that earlier names stay valid
    digest = sha1(repr((resolution, grid.origin)).encode(), usedforsecurity=False)
    digest.update(grid.values.tobytes())
    return f"map-{digest.hexdigest()[:8]}"


@dataclass(frozen=True, slots=True)
class PlaceSettings:
    """The parameters of `keyboard_navigate` that lead to its file. `grows`: the map gets its name when it is saved."""

    map_name: str = ""
    file: str = ""
    grows: bool = False


def read_settings(value: object) -> PlaceSettings:
    """Read the settings from the parameters of a node; missing ones, or ones of another type, are empty."""
    if not isinstance(value, Mapping):
        return PlaceSettings()
    name, file, service = (value.get(each, "") for each in ("map_name", "waypoints_file", "save_service"))
    return PlaceSettings(
        name if isinstance(name, str) else "",
        file if isinstance(file, str) else "",
        isinstance(service, str) and service != "",
    )


def choose_file(settings: PlaceSettings, grid: Grid | None, environment: Mapping[str, str]) -> Path | None:
    """Return the file of the places; None while there is no map, or it has no name."""
    if settings.file:
        return Path(settings.file).expanduser()
    if settings.map_name:
        return waypoint_path(settings.map_name, environment)
    return None if grid is None or settings.grows else waypoint_path(name_of_map(grid), environment)


class WaypointStore:
    """The waypoints of one map. Every call reads the file, so several programs may share it."""

    def __init__(self, path: Path, sync: Callable[[int], object] = os.fsync) -> None:
        self.path, self._sync = path, sync

    def places(self) -> dict[str, Pose2]:
        """Return all waypoints, sorted by name. Raises UserError, with the line, when the file cannot be used."""
        return {name: Pose2(x, y, math.radians(degrees)) for name, (x, y, degrees) in read_places(self.path).items()}

    def find(self, name: str) -> Pose2:
        """Return a waypoint. Raises UserError, with a suggestion, when there is none of that name."""
        places = self.places()
        if name not in places:
            near = did_you_mean(name, places)
            known = ", ".join(places) or "none yet; 'w NAME' saves one"
            raise user_error(
                f"unknown waypoint {name!r}, expected one of: {known}",
                rule="unknown-waypoint",
                help=f"did you mean {near!r}?" if near else None,
            )
        return places[name]

    def remember(self, name: str, pose: Pose2) -> bool:
        """Save a place under a name; return whether it is new. Raises UserError when the file cannot be written."""
        places = self.places()
        fresh = name not in places
        self._write({**places, name: pose})
        return fresh

    def forget(self, name: str) -> None:
        """Delete a waypoint. Raises UserError when there is no such waypoint."""
        self.find(name)
        self._write({key: place for key, place in self.places().items() if key != name})

    def _write(self, places: Mapping[str, Pose2]) -> None:
        try:
            write_places(
                self.path, {name: (x, y, math.degrees(yaw)) for name, (x, y, yaw) in places.items()}, self._sync
            )
        except OSError as problem:
            reason = (problem.strerror or str(problem)).lower()
            raise user_error(
                f"{self.path}: {reason}, expected a writable waypoint file", rule="unwritable-file"
            ) from None
