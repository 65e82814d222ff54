"""Ways to install a ROS package that is not on this computer."""

from __future__ import annotations

from ur.debian.root import install_command

# Debian and Ubuntu split some ROS packages: the program is in one, what makes it known as a package in another.
_NAMES = {
    "image_transport": "image-transport-tools libimage-transport-dev",
    "image_view": "ros-image-view libimage-view-dev",
    "joint_state_publisher": "joint-state-publisher",
    "rviz": "rviz",
    "topic_tools": "topic-tools libtopic-tools-dev",
}


def describe_install(package: str) -> str:
    """What to do, as a command where Debian's names are known."""
    names = _NAMES.get(package)
    if names is not None:
        return install_command(names)
    dashed = package.replace("_", "-")
    return f"install it (apt-get install ros-{dashed} or {dashed}), or add its folder to ROS_PACKAGE_PATH"
