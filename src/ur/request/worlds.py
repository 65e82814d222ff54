"""Worlds and maps of a command line, checked before anything starts."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.maps.names import check_map_name
from ur.source.arguments import Argument, values_of
from ur.source.diagnostic import UserError, user_error
from ur.source.project import LIBRARY, launch_library
from ur.worlds.choice import (
    PATHS,
    WORLD,
    explain_missing_map,
    explain_missing_world,
    is_path,
    list_worlds,
    resolve_path,
)


def resolve_worlds(
    arguments: Sequence[Argument], files: Sequence[str], declared: Sequence[str], robot: str = ""
) -> tuple[Argument, ...]:
    """Complete the arguments that choose worlds and maps: absolute paths, and the start poses of the world.

    Launch files of the launch library resolve every relative path from the working folder; others only paths of
    existing files. `robot` is the other computer that reads the map, '' if that is this one. Raises UserError for an
    argument without a value, and for a path of this computer that the other one is to read.
    """
    if not any(each.name in PATHS for each in arguments):
        return tuple(arguments)
    for each in arguments:
        name, value = each.name, each.value
        if name in PATHS and name in declared and not value:
            expected = f"one of {', '.join(list_worlds(launch_library()))}, or " if name == WORLD else ""
            message = f"{name}:= has no value, expected {expected}the path of a YAML file"
            raise user_error(message, rule="bad-argument", help=f"write {name}:=VALUE without a blank")
        if name == "map_file" and robot and value and not value.startswith("/"):
            message = f"{each} is read on {robot}, expected the absolute path of a file there"
            help_ = f"copy the map to {robot}, for example with 'ur sync {robot}', and give its path there"
            raise user_error(message, rule="bad-argument", help=help_)
    own = all(Path(path).is_relative_to(launch_library()) for path in files)
    folder = Path.cwd()
    resolved = [Argument(each.name, resolve_path(each.name, each.value, folder, always=own)) for each in arguments]
    return (*resolved, *_start_arguments(values_of(resolved), declared))


def _start_arguments(given: Mapping[str, str], declared: Sequence[str]) -> list[Argument]:
    path = given.get("world_file") or given.get(WORLD, "")
    names = ("x", "y", "yaw")
    if not is_path(path) or any(name in given or name not in declared for name in names):
        return []
    from ur.worlds.world_file import read_world

    try:
        start = read_world(path).start
    except UserError:  # the simulator of the plan decides whether this is a world at all
        return []
    return [Argument(name, repr(value)) for name, value in zip(names, start, strict=True)] if any(start) else []


def check_worlds(plan: Plan) -> None:
    """Read the worlds and maps of the launch library's nodes on this computer.

    Raises UserError if one does not exist or is invalid, a new map has a bad name, or the robot would start in a wall.
    """
    parameters = {each.name: each.value for each in plan.params}
    by_fiducials = any(node.package == LIBRARY and node.type == "fiducial_slam" for node in plan.nodes)
    for node in plan.nodes:
        name = parameters.get(f"{node.full_name}/map_name")
        if node.package == LIBRARY and node.type == "slam_gmapping" and name:
            check_map_name(str(name))
        if node.package != LIBRARY or not plan.is_local(node):
            continue
        if node.type == "simulator":
            path = parameters.get(f"{node.full_name}/world_file")
            start = [parameters.get(f"{node.full_name}/{name}", 0.0) for name in ("x", "y")]
            if isinstance(path, str) and path:
                _check_world(path, [each if isinstance(each, (int, float)) else 0.0 for each in start])
                if by_fiducials:
                    _check_fiducials(path)
        elif node.type == "map_server":
            _check_map(node)


def _check_world(path: str, start: Sequence[float]) -> None:
    if not Path(path).is_file():
        raise explain_missing_world(path, launch_library())
    if Path(path).is_relative_to(launch_library()):
        return  # those of the launch library are read by its tests
    from ur.worlds.world_file import read_world

    plan = read_world(path).floor_plan
    x, y = start
    wall = plan.wall_at(x, y)
    if wall is not False:
        place = "in a wall of" if wall else "outside"
        raise user_error(
            f"the robot starts at x = {x:g} m, y = {y:g} m, {place} world {Path(path).name!r}; expected free floor",
            rule="bad-start",
            help="choose another place with x:=METRES y:=METRES, or change 'origin' in the file",
        )


def _check_fiducials(path: str) -> None:
    from ur.worlds.world_file import read_world

    if not read_world(path).fiducials:
        name = Path(path).name.removesuffix(".yaml")
        message = f"world {name!r} has no fiducials, expected some for a robot that finds its place by them"
        help_ = "choose a base with a lidar, for example robot_base:=magni robot_variant:=lidar, or add 'fiducials:'"
        raise user_error(message, rule="no-fiducials", help=help_)


def _check_map(node: NodeSpec) -> None:
    named = dict(node.env).get("UR_MAP_FILE", "")
    path = Path(named)
    if not named or path.is_relative_to(launch_library()):
        return
    if not path.is_file():
        raise explain_missing_map(named)
    from ur.worlds.map_file import read_map

    read_map(path)
