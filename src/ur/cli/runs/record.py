"""`ur record`: write topics to MCAP files for as long as wanted."""

import os
import sys
from collections.abc import Sequence

import click

from ur.source.arguments import Argument, CommandLine
from ur.source.diagnostic import user_error
from ur.source.project import launch_library

_LAUNCH = "n_record/launch/n_record.launch.xml"
_RUN = "n_record"


@click.command("record")
@click.argument("topics", nargs=-1)
@click.option("--to", "folder", metavar="FOLDER", help="The folder of the files.")
@click.option(
    "--split", "megabytes", type=click.FloatRange(min=1), metavar="MB", help="Begin a new file after so many MB."
)
@click.option("--keep-free", "free", type=click.FloatRange(min=10), metavar="MB", help="End while so many MB are free.")
@click.option("--detach", is_flag=True, help="Record in the background, until 'ur record --stop'.")
@click.option("--stop", is_flag=True, help="End the recording that runs in the background, or on the robot.")
def command(
    topics: tuple[str, ...], folder: str | None, megabytes: float | None, free: float | None, detach: bool, stop: bool
) -> int:
    """Record topics to MCAP files, for as long as you like.

    The files are compressed and split, and the disk is never filled. On a selected robot they are on the robot, and the
    recording continues without this computer until `ur record --stop`. On this computer, Ctrl-C ends the recording.
    """
    from ur.request.environment import current_selection

    for each in topics:
        if " " in each or ":=" in each:
            message = f"{each!r} is no name of a topic, expected one such as '/scan' or '/camera/*'"
            raise user_error(message, rule="bad-name", help="ur record /scan /tf", subject=each)
    selection = current_selection(os.environ)
    here = selection.simulated or os.uname().nodename.partition(".")[0] == selection.robot
    if stop:
        from ur.cli.runs.stop import stop_run

        return stop_run(_RUN, output=True) if here else _run_there(selection.robot, ["record", "--stop"])
    if here:
        from ur.cli.launch.launch import launch_line
        from ur.request.launch_request import LaunchOptions

        given = {
            "topics": " ".join(topics),
            "folder": os.path.abspath(folder) if folder else "",  # noqa: PTH100 - a text
            "split_megabytes": f"{megabytes:g}" if megabytes else "",
            "free_megabytes": f"{free:g}" if free else "",
        }
        arguments = tuple(Argument(name, value) for name, value in given.items() if value)
        line = CommandLine((str(launch_library() / _LAUNCH),), arguments)
        return launch_line(line, LaunchOptions(detach=detach, wait=detach, watch=True))
    options = {"--to": folder, "--split": megabytes, "--keep-free": free}
    chosen = [word for name, value in options.items() if value is not None for word in (name, str(value))]
    code = _run_there(selection.robot, ["record", "--detach", *chosen, *topics])
    if code == 0:
        sys.stderr.write(f"{selection.robot} records without this computer from now on; end it: ur record --stop\n")
    return code


def _run_there(robot: str, words: Sequence[str]) -> int:
    """Run a command of `ur` on the robot."""
    from ur.cli.robots.shell import run_in_front
    from ur.request.remote.connection import connect_robot, robot_address
    from ur.request.remote.over_ssh import find_robot_file, remote_script

    with connect_robot(robot_address(robot)) as shell:
        found = find_robot_file(shell)
        ros2 = found.ros2 if found is not None else None
        script = remote_script(robot, ros2, words)
        sys.stdout.flush()
        return run_in_front([*shell.words, "-T", "--", shell.destination, script], escaped=True)
