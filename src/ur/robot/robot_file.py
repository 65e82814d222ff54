"""The robot's own description: `/etc/ubiquity/robot.yaml`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ROBOT_FILE = Path("/etc/ubiquity/robot.yaml")


@dataclass(frozen=True, slots=True)
class RobotFile:
    """The robot's name, its base and that base's variant ('' is the plain one)."""

    name: str
    base: str
    variant: str


def load_robot_file(path: Path = ROBOT_FILE) -> RobotFile | None:
    """Read it. None when this computer is no robot. Raises UserError for a file that cannot be used."""
    if not path.exists():
        return None
    from ur.source.section import read_section  # YAML is only needed on a robot

    top = read_section(path, "a robot file")
    robot = RobotFile(top.text("name"), top.text("base"), top.text("variant", ""))
    top.has("devices")  # read by the drivers' set-up
    top.finish()
    return robot
