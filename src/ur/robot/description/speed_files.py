"""Speed limits in the parameter files around a robot description: of its controller, and of its navigation.

Descriptions seldom say how fast a robot is; the repository of the robot says it in the files of `diff_drive_controller`
and its relatives, of Nav2's velocity smoother, or of a local planner (DWA, DWB, TEB, MPPI, regulated pure pursuit).
"""

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from ur.robot.description.surroundings import Surroundings
from ur.source.foreign.files import read_file
from ur.source.foreign.yaml_text import load_yaml

_MOST_ENTRIES, _MOST_FILES, _LARGEST = 5000, 200, 256 * 1024
_DEEPEST = 12  # nested sections
_LEAST_NAME = 3  # letters that two names share by intention


@dataclass(frozen=True, slots=True)
class FoundSpeeds:
    """Limits of one file, each None where it names none: m/s, rad/s, m/s^2. `source` names what they are of.

    `navigation` are the limits of navigation, which may be slower.
    """

    source: str
    velocity: float
    angular_velocity: float | None = None
    acceleration: float | None = None
    deceleration: float | None = None
    navigation: "FoundSpeeds | None" = None


def find_speeds(around: Surroundings) -> FoundSpeeds | None:
    """Return the limits of a controller, else of navigation: of a file named like the description, the lowest."""
    found: list[tuple[int, int, float, str, FoundSpeeds]] = []
    for folder, path in _list_files(around):
        try:
            tree = load_yaml(read_file(path, _LARGEST, inside=folder).decode("utf-8"))
        except (OSError, ValueError):
            continue
        name = os.path.relpath(path, around.folder)
        like = -len(path.stem) if len(path.stem) >= _LEAST_NAME and path.stem in around.file.stem else 0
        found += [(rank, like, speeds.velocity, name, speeds) for rank, speeds in _read_tree(tree, name)]
    found.sort(key=lambda each: each[:4])
    navigation = next((each[4] for each in found if each[0]), None)
    return replace(found[0][4], navigation=navigation) if found else None


def _list_files(around: Surroundings) -> Iterator[tuple[Path, Path]]:
    """The YAML files of the repository, else of its package and those beside with the same first word, with a folder.

    None of a folder that is the user's home or above.
    """
    folders = [around.folder]
    if around.folder == around.home or around.folder in around.home.parents:
        return iter(())
    if folders == [*around.packages[:1]]:  # installed, or copied without its repository
        word = around.folder.name.partition("_")[0]
        folders += [each for each in around.packages[1:] if each.name.partition("_")[0] == word]
    entries = islice(((top, path) for top in folders for path in _walk(top)), _MOST_ENTRIES)
    files = (each for each in entries if each[1].suffix in (".yaml", ".yml") and around.find_readable(each[1]))
    return islice(files, _MOST_FILES)


def _walk(top: Path) -> Iterator[Path]:
    for folder, folders, files in os.walk(top):
        folders[:] = sorted(name for name in folders if name[0] != "." and name not in ("build", "install", "log"))
        yield from (Path(folder, name) for name in sorted(files))


def _read_tree(tree: object, name: str) -> Iterator[tuple[int, FoundSpeeds]]:
    """The limits of each section of a file, with a rank: those of a controller come first."""
    for title, section in _sections(tree, "", _DEEPEST):
        linear, angular = _axis(section, "linear", "x"), _axis(section, "angular", "z")
        if velocity := _positive(linear.get("max_velocity")):
            braking = linear.get("max_deceleration", linear.get("min_acceleration"))
            yield (
                0,
                FoundSpeeds(
                    f"{title or 'controller'} of {name}",
                    velocity,
                    _positive(angular.get("max_velocity")),
                    _positive(linear.get("max_acceleration")),
                    _positive(braking),
                ),
            )
        most = section.get("max_velocity")
        if isinstance(most, list) and len(most) == 3 and (velocity := _positive(most[0])):
            yield (
                1,
                FoundSpeeds(
                    f"{title or 'velocity_smoother'} of {name}",
                    velocity,
                    _positive(most[2]),
                    _first(section.get("max_accel")),
                    _first(section.get("max_decel")),
                ),
            )
        if velocity := next(filter(None, (_positive(section.get(key)) for key in _PLANNER_SPEEDS)), None):
            turns = (_positive(section.get(key)) for key in _PLANNER_TURNS)
            yield (
                1,
                FoundSpeeds(
                    f"{title or 'planner'} of {name}",
                    velocity,
                    next(filter(None, turns), None),
                    _positive(section.get("acc_lim_x")),
                    _positive(section.get("decel_lim_x")),
                ),
            )


_PLANNER_SPEEDS = ("max_vel_x", "max_vel_trans", "max_speed_xy", "desired_linear_vel", "vx_max")
_PLANNER_TURNS = ("max_vel_theta", "max_rot_vel", "rotate_to_heading_angular_vel", "wz_max")


def _sections(tree: object, title: str, deepest: int) -> Iterator[tuple[str, Mapping[str, object]]]:
    """A mapping and those in it, each with the name of the nearest node or plugin."""
    if not isinstance(tree, dict) or deepest == 0:
        return
    section = {key: value for key, value in tree.items() if isinstance(key, str)}
    yield title, section
    for key, value in section.items():
        yield from _sections(value, title if key in ("ros__parameters", "/**") else key.rpartition("/")[2], deepest - 1)


def _axis(section: Mapping[str, object], kind: str, axis: str) -> Mapping[str, object]:
    """The limits of an axis: nested, or with dots or slashes in their names."""
    nested = section.get(kind)
    inner = nested.get(axis) if isinstance(nested, dict) else None
    if isinstance(inner, dict):
        return inner
    starts = (f"{kind}.{axis}.", f"{kind}/{axis}/")
    return {key[len(starts[0]) :]: value for key, value in section.items() if key.startswith(starts)}


def _first(value: object) -> float | None:
    return _positive(value[0]) if isinstance(value, list) and value else None


def _positive(value: object) -> float | None:
    """The magnitude of a number, as brakes are written with either sign; None for all else."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 < abs(value) < 1000.0:
        return None
    return abs(float(value))
