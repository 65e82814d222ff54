"""The selected robot: stored by `ur use`, and the default of every command.

Written `sim[:BASE[:VARIANT]]` for a simulated robot on this computer, `ROBOT[:BASE[:VARIANT]]` for a robot whose
computer is `ROBOT.local`; with ` --ros 1`, ` --ros 2` or ` --ros none` if that was chosen.
"""

import os
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.source.user_folders import user_folder

if TYPE_CHECKING:
    from pathlib import Path

SIMULATION = "sim"
DEFAULT_BASE = "stage"
_HOST = r"[A-Za-z0-9]([A-Za-z0-9-]{0,61}[A-Za-z0-9])?"  # RFC 1123, one label; texts: Tab seldom needs them
_PART = r"[A-Za-z0-9][A-Za-z0-9_-]*"
_ROS = " --ros "
_FORM = "sim[:BASE[:VARIANT]] or ROBOT[:BASE[:VARIANT]]"


class Selection(NamedTuple):
    """A selected robot.

    `base` is empty if it follows from the robot's own description; `variant` is empty for the plain base. `ros` is the
    version of ROS that was chosen, "1", "2" or "none"; empty for that of the computer (`ur.system.ros`).
    """

    robot: str = SIMULATION
    base: str = DEFAULT_BASE
    variant: str = ""
    ros: str = ""

    @property
    def simulated(self) -> bool:
        """Return whether the robot is a simulated one, on this computer."""
        return self.robot == SIMULATION

    @property
    def master_uri(self) -> str:
        """The URI of the robot's ROS master."""
        return "http://localhost:11311" if self.simulated else f"http://{self.robot}.local:11311"

    def __str__(self) -> str:
        return ":".join([self.robot, self.base, self.variant]).rstrip(":") + (_ROS + self.ros if self.ros else "")


def parse_selection(text: str) -> Selection:
    """Parse a selection as the user types it. Raises UserError for too many parts, or a part that is no name."""
    names, chosen, ros = text.strip().partition(_ROS)
    if chosen and ros not in ("1", "2", "none"):
        raise _bad(text, f"ROS {ros!r} is not known", "--ros 1, --ros 2 or --ros none")
    robot, *parts = names.split(":")
    robot = robot.removesuffix(".local")
    if not re.fullmatch(_HOST, robot):
        raise _bad(text, f"{robot!r} is not a valid host name")
    if len(parts) > 2:
        raise _bad(text, "too many parts")
    for part in parts:
        if part and not re.fullmatch(_PART, part):
            raise _bad(text, f"{part!r} is not a name")
    if names.endswith(":"):
        raise _bad(text, "nothing follows the last ':'", "'ur use sim' selects the plain simulated robot")
    base, variant = [*parts, "", ""][:2]
    if variant and not base:
        raise _bad(text, "a variant needs its base")
    return Selection(robot, base or (DEFAULT_BASE if robot == SIMULATION else ""), variant, ros)


def selection_path(environment: Mapping[str, str]) -> "Path":
    """Return the path of the file with the selection, below the user's configuration folder (XDG base directories)."""
    from pathlib import Path  # which Tab does without

    return Path(selection_file(environment))


def selection_file(environment: Mapping[str, str]) -> str:
    """Return the path of the file with the selection as a text."""
    return f"{user_folder('XDG_CONFIG_HOME', environment)}/ubiquity_launches/selection"


def load_selection(path: str | os.PathLike[str]) -> Selection:
    """Load the stored selection, or the default one if none is stored. Raises UserError for an invalid file."""
    try:
        with open(path, encoding="utf-8") as file:  # noqa: PTH123 - as above
            text = file.read()
    except FileNotFoundError:
        return Selection()
    except (OSError, UnicodeDecodeError) as problem:
        reason = ((problem.strerror if isinstance(problem, OSError) else None) or "it is no text").lower()
        raise user_error_about(path, f"cannot be read: {reason}", rule="bad-selection", help=_HELP) from None
    try:
        return parse_selection(text)
    except UserError as problem:
        message = problem.diagnostics[0].message
        raise user_error_about(path, f"{message}", rule="bad-selection", help=_HELP) from None


_HELP = "'ur use sim' selects the simulated robot again"


def store_selection(path: "Path", selection: Selection) -> None:
    """Store the selection. Raises UserError.

    The file is replaced atomically, also in case of a power cut. A symbolic link stays one.
    """
    from ur.source.replace import replace_file  # imported late, since most commands only read the selection

    try:
        replace_file(path, f"{selection}\n", parents=True)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error_about(path, f"cannot be written: {reason}", rule="bad-selection") from None


def _bad(text: str, reason: str, help: str | None = None) -> UserError:
    message = f"selection {text.strip()!r}: {reason}, expected {_FORM}"
    return user_error(message, rule="bad-selection", help=help)
