"""Environment variables that follow from the selected robot: printed by `ur env`, and set by every verb for itself."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping
from pathlib import Path

from ur.debian.root import find_root
from ur.robot.selection import Selection, load_selection, parse_selection, selection_path
from ur.source.diagnostic import UserError
from ur.source.project import launch_library, project_folder
from ur.source.user_folders import user_folder

REPOSITORY = project_folder()
PACKAGE = launch_library()
MARK = "UR_SELECTION"  # tells what `ur env` has set from what a person has set


def current_selection(environment: Mapping[str, str]) -> Selection:
    """The stored selection. Raises UserError when its file is damaged."""
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
    """Set the variables of a selection for this process and its children."""
    os.environ.update(environment_changes(selection, os.environ))


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
