"""`ur replay`: play a recording, into a program if one is named."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from ur.recordings.replays import ReplayCommand, send_command
from ur.source.diagnostic import UserError, error, error_about


@click.command("replay", context_settings={"ignore_unknown_options": True})
@click.argument("recording", required=False, metavar="[FILE]")
@click.argument("program", required=False)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[NAME:=VALUE]...")
@click.option("--speed", type=float, metavar="FACTOR", help="Play so many times as fast as it was recorded.")
@click.option("--from", "start", type=float, metavar="SECONDS", help="Begin so many seconds after its start.")
@click.option("--info", is_flag=True, help="Print what the recording holds, and play nothing.")
@click.option("--pause", is_flag=True, help="Pause the replay that runs.")
@click.option("--play", is_flag=True, help="Let the replay that runs go on.")
@click.option("--jump", type=float, metavar="SECONDS", help="Let the replay that runs go on at this second.")
@click.option("--back", type=float, metavar="SECONDS", help="Jump back by so many seconds.")
def command(
    recording: str | None,
    program: str | None,
    arguments: tuple[str, ...],
    speed: float | None,
    start: float | None,
    info: bool,
    pause: bool,
    play: bool,
    jump: float | None,
    back: float | None,
) -> int:
    """Play a recording, into a program if one is named.

    FILE is an MCAP file, of the black box or another recorder. The program starts without the nodes of the robot, and
    shows what the recording holds. Without FILE, the options reach the replay that runs.
    """
    if recording is None:
        return _control(speed, jump, back, pause=pause, play=play)
    if pause or play or jump is not None or back is not None:
        message = "--pause, --play, --jump and --back reach a replay that runs, expected no file"
        raise UserError(error(message, rule="bad-options", help="'--from SECONDS' begins later"))
    if info:
        return _describe(Path(recording))
    return _play(Path(recording), program or "", arguments, 1.0 if speed is None else speed, start or 0.0)


def _control(speed: float | None, jump: float | None, back: float | None, *, pause: bool, play: bool) -> int:
    commands = [ReplayCommand("pause")] if pause else [ReplayCommand("play")] if play else []
    commands += [ReplayCommand("speed", speed)] if speed is not None else []
    commands += [ReplayCommand("jump", jump)] if jump is not None else []
    commands += [ReplayCommand("back", back)] if back is not None else []
    if not commands:
        raise UserError(error("expected the file of a recording", rule="bad-options", help="ur replay --help"))
    for each in commands:
        if not send_command(each, os.environ):
            raise UserError(
                error("no replay runs on this computer", rule="no-replay", help="ur replay FILE starts one")
            )
    return 0


def _describe(path: Path) -> int:
    from ur.recordings.description import describe_recording
    from ur.recordings.mcap_file import open_recording
    from ur.request.requirements.python_packages import need_all

    need_all(["mcap"], "recordings.lock", "what recordings need (8 MB to download)")
    sys.stdout.write("".join(f"{line}\n" for line in describe_recording(open_recording(path))))
    return 0


def _play(path: Path, program: str, arguments: tuple[str, ...], speed: float, start: float) -> int:
    from ur.cli.launch.start import run_launch
    from ur.request.arguments import split_argv
    from ur.request.environment import PACKAGE, add_own_package, apply_selection, current_selection
    from ur.request.joining.replaying import plan_replay
    from ur.request.options import LaunchOptions, StartReporter
    from ur.request.plan_files import make_world
    from ur.request.programs import find_launch_file, find_program
    from ur.robot.selection import Selection

    if not path.is_file():
        help_ = "'ls ~/.local/state/ur/black_box' lists the recordings of the black box"
        raise UserError(error_about(str(path), "no such file, expected a recording", rule="missing-file", help=help_))
    launch_file = ""
    if program:
        found = find_program(PACKAGE, program, add_own_package(os.environ))
        file = find_launch_file(found)
        if file is None:
            message = f"program '{program}' starts no launch file of its package, expected one that does"
            raise UserError(error(message, rule="no-launch-file", help="ur list --launch-files", subject=program))
        launch_file = str(file)
    names, given = split_argv(arguments)
    if names:
        raise UserError(
            error(f"'{names[0]}' is no argument, expected NAME:=VALUE", rule="bad-argument", subject=names[0])
        )
    stored = current_selection(os.environ)
    base = (stored.base, stored.variant) if stored.simulated else ("", "")
    selection = Selection(base=base[0] or Selection().base, variant=base[1], ros=stored.ros)
    apply_selection(selection)
    launch = plan_replay(path, launch_file, given, selection, make_world(), playback=(speed, start))
    options = LaunchOptions(except_=launch.left_out, watch=True)
    return run_launch(launch.argv, selection, options, StartReporter(), None)
