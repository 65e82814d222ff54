"""Installation of ROS packages that are not on this computer."""

from __future__ import annotations

from pathlib import Path

from ur.source.suggest import get_command
from ur.system.debian_root import install_command

OS_RELEASE = Path("/etc/os-release")
# Debian and Ubuntu split some ROS packages: one has the program, another one the package's manifest.
_NAMES = {
    "image_transport": "image-transport-tools libimage-transport-dev",
    "image_view": "ros-image-view libimage-view-dev",
    "joint_state_publisher": "joint-state-publisher",
    "rviz": "rviz",
    "topic_tools": "topic-tools libtopic-tools-dev",
}


def is_packaged(name: str, os_release: Path = OS_RELEASE) -> bool:
    """Return whether this computer's release has a Debian package; True if that is unknown."""
    from ur.system.releases import find_release, parse_os_release

    try:
        system = parse_os_release(os_release.read_text(encoding="utf-8", errors="replace"))
    except OSError:
        return True
    return name not in find_release(system).missing


def describe_install(package: str, os_release: Path = OS_RELEASE) -> str:
    """Describe the installation: a command if the Debian package is known and exists in this computer's release."""
    names = _NAMES.get(package)
    if names is not None and not is_packaged(names, os_release):
        return "this release does not package it; the terminal shows the map"
    if names is not None:
        return install_command(names)
    return f"{get_command(package)}, or add its folder to ROS_PACKAGE_PATH"
