"""`ur replay`: play a recording, into a program if one is named."""

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from ur.recordings.replays import ReplayCommand, ask_replay, describe_state
from ur.source.ansi import is_plain
from ur.source.arguments import Argument, split_argv
from ur.source.diagnostic import user_error, user_error_about


@click.command("replay", context_settings={"ignore_unknown_options": True})
@click.argument("recording", required=False, metavar="[FILE]")
@click.argument("program", required=False)
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[NAME:=VALUE]...")
@click.option("--speed", type=float, metavar="FACTOR", help="Play so many times as fast as it was recorded.")
@click.option("--from", "start", type=float, metavar="SECONDS", help="Begin so many seconds after its start.")
@click.option("--info", is_flag=True, help="Print what the recording holds, and play nothing.")
def command(
    recording: str | None,
    program: str | None,
    arguments: tuple[str, ...],
    speed: float | None,
    start: float | None,
    info: bool,
) -> int:
    """Play a recording, into a program if one is named.

    The program starts without the nodes of the robot, and shows what the recording holds. Without FILE, this terminal
    shows the replay that runs, and takes keys.
    """
    if recording is None:
        if (state := ask_replay(ReplayCommand("state"), os.environ)) is None:
            message = "no replay runs on this computer, expected the file of a recording"
            raise user_error(message, rule="no-replay", help="ur replay FILE starts one")
        if sys.stdin.isatty() and sys.stdout.isatty() and not is_plain(os.environ):
            from ur.cli.runs.replay_screen import show_replay

            return show_replay(os.environ)
        sys.stdout.write(f"{describe_state(state)}\n")
        return 0
    from ur.recordings.mcap_file import check_recording

    if info:
        check_recording(Path(recording))
        path = Path(recording)
        from ur.recordings.mcap_file import describe_recording, open_recording
        from ur.request.requirements.python_packages import need_all

        need_all(["mcap"], "recordings.lock", "what recordings need (8 MB to download)")
        sys.stdout.write("".join(f"{line}\n" for line in describe_recording(open_recording(path))))
        return 0
    played = _read_request(recording, program or "", arguments)
    check_recording(played.path)
    return _play(played, 1.0 if speed is None else speed, start or 0.0)


@dataclass(frozen=True, slots=True)
class _Played:
    """A recording, the launch file of the program that it is played into ('' for none), and the program's arguments."""

    path: Path
    launch_file: str
    arguments: tuple[Argument, ...]


def _read_request(recording: str, program: str, arguments: Sequence[str]) -> _Played:
    from ur.request.environment import add_own_package
    from ur.request.programs import PACKAGE, find_launch_file, find_program

    path = Path(recording)
    if not path.is_file():
        help_ = "'ls ~/.local/state/ur/black_box' lists the recordings of the black box"
        raise user_error_about(recording, "no such file, expected a recording", rule="missing-file", help=help_)
    names, given = split_argv(arguments)
    if names:
        raise user_error(f"'{names[0]}' is no argument, expected NAME:=VALUE", rule="bad-argument", subject=names[0])
    if not program:
        return _Played(path, "", tuple(given))
    file = find_launch_file(find_program(PACKAGE, program, add_own_package(os.environ)))
    if file is None:
        message = f"program '{program}' starts no launch file of its package, expected one that does"
        raise user_error(message, rule="no-launch-file", help="ur list --launch-files", subject=program)
    return _Played(path, str(file), tuple(given))


def _play(played: _Played, speed: float, start: float) -> int:
    from ur.cli.launch.launch import run_launch
    from ur.request.environment import apply_selection, current_selection
    from ur.request.joining.replaying import plan_replay
    from ur.request.launch_request import LaunchOptions, StartReporter
    from ur.request.plan_files import make_world
    from ur.robot.selection import Selection

    stored = current_selection(os.environ)
    base = (stored.base, stored.variant) if stored.simulated else ("", "")
    selection = Selection(base=base[0] or Selection().base, variant=base[1], ros=stored.ros)
    apply_selection(selection)
    world = make_world()
    launch = plan_replay(played.path, played.launch_file, played.arguments, selection, world, playback=(speed, start))
    options = LaunchOptions(except_=launch.left_out, watch=True, program="replay")
    return run_launch(launch.line, selection, options, StartReporter(), None)
