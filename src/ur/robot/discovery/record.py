"""Records of the robots that were set up from this computer: one file each, written by `ur robot setup`."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ur.robot.selection import selection_path
from ur.source.diagnostic import UserError

DEFAULT_USER = "ros"


@dataclass(frozen=True, slots=True)
class RobotRecord:
    """A robot that was set up from this computer, with the user to log in as.

    `robot_login` is whether the user lets it log in to this computer; None where not asked. `ros` is its release of ROS
    2, '' for ROS 1. `access_point` is the password of its own access point, '' if it has none.
    """

    name: str
    user: str
    base: str
    variant: str = ""
    robot_login: bool | None = None
    ros: str = ""
    access_point: str = ""


def records_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder of the records, beside the file of the selection."""
    return selection_path(environment).parent / "robots"


def render_record(record: RobotRecord) -> str:
    """Return the text of a record's file."""
    keys = ("name", "user", "base", "variant", "ros", "access_point")
    texts = "".join(f'{key}: "{value}"\n' for key in keys if (value := getattr(record, key)))
    login = "" if record.robot_login is None else f"robot_login: {str(record.robot_login).lower()}\n"
    return f"# Written by ur robot setup.\n{texts}{login}"


def load_records(folder: Path) -> list[RobotRecord]:
    """Load all records, sorted by name. Unreadable ones are skipped."""
    return [record for path in sorted(folder.glob("*.yaml")) if (record := _load_record(path))]


def _load_record(path: Path) -> RobotRecord | None:
    from ur.source.section import read_section  # YAML is only needed where robots are listed

    try:
        top = read_section(path, "a record of a robot")
        login = top.boolean("robot_login", False) if top.has("robot_login") else None
        texts = (top.text("name"), top.text("user"), top.text("base"), top.text("variant", ""))
        return RobotRecord(*texts, login, top.text("ros", ""), top.text("access_point", ""))
    except UserError:
        return None


def find_user(name: str, folder: Path) -> str:
    """Return the user to log in as on a robot: that of its record, else DEFAULT_USER."""
    return next((record.user for record in load_records(folder) if record.name == name), DEFAULT_USER)
