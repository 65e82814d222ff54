"""The robot's own description: `/etc/ubiquity/robot.yaml`."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from ur.source.data_classes import dataclass
from ur.source.diagnostic import user_error_about

if TYPE_CHECKING:
    from ur.robot.base.calibration import Calibration
    from ur.source.section import Section

ROBOT_FILE = Path("/etc/ubiquity/robot.yaml")
_TEXTS = {  # by key, the pattern of its value; each becomes part of command lines
    "ros": re.compile(r"[a-z]{1,20}"),
    "ros_domain": re.compile(r"[0-9]{1,3}"),
    "ros_middleware": re.compile(r"(rmw_[a-z0-9_]{1,40})?"),
    "ros_namespace": re.compile(r"((/[A-Za-z_][A-Za-z0-9_]{0,60}){1,5})?"),
    "ros_commands": re.compile(r"(/[A-Za-z_][A-Za-z0-9_]{0,60}){1,6}"),
}
COMMANDS = "/cmd_vel"
_ZENOH = "rmw_zenoh_cpp"
_ROUTER_PORT = 7447


@dataclass(frozen=True, slots=True)
class Ros2Robot:
    """ROS 2 of a robot: its release, domain id, middleware ('': the release's default) and namespace ('': none).

    `commands` is the topic that its base subscribes to.
    """

    distro: str
    domain: str = "0"
    middleware: str = ""
    namespace: str = ""
    commands: str = COMMANDS

    def rows(self) -> dict[str, str]:
        """Return the values by their keys in the robot file."""
        values = (self.distro, self.domain, self.middleware, self.namespace, self.commands)
        return dict(zip(_TEXTS, values, strict=True))

    def variables(self, robot: str) -> dict[str, str]:
        """Return the environment variables of programs that run on the robot of this name and join its nodes."""
        wanted = {
            "UR_ROBOT": robot,
            "ROS_DOMAIN_ID": self.domain,
            "RMW_IMPLEMENTATION": self.middleware,
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",  # as in nodes that this project has not started
            "ROS_NAMESPACE": self.namespace,
        }
        return {name: value for name, value in wanted.items() if value}

    def guest_variables(self, host: str) -> dict[str, str]:
        """Return the environment variables of programs on another computer, such as RViz 2, that connect to its nodes.

        Multicast often fails on WiFi, so the robot is named as a peer; for Zenoh, its router is named.
        """
        wanted = {
            "ROS_DOMAIN_ID": self.domain,
            "RMW_IMPLEMENTATION": self.middleware,
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
        }
        if self.middleware == _ZENOH:
            wanted["ZENOH_CONFIG_OVERRIDE"] = f'mode="client";connect/endpoints=["tcp/{host}:{_ROUTER_PORT}"]'
        else:
            wanted["ROS_STATIC_PEERS"] = host
        return {name: value for name, value in wanted.items() if value}

    def arguments(self) -> dict[str, str]:
        """Return the arguments of launch files for a robot whose drivers already run."""
        return {"start_drivers": "false", "cmd_vel": self.commands}


@dataclass(frozen=True, slots=True)
class RobotFile:
    """The robot's name, its base, that base's variant ('' for the plain one), and its ROS 2; None for ROS 1.

    `calibration` is how this robot differs from its base file; None where that is not known.
    """

    name: str
    base: str
    variant: str
    ros2: Ros2Robot | None = None
    calibration: Calibration | None = None


def load_robot_file(path: Path = ROBOT_FILE) -> RobotFile | None:
    """Load the robot file. None if this computer is not a robot. Raises UserError for an invalid file."""
    if not path.exists():
        return None
    from ur.source.section import read_section  # YAML is only needed on a robot

    return _read(read_section(path, "a robot file"), str(path))


def parse_robot_file(text: str, place: str = str(ROBOT_FILE)) -> RobotFile | None:
    """Parse the text of a robot file; None for an empty text. Raises UserError, which names `place`."""
    from ur.source.file import SourceFile
    from ur.source.section import parse_section

    return _read(parse_section(SourceFile(place, text), "a robot file"), place) if text else None


def _read(top: Section, place: str) -> RobotFile:
    values = [top.text(key, default) for key, default in zip(_TEXTS, ("", "0", "", "", COMMANDS), strict=True)]
    calibration = None
    if part := top.optional_section("calibration"):
        from ur.robot.base.calibration import read_calibration  # few robots have one

        calibration = read_calibration(part)
    ros2 = make_ros2(place, values)
    robot = RobotFile(top.text("name"), top.text("base"), top.text("variant", ""), ros2, calibration)
    top.has("devices")  # read by the drivers' set-up
    top.finish()
    return robot


def make_ros2(place: str, values: list[str]) -> Ros2Robot | None:
    """Return a robot's ROS 2 settings from the texts of their values; None if it has none.

    Raises UserError, which names `place`.
    """
    if not values[0]:
        return None
    for (key, shape), value in zip(_TEXTS.items(), values, strict=True):
        if not shape.fullmatch(value):
            message = f"{key} is {value[:60]!r}, expected such as {_EXAMPLES[key]}"
            raise user_error_about(place, message, rule="bad-robot-file", help="ur robot setup writes it again")
    return Ros2Robot(*values)


_EXAMPLES = {
    "ros": "jazzy",
    "ros_domain": "0",
    "ros_middleware": "rmw_cyclonedds_cpp",
    "ros_namespace": "/robot1",
    "ros_commands": "/robot1/cmd_vel",
}
