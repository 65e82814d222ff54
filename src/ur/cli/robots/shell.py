"""`ur shell`: a shell, or one command, on a robot."""

import codecs
import os
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

import click

from ur.request.environment import add_own_package
from ur.request.launch_request import LaunchFiles
from ur.request.programs import Program, find_launch_file
from ur.request.remote.connection import connect_robot, robot_address
from ur.request.remote.over_ssh import guard_link, program_arguments, read_robot, remote_script
from ur.robot.discovery.record import load_records, records_folder
from ur.robot.selection import Selection
from ur.robot.ssh.address import Address
from ur.robot.ssh.failures import explain_failure
from ur.robot.ssh.openssh import STRICT
from ur.robot.ssh.shell import quote, run_process
from ur.source.diagnostic import user_error, user_error_about
from ur.source.printable import printable_lines
from ur.source.progress_line import show_progress

# Trusted forwarding: OpenGL, and with it RViz, needs extensions that untrusted clients do not get.
_FORWARDING = ("-Y", "-o", "ExitOnForwardFailure=yes")
_OPEN_SECONDS = 3
_STILL_OPEN = 124  # timeout(1)


@click.command("shell", context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@click.option("-X", "windows", is_flag=True, help="Run a program there with its windows here.")
@click.option("--check", is_flag=True, help="With -X: only open a window, close it, and print whether that works.")
@click.argument("robot", required=False)
@click.argument("argv", nargs=-1, type=click.UNPROCESSED, metavar="[COMMAND ...]")
def command(robot: str | None, argv: tuple[str, ...], windows: bool, check: bool) -> int:
    """Open a shell on a robot, or run one command there.

    The robot's host key must be known, as it is after `ur robot setup`. The exit code is that of the command. A COMMAND
    of one argument is a command line for the shell there ('ls | wc'); several arguments are passed unchanged.
    """
    if check and not windows:
        raise click.UsageError("--check requires -X")
    if not windows:
        return run_ssh(robot_address(robot), [] if argv else ["-t"], argv)
    if not argv and not check:
        raise click.UsageError("missing argument 'COMMAND'")
    if not os.environ.get("DISPLAY"):
        raise user_error(
            "there is no display here, expected DISPLAY to be set",
            rule="no-display",
            help="run this in a terminal of your desktop",
        )
    address = robot_address(robot)
    return _check_windows(address) if check else run_ssh(address, _FORWARDING, argv)


def _check_windows(address: Address) -> int:
    """Open a window of the robot for a moment. Raises UserError if that fails."""
    script = quote("timeout", str(_OPEN_SECONDS), "xlogo")  # of x11-apps, which `ur robot setup` installs
    command = ["ssh", *_FORWARDING, *STRICT, "-o", "BatchMode=yes", "--", str(address), script]
    with show_progress(f"waiting for a window of {address.host}"):
        done = run_process(command, timeout=30, what=f"a window of {address}")
    if done.code == _STILL_OPEN:
        click.echo(f"a window of {address.host} opened here and was closed again")
        return 0
    if done.code == 255:
        raise explain_failure(address, done.err)
    reported = (done.err.strip().splitlines() or ["no reason was given"])[-1]
    if "not found" in reported or "No such file" in reported:
        help_ = f"ur robot setup {address.host}"
    else:
        help_ = f"is the display here open to you? 'xauth list' and 'echo $DISPLAY'; then ur doctor {address.host}"
    raise user_error_about(address, f"no window opened: {reported}", rule="no-window", help=help_)


def run_ssh(address: Address, options: Sequence[str], argv: Sequence[str], *, escaped: bool = False) -> int:
    """Run ssh with this terminal and return its exit code. Raises UserError if there was no connection.

    A single argument is a shell line on the robot; several arguments are passed unchanged. `escaped`: see
    `run_in_front`.
    """
    script = [argv[0] if len(argv) == 1 else quote(*argv)] if argv else []
    sys.stdout.flush()
    with tempfile.TemporaryDirectory(prefix="ur-") as folder:
        log = Path(folder) / "log"
        log.touch()
        code = run_in_front(["ssh", *STRICT, "-E", str(log), *options, "--", str(address), *script], escaped=escaped)
        reported = log.read_text(encoding="utf-8", errors="replace")
    if code == 255 and reported.strip():
        raise explain_failure(address, reported)
    sys.stderr.writelines(line for line in reported.splitlines(keepends=True) if not line.startswith("Connection to "))
    return code if code >= 0 else 128 - code


def run_in_front(command: Sequence[str], *, escaped: bool = False) -> int:
    """Run a program with this terminal; return its exit code.

    Signals that end this process end it too, and it handles Ctrl-C itself. `escaped`: its output is text, in which
    control characters except those of colours are shown as escapes.
    """
    running: list[subprocess.Popen[bytes]] = []
    early: list[int] = []

    def hand_on(number: int, _: object) -> None:
        if number == signal.SIGINT:  # the terminal sends it to both processes
            return
        if running:
            running[0].send_signal(number)
        else:
            early.append(number)

    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    # Before the start, so that no signal ends this process alone. It does not inherit them: handlers end with exec.
    before = [signal.signal(number, hand_on) for number in numbers]
    try:
        output, errors = (subprocess.PIPE, subprocess.STDOUT) if escaped else (None, None)
        running.append(subprocess.Popen(command, stdout=output, stderr=errors))
        for number in early:
            running[0].send_signal(number)
        if running[0].stdout:
            print_escaped(running[0].stdout.fileno())
        return running[0].wait()
    except (FileNotFoundError, PermissionError):  # the second where a folder of PATH cannot be read
        raise user_error(
            f"{command[0]} is not installed here", rule="missing-program", help="run: ur setup", subject=command[0]
        ) from None
    finally:
        for number, handler in zip(numbers, before, strict=True):
            signal.signal(number, handler)


def print_escaped(output: int) -> None:
    """Print text as it arrives; ssh has set the terminal so that each line has to end with a carriage return, too."""
    decoder, rest = codecs.getincrementaldecoder("utf-8")("replace"), ""
    while data := os.read(output, 65536):
        text = rest + decoder.decode(data)
        rest = "\r" if text.endswith("\r") else ""
        lines = text.removesuffix("\r").replace("\r\n", "\n").split("\n")
        sys.stdout.write(
            ("\r\n" if sys.stdin.isatty() and sys.stdout.isatty() else "\n").join(map(_escape_all_but_colours, lines))
        )
        sys.stdout.flush()


def _escape_all_but_colours(line: str) -> str:
    parts = re.split(r"(\x1b\[[0-9;]*m)", line)
    return "".join(part if number % 2 else printable_lines(part) for number, part in enumerate(parts))


FIRST_PORT = 8090


def is_over_ssh(selection: Selection) -> bool:
    """Return whether the selected robot is another computer that was set up with ROS 2."""
    if selection.simulated or os.uname().nodename.split(".")[0] == selection.robot:
        return False
    return any(each.name == selection.robot and each.ros for each in load_records(records_folder(os.environ)))


def run_there(selection: Selection, program: Program, options: Sequence[str], argv: Sequence[str]) -> int:
    """Run a program on the robot, with this terminal; return its exit code. Raises UserError.

    Keys drive only while the connection is verified, see `guard_link`.
    """
    from ur.launchfile.world.system import SystemWorld

    path = find_launch_file(program)
    declared = LaunchFiles([str(path)], SystemWorld(add_own_package(os.environ))).declared if path else ()
    terminal = sys.stdin.isatty() and sys.stdout.isatty()
    with connect_robot(robot_address(selection.robot)) as shell:
        robot, ros2 = read_robot(shell)
        with guard_link(shell) if terminal else nullcontext("") as link:
            words = ["run", program.name, *options, *program_arguments(robot, argv, declared)]
            script = remote_script(robot.name, ros2, words, link)
            sys.stdout.flush()
            return run_in_front([*shell.words, "-t" if terminal else "-T", "--", shell.destination, script])


def serve_there(selection: Selection, port: int | None, options: Sequence[str]) -> int:
    """Serve the page on the robot, on the loopback interfaces of both computers; return the exit code.

    Raises UserError.
    """
    port = port or FIRST_PORT
    with connect_robot(robot_address(selection.robot)) as shell:
        robot, ros2 = read_robot(shell)
        words = ["web", "--no-browser", "--port", str(port), *options]
        script = remote_script(robot.name, ros2, words)
        if not shell.forward(port):
            message = f"port {port} of this computer is in use, or the robot's ssh server forwards none"
            raise user_error(message, rule="no-port", help="choose another one: ur web --port PORT")
        sys.stdout.flush()
        return run_in_front([*shell.words, "-t", "--", shell.destination, script])
