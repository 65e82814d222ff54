"""The launch argument `localisation`, which depends on the robot's sensors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from ur.source.arguments import Argument
from ur.source.diagnostic import UserError, user_error
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
        method = values[ARGUMENT]
        if method not in METHODS:
            near = did_you_mean(method, METHODS)
            message = f"{ARGUMENT}:={method}, expected one of {', '.join(METHODS)}"
            raise user_error(message, rule="bad-argument", help=f"did you mean {near!r}?" if near else None)
        return []
    if not values.get("robot_base"):
        return []
    base = next((each.base for each in find_bases()), None)
    return [Argument(ARGUMENT, "fiducials")] if base is not None and base.raspicam and not base.lidar else []


def explain_no_map(problem: UserError, values: Mapping[str, str]) -> UserError:
    """Explain that a robot without a lidar has no map of fiducials either; other problems are returned unchanged."""
    base = values.get("robot_base", "")
    if problem.diagnostics[0].rule != "no-file" or not base or values.get(ARGUMENT) != "fiducials":
        return problem
    chosen = " ".join(f"{name}:={values[name]}" for name in ("robot_base", "robot_variant") if values.get(name))
    return user_error(
        f"base {base!r} has no lidar, and there is no map of fiducials for its camera",
        rule="no-file",
        help=f"drive it by hand: ur run keyboard_drive {chosen}; or build such a map where fiducials are: "
        f"ur run fiducial_slam {chosen} (simulated: with world:=office)",
    )
