"""Launch file of a boot service on the robot, and its arguments."""

import base64
from collections.abc import Mapping
from dataclasses import dataclass

from ur.robot.boot.units import own_line
from ur.robot.robot_file import ROBOT_FILE
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError, user_error

# Code for roslaunch's own Python; the arguments are PACKAGE FILE.
_FIND = """\
import base64, os, sys
import rospkg
try:
    top = rospkg.RosPack().get_path(sys.argv[1])
except rospkg.ResourceNotFound:
    sys.exit(3)
for folder, folders, files in os.walk(top, followlinks=True):
    folders[:] = sorted(name for name in folders if not name.startswith('.'))
    if sys.argv[2] in files:
        path = os.path.join(folder, sys.argv[2])
        print(path)
        print(base64.b64encode(open(path, 'rb').read()).decode())
        sys.exit()
sys.exit(4)
"""
# The same with this project's modules, for robots without roslaunch.
_FIND_BY_OURS = """\
import base64, os, sys
from ur.launchfile.address import find_launch_file
from ur.launchfile.world.protocol import PackageNotFound
from ur.launchfile.world.system import SystemWorld
from ur.request.environment import add_own_package
from ur.source.diagnostic import UserError
world = SystemWorld(add_own_package(os.environ))
try:
    world.find_package(sys.argv[1])
    path = find_launch_file(sys.argv[1], sys.argv[2], world)
except PackageNotFound:
    sys.exit(3)
except UserError:
    sys.exit(4)
print(path)
print(base64.b64encode(world.read_bytes(path)).decode())
"""


@dataclass(frozen=True, slots=True)
class RobotLaunch:
    """A launch file on a robot: its path, its content, and the text of the robot's own file ('' if there is none)."""

    path: str
    data: bytes
    robot_file: str


def is_launch_name(word: str) -> bool:
    """Return whether a command-line argument is the name of a launch file."""
    return word.endswith((".launch", ".launch.xml")) and "/" not in word


def find_launch(shell: Shell, package: str, file: str, robot: str, setting: str = "") -> RobotLaunch:
    """Find a launch file in a login shell of the robot. Raises UserError if the package or file does not exist there.

    `setting` is the command that sets up a shell of a robot with ROS 2; there, this project searches for the file.
    """
    look = quote("/usr/bin/python3", "-I", "-c", _FIND, package, file)
    ours = f"{setting}; {own_line(quote('-c', _FIND_BY_OURS, package, file))}"
    done = shell.run(quote("bash", "-lc", ours if setting else f"exec {look}"))
    if done.code == 3:
        help_ = f"it lies in this computer's workspace? then: ur sync {robot}"
        raise _problem(f"{robot}: package {package!r} is not there, expected it in ~/catkin_ws/src or installed", help_)
    if done.code == 4:
        raise _problem(f"{robot}: package {package!r} has no file {file!r} there", f"ur sync {robot}")
    lines = done.out.splitlines()
    if done.code or len(lines) < 2:
        reported = (done.err.strip().splitlines() or ["no reason was given"])[-1]
        raise _problem(f"{robot}: {package} {file} cannot be looked up: {reported}", f"ur doctor {robot}")
    try:
        data = base64.b64decode(lines[-1])
    except ValueError:
        reported = "its answer is damaged"
        raise _problem(f"{robot}: {package} {file} cannot be looked up: {reported}", f"ur doctor {robot}") from None
    own = shell.run(f"cat {quote(str(ROBOT_FILE))} 2>/dev/null").out
    return RobotLaunch(lines[-2], data, own)


def choose_arguments(
    declared: Mapping[str, bool],
    given: Mapping[str, str],
    facts: Mapping[str, str],
    name: str,
    more: Mapping[str, str] | None = None,
) -> dict[str, str]:
    """Choose the arguments of a boot service's launch file: the given ones, and known properties of the robot.

    `declared` tells for each argument whether it is required; `facts` are `base` and `variant` of the robot, `more` are
    further arguments with known values. Raises UserError if an argument is missing or unknown.
    """
    values = dict(given)
    unknown = [each for each in values if each not in declared]
    if unknown:
        known = ", ".join(declared) or "(none)"
        raise _problem(f"{name} has no argument {unknown[0]!r}, expected one of {known}", f"leave {unknown[0]} out")
    own = {
        "robot_base": facts.get("base", ""),
        # A variant belongs to its base: with another base given by hand it has no meaning.
        "robot_variant": "" if "robot_base" in values else facts.get("variant", ""),
        "simulate": "false",
        "use_rviz": "false",
        **(more or {}),
    }
    values |= {key: value for key, value in own.items() if value and key in declared and key not in values}
    missing = [each for each, required in declared.items() if required and each not in values]
    if missing:
        raise _problem(f"{name} needs a value for {missing[0]}", f"add {missing[0]}:=...")
    return values


def _problem(message: str, help: str) -> UserError:
    return user_error(message, rule="no-boot-service", help=help)
