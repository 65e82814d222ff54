"""A base from a description: the file with its surroundings, and the properties that a user gives."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.source.foreign.files import MAX_MANIFEST, read_file, refuse_file
from ur.source.read import read_source
from ur.source.suggest import did_you_mean, suggest
from ur.tools.new.parts import NewFile

_HEAD = """\
<launch>
  <!--Summary: Bring up the drivers of a real {name}.-->
  <!--Overview: They are part of ubiquity_launches: {what}.-->

  <!-- Optional arguments -->
  <arg name="robot_variant" default=""/>
  <!--robot_variant: The variant of the base; empty for the plain base.-->
  <arg name="robot_machine" default="localhost"/>
  <!--robot_machine: The robot: where these nodes run.-->
  <arg name="device_folder" default="/dev"/>
  <!--device_folder: The folder of the devices; another than `/dev` for the stand-ins of `simulate:=devices`.-->

"""
_INCLUDE = """\
  <include file="$(find ubiquity_launches)/{node}/launch/{node}.launch.xml">
    <arg name="robot_base" value="{name}"/>
    <arg name="robot_variant" value="$(arg robot_variant)"/>
    <arg name="package" value="$(find {package})/bases/{name}/../.."/>
    <arg name="device_folder" value="$(arg device_folder)"/>
    <arg name="machine" value="$(arg robot_machine)"/>
  </include>
"""


def check_driver(option: str, name: str | None, sensor: str) -> None:
    """Raise UserError for a name that is not a driver of a base (`sensor` '') or of that sensor."""
    known = [each for each, driver in OWN_DRIVERS.items() if driver.sensor == sensor]
    if name is None or name in known:
        return
    message = f"unknown driver '{name}' for {option}, expected one of {', '.join(known)}"
    help_ = suggest(name, known) or "leave it out, and add `driver` to base.yaml by hand"
    raise user_error(message, rule="unknown-driver", help=help_, subject=name)


def refuse_sideways(driver: str | None, aside: float | None) -> None:
    """Raise UserError for a driver with a base that drives sideways: its board drives two wheels."""
    if driver and aside:
        message = f"--driver {driver} drives two wheels, expected no --lateral-velocity"
        help_ = "leave out --driver, and name the driver of your mecanum or omni base in its base.yaml"
        raise user_error(message, rule="bad-value", help=help_)


def driver_speeds(driver: str | None) -> dict[str, float]:
    """Return the highest speeds of a base with a driver, by the names of its figures; empty where it knows none."""
    fastest = OWN_DRIVERS[driver].fastest if driver else None
    return dict(zip(("velocity", "angular_velocity"), fastest, strict=True)) if fastest else {}


def driver_lines(driver: str | None, lidar: str | None) -> str:
    """Return the lines of base.yaml that name the drivers."""
    lines = f"driver: {driver} # {OWN_DRIVERS[driver].what}, at {OWN_DRIVERS[driver].device}\n" if driver else ""
    return lines + (f"drivers: {{lidar: {lidar}}} # at {OWN_DRIVERS[lidar].device}\n" if lidar else "")


def driver_files(name: str, package: str, driver: str | None, lidar: str | None) -> list[NewFile]:
    """Return the launch file that starts the drivers of base `name` of a package; empty without a driver."""
    used = [each for each in (driver, lidar) if each]
    if not driver:
        return []
    head = _HEAD.format(name=name, what=", ".join(OWN_DRIVERS[each].what for each in used))
    parts = [_INCLUDE.format(node=OWN_DRIVERS[each].node, name=name, package=package) for each in used]
    folder = f"m_{name}_drivers"
    return [NewFile(f"{folder}/launch/{folder}.launch.xml", f"{head}{''.join(parts)}</launch>\n")]


if TYPE_CHECKING:
    from ur.robot.description.meshes import LoadedDescription
    from ur.robot.description.reading import DescriptionReading
    from ur.robot.description.surroundings import Surroundings

_EXPECTED = "a URDF or xacro file"
_MOST = 100000.0  # more is a mistake, and is written in a form that YAML reads as text
# The question, an ordinary value, and the least that a base file may have.
FIGURES: dict[str, tuple[str, float, float]] = {
    "length": ("Length in m", 0.4, 0.01),
    "width": ("Width in m", 0.35, 0.01),
    "height": ("Height in m", 0.25, 0.01),
    "mass": ("Mass in kg", 6.0, 0.01),
    "wheel_radius": ("Radius of a driven wheel in m", 0.06, 0.005),
    "wheel_separation": ("Separation of the driven wheels in m", 0.3, 0.02),
    "velocity": ("Highest speed in m/s", 0.5, 0.01),
    "angular_velocity": ("Highest turning speed in rad/s", 1.5, 0.01),
    "lateral_velocity": ("Highest speed to either side in m/s, 0 unless it has mecanum or omni wheels", 0.0, 0.0),
}


def check_source(source: Path) -> None:
    """Raise UserError for a description that does not exist, before any question."""
    if not source.exists():
        near = did_you_mean(source.name, (each.name for each in source.absolute().parent.glob("*")))
        help_ = f"did you mean '{near}'?" if near else "give the path of the robot's description"
        reason = "no such file or directory, expected a URDF or xacro file"
        raise user_error_about(source, reason, rule="unreadable-file", help=help_)


def refuse_arguments(arguments: Sequence[str]) -> None:
    """Refuse arguments for xacro if no xacro file is given. Raises UserError."""
    if arguments:
        message = f"unexpected argument '{arguments[0]}', expected --from with the xacro file that takes it"
        raise user_error(message, rule="bad-value", help="leave it out, or add --from FILE")


def look_around(source: Path) -> Surroundings:
    """Return the surroundings of a description's file. Raises UserError if it does not exist."""
    from ur.robot.description.surroundings import find_surroundings

    try:
        return find_surroundings(source, os.environ)
    except OSError as problem:
        read_source(source, expected=_EXPECTED)  # which names files beside it
        raise refuse_file(source, problem, _EXPECTED) from None


def load_file(
    source: Path, around: Surroundings, arguments: Sequence[str] = (), *, consent: Callable[[str], bool] | None = None
) -> LoadedDescription:
    """Read a description with the xacro and the packages of this computer. Raises UserError.

    `consent` is called with the command before xacro runs unconfined; without it, xacro never does.
    """
    from ur.request.environment import own_packages
    from ur.robot.description.expansion.xacro import ExpansionComputer
    from ur.robot.description.meshes import load_description

    made = Path(own_packages(os.environ))
    computer = ExpansionComputer(os.environ, lambda: list_packages(around), made, consent or (lambda _: False))
    return load_description(source, around, computer, arguments)


def list_packages(around: Surroundings) -> dict[str, str]:
    """Return the folders of packages by name: the file's own and those beside it come before this computer's."""
    from ur.launchfile.world.packages import package_name_in
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import add_own_package

    world = SystemWorld(add_own_package(os.environ))
    found = {name: world.find_package(name) for name in world.package_names()}
    for folder in reversed(around.packages):
        try:
            manifest = folder / "package.xml"
            name = package_name_in(str(manifest), read_file(manifest, MAX_MANIFEST, inside=folder))
        except (OSError, ValueError):
            continue
        if name:
            found[name] = str(folder)
    return found


def read_number(key: str, answer: str) -> float:
    """Parse the user's answer for a property. Raises UserError, which names the expected value."""
    try:
        return float(answer)
    except ValueError:
        pass
    point = f", as {answer.replace(',', '.')}" if re.fullmatch(r"\d*,\d+", answer.strip()) else " without a unit"
    message = f"'{answer}' is no number, expected one{point}: {FIGURES[key][0][0].lower()}{FIGURES[key][0][1:]}"
    raise user_error(message, rule="bad-value")


def usual_figure(key: str) -> float:
    """Return the suggested value of a property."""
    from ur.robot.description.reading import QUESTIONS

    return min(FIGURES[key][1], QUESTIONS[key][1])


def check_figure(key: str, given: float | None, *, asked: bool = False) -> float | None:
    """Return a property of a base if it is in the range of base files. Raises UserError, as `check_measured` does."""
    question, _, least = FIGURES[key]
    if given is None or least <= given <= _MOST:  # not so for NaN
        return given
    option = f"--{key.replace('_', '-')}"
    message = f"'{given:g}', expected a number from {least:g} to {_MOST:.0f}"
    if asked:
        raise user_error(message, rule="bad-value")
    raise user_error(f"invalid {option} {message}", rule="bad-value", help=f"give {option}: {question}")


def check_measured(key: str, value: float, *, asked: bool = False) -> float:
    """Return a property of a robot if it is plausible. Raises UserError; `asked`: the user answers a question."""
    from ur.robot.description.reading import QUESTIONS

    least, most = QUESTIONS[key]
    if least <= value <= most:  # not so for NaN
        return value
    option = f"--{key.replace('_', '-')}"
    message = f"'{value:g}', expected a number from {least:g} to {most:g}"
    if asked:
        raise user_error(message, rule="bad-value")
    raise user_error(f"invalid {option} {message}", rule="bad-value", help=f"give {option}: {FIGURES[key][0]}")


def check_arguments(source: Path, arguments: Sequence[str]) -> None:
    """Raise UserError for an argument of a xacro file that does not have the form NAME:=VALUE."""
    for each in arguments:
        if not re.match(r"\w+:=", each):
            message = f"unexpected argument '{each}', expected ARG:=VALUE for '{source.name}'"
            raise user_error(message, rule="bad-value", subject=each)


def missing_figures(source: Path, reading: DescriptionReading, lidar: bool | None) -> UserError:
    """Return the error that names all properties that a description does not define, with their options."""
    asks = lidar is None and not reading.has_lidar
    names = ", ".join([*(key.replace("_", " ") for key in reading.open), *(["a lidar"] if asks else [])])
    options = " ".join(f"--{key.replace('_', '-')} {usual_figure(key):g}" for key in reading.open)
    options += " --lidar (or --no-lidar)" if asks else ""
    message = f"cannot read from '{source}': {names}"
    return user_error(message, rule="not-given", help=f"add, with your robot's figures: {options}")


def describe_left_out(loaded: LoadedDescription, around: Surroundings) -> list[str]:
    """Return notes on files of a description that were not read."""
    notes = []
    if loaded.missing:
        names = " ".join(loaded.missing)
        notes.append(f"note: left out, since their packages are not here: files of {names} (ur get {names})")
    if loaded.outside:
        names = ", ".join(loaded.outside[:5]) + (" ..." if len(loaded.outside) > 5 else "")
        notes.append(f"note: meshes outside of '{around.folder}' and of packages are not read: {names}")
    return notes


def describe_reading(reading: DescriptionReading) -> str:
    """Describe the content of a description: a line for each property, sensor and note."""
    rows = [
        f"read: {key.replace('_', ' ')} {figure.value:.4g} ({figure.source})"
        for key, figure in reading.figures.items()
        if key not in reading.open and figure.source not in ("given", "usual")
    ]
    rows += [
        f"read: caster at x {each.x:.4g}, y {each.y:.4g} ({each.source})"
        for each in reading.supports
        if each.source.startswith("link ")
    ]
    rows += [f"read: {sensor.kind} {sensor.frame} ({sensor.source})" for sensor in reading.sensors]
    rows += [f"note: {note}" for note in reading.notes]
    return "".join(f"{row}\n" for row in rows)
