"""Environment variables that follow from the selected robot: printed by `ur env`, and set by every verb for itself."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping
from pathlib import Path

from ur.robot.selection import Selection, load_selection, parse_selection, selection_path
from ur.source.diagnostic import UserError
from ur.source.project import launch_library, project_folder
from ur.source.user_folders import user_folder
from ur.system.debian_root import find_root

REPOSITORY = project_folder()
PACKAGE = launch_library()
CHOSEN = "UR_ROBOT"
"""The variable that names the robot for a process and its children, as `ur web ROBOT` does; it precedes the file."""

MARK = "UR_SELECTION"  # tells what `ur env` has set from what a person has set


def current_selection(environment: Mapping[str, str]) -> Selection:
    """The selection that the environment names, else the stored one. Raises UserError: one of them is damaged."""
    if chosen := environment.get(CHOSEN):
        return parse_selection(chosen)
    return load_selection(selection_path(environment))


def environment_changes(
    selection: Selection, environment: Mapping[str, str], *, package: Path = PACKAGE, hostname: str | None = None
) -> dict[str, str]:
    """The variables to set so that `environment` follows the selection. Setting them twice changes nothing.

    A ROS_MASTER_URI or ROS_HOSTNAME that a person has set stays; one that stems from an earlier selection goes.
    """
    host = hostname or os.uname().nodename.split(".")[0]  # importing socket would slow Tab
    root = find_root(environment)
    path = environment.get("PATH", os.defpath)
    wanted = {
        "ROS_PACKAGE_PATH": _package_path(environment, package),
        "PATH": _in_front(str(package / "bin"), _in_front(root.programs, path) if root else path),
        MARK: str(selection),
    }
    before = _network(_marked(environment), host)
    for name, value in _network(selection, host).items():
        present = environment.get(name)
        if not present or present == before.get(name):
            wanted[name] = value
    if environment.get("ROS_IP") and not environment.get("ROS_HOSTNAME"):
        wanted.pop("ROS_HOSTNAME", None)  # it would override the address that a person has set
    return wanted


def add_own_package(environment: Mapping[str, str], *, package: Path = PACKAGE) -> dict[str, str]:
    """A copy of `environment` in which our launch package is on ROS_PACKAGE_PATH."""
    return {**environment, "ROS_PACKAGE_PATH": _package_path(environment, package)}


def own_packages(environment: Mapping[str, str]) -> str:
    """The folder of the ROS packages that `ur get` has made, whether there is one or not."""
    return f"{user_folder('XDG_DATA_HOME', environment)}/ubiquity_launches/packages"


def apply_selection(selection: Selection) -> None:
    """Set the variables of a selection for this process and its children, hiding a ROS 2 that the shell has sourced."""
    os.environ.update(environment_changes(selection, os.environ))
    os.environ.update(hide_ros2(os.environ))


def hide_ros2(environment: Mapping[str, str]) -> dict[str, str]:
    """The search paths to set so that programs do not find the packages of a sourced ROS 2 in place of ROS 1's.

    Both have Python packages of the same names (`sensor_msgs`, `std_msgs`, ...).
    """
    places = [
        os.path.normpath(place)
        for name in ("AMENT_PREFIX_PATH", "COLCON_PREFIX_PATH")
        for place in environment.get(name, "").split(os.pathsep)
        if place
    ]
    changes = {}
    for name in ("PYTHONPATH", "LD_LIBRARY_PATH", "CMAKE_PREFIX_PATH"):
        entries = environment.get(name, "").split(os.pathsep)
        kept = [entry for entry in entries if not any(_is_below(entry, place) for place in places)]
        if kept != entries:
            changes[name] = os.pathsep.join(kept)
    if places and environment.get("ROS_VERSION") == "2":
        changes |= {"ROS_VERSION": "1", "ROS_DISTRO": "Debian"}
    return changes


def _is_below(entry: str, place: str) -> bool:
    return f"{os.path.normpath(entry)}/".startswith(f"{place}/")


def render_exports(changes: Mapping[str, str]) -> str:
    """`export` lines for a POSIX shell."""
    return "".join(f"export {name}={shlex.quote(value)}\n" for name, value in changes.items())


def _network(selection: Selection | None, hostname: str) -> dict[str, str]:
    if selection is None:
        return {}
    own = "localhost" if selection.simulated else f"{hostname}.local"
    return {"ROS_MASTER_URI": selection.master_uri, "ROS_HOSTNAME": own}


def _marked(environment: Mapping[str, str]) -> Selection | None:
    try:
        return parse_selection(environment[MARK])
    except (KeyError, UserError):
        return None


def _package_path(environment: Mapping[str, str], package: Path) -> str:
    # What `ur get` has made comes last: a package of the system or a workspace takes its place.
    found = _in_front(str(package), environment.get("ROS_PACKAGE_PATH", ""), "/usr/share")
    made = own_packages(environment)
    there = os.path.isdir(made)  # noqa: PTH112 - this runs at each Tab
    return _in_front(found, "", made) if there and made not in found.split(os.pathsep) else found


def _in_front(first: str, paths: str, last: str | None = None) -> str:
    rest = [path for path in paths.split(os.pathsep) if path and path != first]
    if last is not None and last not in rest:
        rest.append(last)
    return os.pathsep.join([first, *rest])
