"""`ur use`: the selected robot."""

import os
import socket
import sys
from contextlib import suppress

import click

from ur.request.environment import choose_ros, current_selection
from ur.request.programs import PACKAGE
from ur.robot.selection import Selection, load_selection, parse_selection, selection_path, store_selection
from ur.source.diagnostic import UserError, user_error
from ur.source.project import project_file, state_folder
from ur.source.suggest import did_you_mean
from ur.system.ros import find_ros, note_support


@click.command("use")
@click.argument("selection", required=False, metavar="[sim|ROBOT][:BASE[:VARIANT]]")
@click.option("--away", is_flag=True, help="Select a robot that is away and was never set up from this computer.")
@click.option(
    "--ros", type=click.Choice(["1", "2", "none"]), help="The ROS of the simulated robot; it is installed if necessary."
)
def command(selection: str | None, away: bool, ros: str | None) -> int:
    """Select a robot, or show which one is selected.

    `ur use sim` selects the simulated robot, `ur use sim:magni` the simulated Magni, `ur use sim:magni:lidar` the one
    with a lidar; `ur use ROBOT` the robot whose computer answers to ROBOT.local. `ur use sim --ros 2` simulates on ROS
    2 until another `--ros` is given; `--ros none` without ROS, with all nodes in one process. Without an argument it
    prints the selection.
    """
    if selection is None:
        if away or ros:
            option = "--away" if away else f"--ros {ros}"
            wanted = "ROBOT" if away else "sim"
            raise user_error(f"{option} needs a robot", rule="bad-options", help=f"ur use {wanted} {option}")
        _show(current_selection(os.environ))
        return 0
    chosen = choose_version(parse_selection(selection), ros)
    note = "" if chosen.simulated else check_robot(chosen, away=away)
    check_base(chosen)
    if chosen.simulated and chosen.ros:
        install_ros(chosen.ros)
    store_selection(selection_path(os.environ), chosen)
    _show(chosen)
    sys.stderr.write(note)
    return 0


def choose_version(chosen: Selection, ros: str | None) -> Selection:
    """The selection with the version of ROS that an option names, else with that of the last simulated robot.

    Raises UserError for a real robot, whose version cannot be chosen.
    """
    if not chosen.simulated:
        if ros is not None:
            message = f"--ros {ros} is for the simulated robot; {chosen.robot} has a ROS of its own"
            raise user_error(message, rule="bad-options", help=f"ur use {chosen}")
        return chosen
    if ros is None and not chosen.ros:
        with suppress(UserError):
            before = load_selection(selection_path(os.environ))
            return chosen._replace(ros=before.ros if before.simulated else "")
    return chosen._replace(ros=ros or chosen.ros)


def install_ros(version: str) -> None:
    """Install a version of ROS unless it is installed. Raises UserError."""
    try:
        find_ros(version, os.environ, str(state_folder()))
    except UserError as problem:
        if any(each.rule != "no-ros" for each in problem.diagnostics):
            raise
    else:
        return
    import subprocess  # imported late: only for an installation

    script = str(project_file("tools/set_up.bash"))
    code = subprocess.run(["bash", script, f"ros{version}", str(state_folder())], check=False).returncode
    if code:
        raise user_error(f"ROS {version} could not be installed", rule="no-ros", help="see the lines above")


def _show(selection: Selection) -> None:
    sys.stdout.write(f"{selection}\n")
    sys.stdout.flush()
    ros = choose_ros(selection, os.environ) if selection.simulated else None
    if ros is not None and ros.version != 1:
        sys.stderr.write(f"{ros}{note_support(ros.distro)}\n")


def check_robot(chosen: Selection, *, away: bool) -> str:
    """Raise UserError for an unknown robot, unless it may be `away`.

    Returns a note if the robot was not set up from this computer, since it may belong to other people; '' otherwise.
    """
    from ur.robot.discovery.seen import look_up_robot
    from ur.source.progress_line import show_progress

    with show_progress(f"looking up {chosen.robot}.local"):
        found = look_up_robot(chosen.robot, os.environ, hostname=socket.gethostname())
    if found.evidence in ("set up", "this computer"):
        return ""
    near = did_you_mean(chosen.robot, found.others)
    if found.evidence == "none" and not away:
        raise user_error(
            f"unknown robot {chosen.robot!r}: it was not set up from this computer, and "
            f"{chosen.robot}.local does not answer",
            rule="unknown-robot",
            help=_advise(chosen, near),
            subject=chosen.robot,
        )
    help_ = f"did you mean 'ur use {near}'?" if near and near != chosen.robot else "'ur robots' lists the robots"
    return f"note: robot {chosen.robot!r} was not set up from this computer\n  help: {help_}\n"


def _advise(chosen: Selection, near: str | None) -> str:
    away = f"to select a robot that is away: ur use --away {chosen}"
    from ur.robot.base import list_bases
    from ur.robot.base.files import list_base_packages

    bases = tuple(name for package in list_base_packages(PACKAGE, os.environ) for name in list_bases(package))
    if chosen.robot in bases:
        simulated = ":".join(part for part in ("sim", chosen.robot, chosen.base) if part)
        return f"the simulated one is 'ur use {simulated}'; {away}"
    if near:
        return f"did you mean 'ur use {near}'? {away}"
    base = did_you_mean(chosen.robot, bases)
    if base:
        return f"did you mean the simulated robot 'ur use sim:{base}'? {away}"
    return f"'ur robots' lists the robots on the network; {away}"


def check_base(chosen: Selection) -> None:
    """Raise UserError if the base or its variant does not exist."""
    if chosen.base:
        from ur.robot.base import load_base  # YAML is only needed here
        from ur.robot.base.files import find_base_package

        load_base(find_base_package(PACKAGE, chosen.base, os.environ), chosen.base, chosen.variant)
