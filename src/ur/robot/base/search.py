"""Bases that are not in the launch package itself: in catkin workspaces that add files to it.

A workspace of CMAKE_PREFIX_PATH (a folder with a file `.catkin`) adds to a package what lies in its `share/PACKAGE`:
roslaunch itself looks for `$(find PACKAGE)/FILE` there first. So a base in a place of its own is a folder with
`.catkin` and, below `share/ubiquity_launches`, the files that are named after it.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

MARKER = ".catkin"


def is_base_name(name: str) -> bool:
    """Return whether a text can name a base: one folder below `bases/`, and no path."""
    return bool(name) and "/" not in name and "\0" not in name and name not in (".", "..")


def list_base_packages(package: Path, environment: Mapping[str, str]) -> tuple[Path, ...]:
    """The folders whose `bases/` belong to a launch package: its own and those that workspaces add, in order."""
    prefixes = [Path(prefix) for prefix in environment.get("CMAKE_PREFIX_PATH", "").split(os.pathsep) if prefix]
    added = [prefix / "share" / package.name for prefix in prefixes if (prefix / MARKER).is_file()]
    return (package, *(folder for folder in added if (folder / "bases").is_dir()))


def find_base_package(package: Path, name: str, environment: Mapping[str, str]) -> Path:
    """The first of them that has a base; the launch package where none has."""
    found = (
        folder
        for folder in list_base_packages(package, environment)
        if is_base_name(name) and (folder / "bases" / name / "base.yaml").is_file()
    )
    return next(found, package)
