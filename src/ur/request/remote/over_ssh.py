"""Programs of a robot with ROS 2, which run on the robot, with the terminal of this computer over ssh.

DDS stays on the robot. A guard verifies the connection many times per second, so that keys drive only while it works.
"""

import secrets
import subprocess
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from importlib.resources import files

from ur.robot.boot.units import LIBRARIES, source_line
from ur.robot.robot_file import ROBOT_FILE, RobotFile, Ros2Robot, parse_robot_file
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import Shell, quote
from ur.source.arguments import split_argv
from ur.source.diagnostic import user_error_about

_FIND = f"""\
for d in {" ".join(f'"$HOME"/{place}' for place in LIBRARIES)}; do
  [ -r "$d/.venv/ready-run" ] && exec "$d/.venv/bin/python" -I -m ur "$@"
done
echo "error: ubiquity_launches is not set up on the robot, expected it in ~/{LIBRARIES[1]}" >&2
echo "  help: ur robot setup completes it" >&2
exit 2"""


def find_robot_file(shell: Shell) -> RobotFile | None:
    """Read the robot file of a robot; None if it has none. Raises UserError for an invalid file."""
    return parse_robot_file(shell.run(f"cat {ROBOT_FILE} 2>/dev/null").out)


def read_robot(shell: SshShell) -> tuple[RobotFile, Ros2Robot]:
    """Read the robot file of a robot with ROS 2. Raises UserError if it has no ROS 2, or is not set up."""
    found = find_robot_file(shell)
    if found is None or found.ros2 is None:
        name = shell.address.host.removesuffix(".local")
        message = f"{ROBOT_FILE} names no release of ROS 2, expected one"
        raise user_error_about(shell.destination, message, rule="bad-robot-file", help=f"ur robot setup {name}")
    return found, found.ros2


def remote_script(robot: str, ros2: Ros2Robot | None, argv: Sequence[str], link: str = "") -> str:
    """Return the script that runs `ur` on a robot, in the domain and with the middleware of its nodes.

    `ros2` is None for a robot with ROS 1. `link` is the file of the guard; '' for programs that do not drive by the
    terminal.
    """
    settings = (source_line(ros2, robot) if ros2 is not None else ":") + (f" UR_LINK={quote(link)}" if link else "")
    return quote("bash", "-lc", f"{settings}; set -- {quote(*argv)}; {_FIND}")


def program_arguments(robot: RobotFile, argv: Sequence[str], declared: Collection[str]) -> list[str]:
    """Return the arguments of a program on a robot whose drivers are already running; those of the user stay."""
    assert robot.ros2
    own = {"robot_base": robot.base, "robot_variant": robot.variant, **robot.ros2.arguments()}
    given = split_argv(argv).values
    return [
        *argv,
        *(f"{name}:={value}" for name, value in own.items() if value and name in declared and name not in given),
    ]


@contextmanager
def guard_link(shell: SshShell) -> Iterator[str]:
    """Verify the connection to a robot while the context lasts; yield the path of the robot's file with the last proof.

    It uses the same connection as the terminal, whose bytes stay in order: keys that an outage has delayed arrive
    before the first new proof, and drive nothing.
    """
    link = f"/dev/shm/ur-link-{secrets.token_hex(8)}"  # noqa: S108 - a new name that cannot be guessed
    program = files("ur.request.remote").joinpath("link_guard.py").read_text("utf-8")
    guard = shell.start(f"exec python3 -I -c {quote(program)} {quote(link)}")
    # What the guard sends goes back by a process of this computer: one that is suspended proves nothing.
    echo = subprocess.Popen(["cat"], stdin=guard.stdout, stdout=guard.stdin, start_new_session=True)
    try:
        yield link
    finally:
        for process in (echo, guard):
            process.terminate()
            process.wait()
