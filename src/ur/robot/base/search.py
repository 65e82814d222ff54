"""Search for bases in catkin workspaces that extend the launch package.

A workspace of CMAKE_PREFIX_PATH (a folder with a file `.catkin`) adds the files in its `share/PACKAGE` to a package:
roslaunch itself searches there first for `$(find PACKAGE)/FILE`. So a base outside the launch package is a folder with
a file `.catkin` and, below `share/ubiquity_launches`, the files that are named after the base. Those that `ur new base`
has made are remembered for the user, after those of the environment.
"""

from collections.abc import Mapping
from pathlib import Path

from ur.source.user_folders import MARKER, list_workspaces


def is_base_name(name: str) -> bool:
    """Return whether a text is a valid base name: a single folder name, not a path."""
    return bool(name) and "/" not in name and "\0" not in name and name not in (".", "..")


def list_base_packages(package: Path, environment: Mapping[str, str]) -> tuple[Path, ...]:
    """Return the folders whose `bases/` belong to a launch package: its own, then those of workspaces, in order."""
    prefixes = map(Path, list_workspaces(environment))
    added = [prefix / "share" / package.name for prefix in prefixes if (prefix / MARKER).is_file()]
    return (package, *(folder for folder in added if (folder / "bases").is_dir()))


def find_base_package(package: Path, name: str, environment: Mapping[str, str]) -> Path:
    """Return the first of these folders that contains the base; the launch package if none does."""
    found = (
        folder
        for folder in list_base_packages(package, environment)
        if is_base_name(name) and (folder / "bases" / name / "base.yaml").is_file()
    )
    return next(found, package)
