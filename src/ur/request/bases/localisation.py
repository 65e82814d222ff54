"""The launch argument `localisation`, which depends on the robot's sensors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from ur.request.arguments import Argument
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean

if TYPE_CHECKING:
    from ur.request.bases.base_argument import FileBase

ARGUMENT = "localisation"
METHODS = ("amcl", "fiducials")
"""By lidar; by camera, on a map of fiducials."""


def choose_localisation(values: Mapping[str, str], find_bases: Callable[[], Sequence[FileBase]]) -> list[Argument]:
    """Return the argument to add for launch files that declare it, if the base has a camera and no lidar; else nothing.

    `values` are the arguments known so far; `find_bases` loads the base that they name. Raises UserError for an unknown
    method, base or variant.
    """
    if ARGUMENT in values:
        _check(values[ARGUMENT])
        return []
    if not values.get("robot_base"):
        return []
    base = next((each.base for each in find_bases()), None)
    return [Argument(ARGUMENT, "fiducials")] if base is not None and base.raspicam and not base.lidar else []


def _check(method: str) -> None:
    if method not in METHODS:
        near = did_you_mean(method, METHODS)
        message = f"{ARGUMENT}:={method}, expected one of {', '.join(METHODS)}"
        raise UserError(error(message, rule="bad-argument", help=f"did you mean {near!r}?" if near else None))
