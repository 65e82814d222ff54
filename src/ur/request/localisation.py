"""How a robot finds its place: the launch argument `localisation`, chosen by what its base has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from ur.robot.base import load_base
from ur.robot.base.search import find_base_package
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean

ARGUMENT = "localisation"
WAYS = ("amcl", "fiducials")
"""By lidar; by camera, on a map of fiducials."""


def choose_localisation(
    files: Sequence[str],
    declared: Sequence[str],
    values: Mapping[str, str],
    environment: Mapping[str, str] | None = None,
) -> list[str]:
    """The argument to add for launch files that declare it, where the base has a camera and no lidar; else nothing.

    `values` are the arguments known so far; `environment` names workspaces that may have the base. Raises UserError: a
    way that there is not, no such base or variant.
    """
    if ARGUMENT not in declared:
        return []
    if ARGUMENT in values:
        return _check(values[ARGUMENT])
    package = next(filter(None, map(_find_package, files)), None)
    if package is None or not values.get("robot_base"):
        return []
    name = values["robot_base"]
    base = load_base(find_base_package(package, name, environment or {}), name, values.get("robot_variant", ""))
    return [f"{ARGUMENT}:=fiducials"] if base.raspicam and not base.lidar else []


def _check(way: str) -> list[str]:
    if way not in WAYS:
        near = did_you_mean(way, WAYS)
        message = f"{ARGUMENT}:={way}, expected one of {', '.join(WAYS)}"
        raise UserError(error(message, rule="bad-argument", help=f"did you mean {near!r}?" if near else None))
    return []


def _find_package(path: str) -> Path | None:
    """The launch package with bases that a file belongs to."""
    folders = (folder for folder in Path(path).resolve().parents if (folder / "package.xml").is_file())
    found = next(folders, None)
    return found if found is not None and (found / "bases").is_dir() else None
