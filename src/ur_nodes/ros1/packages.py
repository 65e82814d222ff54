"""Folders of installed packages of ROS 1."""

from pathlib import Path

import rospkg


def find_package(name: str) -> Path | None:
    """The folder of a package; None where it is not installed."""
    try:
        return Path(rospkg.RosPack().get_path(name))
    except rospkg.ResourceNotFound:
        return None
