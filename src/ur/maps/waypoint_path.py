"""The file of a map's named places, which `keyboard_navigate` also reads and writes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ur.source.user_folders import user_folder


def waypoint_path(name: str, environment: Mapping[str, str]) -> Path:
    """Return the waypoint file of a stored map."""
    return Path(user_folder("XDG_DATA_HOME", environment), "ubiquity_launches", "waypoints", f"{name}.yaml")
