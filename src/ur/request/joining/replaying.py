"""A recording in place of the robot: the files that a replay starts, and the nodes that it leaves out."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from ur.launchfile.load import load_plan
from ur.launchfile.world.protocol import World
from ur.request.launch_request import make_request
from ur.request.plan_files import complete_arguments, describe_computer, texts
from ur.robot.selection import Selection
from ur.source.arguments import Argument, CommandLine
from ur.source.project import launch_library

_ROBOT_MACHINE = "robot_machine"
_RECORDED = "recorded-robot"
REPLAY = "n_replay/launch/n_replay.launch.xml"


@dataclass(frozen=True, slots=True)
class ReplayLaunch:
    """The names and arguments for `ur launch`, and the nodes that are left out."""

    line: CommandLine
    left_out: tuple[str, ...]


def plan_replay(
    recording: Path,
    program: str,
    arguments: Iterable[Argument],
    selection: Selection,
    world: World,
    *,
    playback: tuple[float, float],
) -> ReplayLaunch:
    """The launch of a replay beside a program, whose launch file is a path; '' for the replay alone.

    `playback` is the speed, and the start in seconds. The nodes of the robot are those of the machine that the argument
    `robot_machine` names: all others start. Raises UserError, as `make_request` does.
    """
    speed, start = playback
    file = str(launch_library() / REPLAY)
    own = (
        Argument("recording", str(recording.absolute())),
        Argument("playback_speed", f"{speed:g}"),
        Argument("playback_start", f"{start:g}"),
    )
    if not program:
        return ReplayLaunch(CommandLine((file,), own), ())
    given = tuple(each for each in arguments if each.name != _ROBOT_MACHINE)
    left_out = find_robot_nodes(program, given, selection, world)
    return ReplayLaunch(CommandLine((file, program), (*own, *given)), left_out)


def find_robot_nodes(path: str, arguments: Iterable[Argument], selection: Selection, world: World) -> tuple[str, ...]:
    """The full names of the nodes of a launch file that run on the robot; none where it has no robot."""
    request = make_request(CommandLine((path,), tuple(arguments)), world, selection)
    files = request.files
    if _ROBOT_MACHINE not in files.declared:
        return ()
    complete = [each for each in complete_arguments(request, local=True) if each.name != _ROBOT_MACHINE]
    computers = [describe_computer(_RECORDED, f"{_RECORDED}.local")]
    values = texts([*complete, Argument(_ROBOT_MACHINE, _RECORDED)])
    plan = load_plan(files.paths, values, world, computers=computers, parsed=files.parsed)
    return tuple(node.full_name for node in plan.nodes if node.machine == _RECORDED)
