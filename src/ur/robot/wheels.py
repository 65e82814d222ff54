"""The test of a base's wheels, on this computer or a robot: which base, the line that starts it there, its result."""

from dataclasses import dataclass
from pathlib import Path

from ur.robot.base import load_base
from ur.robot.base.files import is_base_name, read_base_section
from ur.robot.base.wiring import Wiring, write_wiring
from ur.robot.boot.units import LIBRARIES, own_line
from ur.robot.robot_file import ROBOT_FILE, load_robot_file, parse_robot_file
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError, error, error_about
from ur.source.file import SourceFile
from ur.source.section import parse_section

_MOST = 200_000  # bytes of a base file


@dataclass(frozen=True, slots=True)
class OwnBase:
    """The base of this computer, and the folder whose `bases/` has it."""

    package: str
    name: str
    variant: str


def find_own_base(package: str, base: str | None, variant: str) -> OwnBase:
    """Find the base that is given, else that of the robot file. Raises UserError."""
    if base is None:
        file = load_robot_file()
        if file is None or not file.base:
            raise UserError(
                error(
                    "no base given, and this computer is no robot that was set up, expected a base",
                    rule="no-robot",
                    help="name it: ur robot wheels --here --base BASE",
                )
            )
        base, variant = file.base, file.variant
    load_base(package, base, variant)
    return OwnBase(package, base, variant)


def remote_line() -> str:
    """The line that tests the wheels where this project is set up on a robot."""
    return own_line("-m ur robot wheels --here")


def copy_wiring(shell: Shell, package: str) -> Path | None:
    """Put the wiring of a robot's base file into that of this computer; return its path, None where it has it.

    Raises UserError for a file that cannot be used, and OSError for one here.
    """
    robot = parse_robot_file(shell.run(f"head -c {_MOST} {ROBOT_FILE}").out, f"{ROBOT_FILE} of {shell.destination}")
    if robot is None or not is_base_name(robot.base):
        return None
    text = shell.run(_read_script(robot.base)).out
    if not text.strip():
        return None
    file = SourceFile(f"bases/{robot.base}/base.yaml of {shell.destination}", text)
    there = read_base_section(parse_section(file, "a base file"), robot.base, robot.variant)
    here = load_base(package, robot.base, robot.variant)
    path = Path(package, "bases", robot.base, "base.yaml")
    if there.driver is None or here.driver is None or there.driver.protocol != here.driver.protocol:
        raise UserError(
            error_about(path, "its `driver` differs from the robot's, expected the same", rule="other-base")
        )
    wiring: Wiring = there.driver.wiring
    if wiring == here.driver.wiring:
        return None
    write_wiring(path, robot.variant, wiring)
    return path


def _read_script(base: str) -> str:
    places = " ".join(f'"$HOME"/{quote(place)}' for place in LIBRARIES)
    file = f'"$d"/ubiquity_launches/bases/{quote(base)}/base.yaml'
    return f"for d in {places}; do [ ! -r {file} ] || {{ head -c {_MOST} {file}; break; }}; done"
