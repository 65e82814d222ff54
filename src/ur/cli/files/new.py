"""`ur new`: launch directories, programs, bases and packages that follow the conventions of `ur check`."""

import math
import os
import re
import sys
from pathlib import Path

import click

from ur.cli.files.new_things import (
    SUMMARY,
    ask,
    base_request,
    check_like,
    find_parts,
    in_package,
    know_person,
    node_request,
    show_done,
    urdf_files,
)
from ur.source.diagnostic import UserError, user_error
from ur.tools.new.package import plan_package, plan_script, write_base
from ur.tools.new.parts import NewFile, write_files

_NAME = r"[a-z][a-z0-9_]*"


def _check_name(_context: click.Context, _parameter: click.Parameter, value: str | None) -> str | None:
    import re

    if value is not None and not re.fullmatch(_NAME, value):
        raise click.BadParameter(f"{value!r}, expected lower-case letters, digits and _, starting with a letter")
    return value


_name = click.argument("name", required=False, callback=_check_name)


@click.group("new", invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> int:
    """Write a node, group, script, base, package or world.

    Asks for what is not given; without a terminal, everything has to be given. It never overwrites a file. The new
    files pass `ur check` and appear in `ur docs`.
    """
    if context.invoked_subcommand is None:
        click.echo(_list_kinds(), err=True, nl=False)
        return 2
    return 0


def _list_kinds() -> str:
    """List the kinds of new files: the first example of each, as on the help pages."""
    from ur.cli.verbs import VERBS

    lines = ["error: 'ur new' needs to know what to write, expected one of:"]
    for name, kind in command.commands.items():
        lines += [f"  {name}: {kind.get_short_help_str(limit=200)}", f"    {VERBS['new'].below[name].examples[0][0]}"]
    return "\n".join([*lines, "  help: 'ur help new node' describes the options of one", ""])


@command.command("node")
@_name
@SUMMARY
@in_package
@click.option("--from-package", "source", metavar="PKG", help="The package that holds the node's executable.")
@click.option("--type", "kind", metavar="NODE", help="The name of the executable.")
@click.option("--look/--no-look", default=True, help="Start the node and observe its topics, services and parameters.")
@click.option("--seconds", default=20.0, show_default=True, help="The longest time to observe the node, in s.")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[-- ARGUMENTS OF THE NODE]")
def new_node(
    name: str | None, summary: str | None, package: str | None, source: str | None, kind: str | None, look: bool,
    seconds: float, arguments: tuple[str, ...],
) -> int:  # fmt: skip
    """Write a launch directory n_NAME for a node.

    The node is started with a master of its own, and the topics, services and parameters that it uses become arguments,
    remaps and a parameter file.
    """
    from ur.tools.new.node import plan_node

    target = show_done.target(package)
    source = ask(source, "--from-package", "Package of the node")
    kind = ask(kind, "--type", f"Executable in {source}")
    name = ask(name, "NAME", "Name of the directory, without n_", kind.partition(".")[0])
    summary = ask(summary, "--summary", "What it does, in one line")
    request = node_request(name, source, kind, summary, seconds if look else None, arguments)
    return show_done(target, plan_node(request, target.name), f"ur launch {target.name} n_{name}.launch.xml")


@command.command("multi")
@_name
@SUMMARY
@in_package
@click.option("--include", "includes", multiple=True, metavar="[PKG/]NAME", help="n_NAME or m_NAME; may be repeated.")
@click.option("--program/--no-program", default=True, help="With a program that starts it, bin/ur_NAME.")
def new_multi(
    name: str | None, summary: str | None, package: str | None, includes: tuple[str, ...], program: bool
) -> int:
    """Write a launch file m_NAME that includes others, and a program that starts it."""
    from ur.tools.new.group import plan_multi, plan_program

    target = show_done.target(package)
    name = ask(name, "NAME", "Name of the directory, without m_")
    summary = ask(summary, "--summary", "What it starts, in one line")
    names = includes or tuple(ask(None, "--include", "What it includes, for example n_joy m_robot_base").split())
    files = plan_multi(name, summary, find_parts(names, target))
    if program:
        files += plan_program(name, summary, target.name, f"m_{name}.launch.xml")
    return show_done(target, files, f"ur launch {target.name} m_{name}.launch.xml")


@command.command("base")
@_name
@SUMMARY
@in_package
@click.option("--length", type=float, help="From front to back, in m.")
@click.option("--width", type=float, help="From left to right, in m.")
@click.option("--height", type=float, help="In m.")
@click.option("--mass", type=float, help="In kg.")
@click.option("--wheel-radius", type=float, help="In m.")
@click.option("--wheel-separation", type=float, help="Between the middles of the two driven wheels, in m.")
@click.option("--velocity", type=float, help="The highest, in m/s.")
@click.option("--angular-velocity", type=float, help="The highest, in rad/s.")
@click.option("--lateral-velocity", type=float, help="The highest to either side, in m/s: for mecanum or omni wheels.")
@click.option("--lidar/--no-lidar", default=None, help="It has a lidar. [default: as FILE says]")
@click.option("--raspicam", is_flag=True, help="It has a Raspberry Pi camera.")
@click.option("--driver", metavar="DRIVER", help="The driver of the real base, for example create2: see drivers.md.")
@click.option("--lidar-driver", metavar="DRIVER", help="The driver of its lidar, for example rplidar; needs --driver.")
@click.option("--like", metavar="BASE", help="Copy the parameter files of this base; without it of stage, if there.")
@click.option("--from", "source", metavar="FILE", help="Read the figures from this URDF or xacro file.")
@click.option(
    "--workspace", metavar="FOLDER", help="Write it into a folder of its own, which extends ubiquity_launches."
)
@click.argument("arguments", nargs=-1, metavar="[ARG:=VALUE]...")
def new_base(
    name: str | None, summary: str | None, package: str | None, lidar: bool | None, raspicam: bool, like: str | None,
    source: str | None, workspace: str | None, driver: str | None, lidar_driver: str | None,
    arguments: tuple[str, ...], **figures: float | None,
) -> int:  # fmt: skip
    """Write a base: bases/NAME/base.yaml, its URDF, and the parameter files that other bases have.

    With --from its figures, wheels and sensors are read from a URDF or xacro file, and only the rest is asked for.
    ARG:=VALUE are arguments of the xacro file.
    """
    from ur.cli.files.new_things import describe_base
    from ur.tools.new.description import (
        check_driver,
        check_source,
        driver_files,
        driver_lines,
        driver_speeds,
        refuse_arguments,
        refuse_sideways,
    )
    from ur.tools.new.target import next_step, target_of

    check_driver("--driver", driver, "")
    check_driver("--lidar-driver", lidar_driver, "lidar")
    refuse_sideways(driver, figures["lateral_velocity"])
    figures = {**driver_speeds(driver), **{key: given for key, given in figures.items() if given is not None}}
    if source is not None:
        check_source(Path(source))
    place = target_of(package, workspace)
    like = check_like(place.library, place.target.name, like)
    name = ask(name, "NAME", "Name of the base")
    if source is not None:
        text, cruise = describe_base(Path(source), summary, figures, arguments, lidar=lidar, raspicam=raspicam)
    else:
        refuse_arguments(arguments)
        summary = ask(summary, "--summary", "What it is, in one line")
        text, cruise = write_base(base_request(name, summary, figures, lidar=bool(lidar), raspicam=raspicam)), None
    text += driver_lines(driver, lidar_driver)
    drivers = driver_files(name, place.target.name, driver, lidar_driver)
    beside = urdf_files(place.target, name, text, like, place.library, place.url, cruise)
    files = place.place_files([NewFile(f"bases/{name}/base.yaml", text), *beside, *drivers])
    return show_done(place.target, files, next_step(place, name))


@command.command("package")
@_name
@SUMMARY
@click.option("--maintainer", help="The name of the maintainer.")
@click.option("--email", help="The e-mail address of the maintainer.")
def new_package(name: str | None, summary: str | None, maintainer: str | None, email: str | None) -> int:
    """Write a package for launch files: a folder NAME here."""
    name = ask(name, "NAME", "Name of the package")
    summary = ask(summary, "--summary", "What it is for, in one line")
    known = know_person()
    maintainer = ask(maintainer, "--maintainer", "Who looks after it", known[0])
    email = ask(email, "--email", "Their address", known[1])
    target = show_done.folder(name)
    return show_done(target, plan_package(name, summary, maintainer, email), f"cd {name} && ur new node")


_SCRIPT = re.compile(r"[a-z][a-z0-9_]*")


@command.command("script")
@click.argument("name")
@click.option("--summary", default="Drive half a metre ahead", help="One line that says what it does.")
def new_script(name: str, summary: str) -> int:
    """Write a script NAME.py into this folder, which drives the selected robot half a metre ahead."""
    name = name.removesuffix(".py")
    if not _SCRIPT.fullmatch(name):
        expected = "expected lower-case letters, digits and _, starting with a letter"
        raise user_error(f"script name {name!r}, {expected}", rule="bad-options", help="ur new script look_around")
    (file,) = plan_script(name, summary)
    write_files(Path.cwd(), [file])
    click.echo(f"wrote {file.path}")
    click.echo(f"next: ur run keyboard_navigate, then in another terminal: ur run {file.path}", err=True)
    return 0


_WORLD = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
_SIZE = re.compile(r"\s*(\d+(?:\.\d+)?|\.\d+)\s*(?:[xX*]|\s)\s*(\d+(?:\.\d+)?|\.\d+)\s*")


@command.command("world")
@click.argument("name", required=False)
@click.option("--picture", metavar="FILE", help="The floor plan: dark is wall, light is floor.")
@click.option("--width", type=float, metavar="METRES", help="How wide the picture is in m.")
@click.option("--size", metavar="WIDTHxHEIGHT", help="An empty room of this size in m, in place of a picture: 8x6.")
@click.option("--cell", type=float, default=0.05, show_default=True, metavar="METRES", help="The edge of a cell in m.")
def new_world(name: str | None, picture: str | None, width: float | None, size: str | None, cell: float) -> int:
    """Write a world NAME.yaml for the simulator, which is a map as well, and its picture NAME.png, into this folder.

    Robots start at (0, 0), which is free floor near the middle of the picture.
    """
    if picture and size:
        raise _wrong("--picture and --size cannot be used together")
    if width is not None and size:
        raise _wrong("--width belongs to --picture, expected --size alone")
    name = ask(name, "NAME", "Name of the world")
    if not _WORLD.fullmatch(name.removesuffix(".yaml")):
        raise _wrong(f"world name {name!r}, expected letters, digits, - and _", "the files go into this folder")
    name = name.removesuffix(".yaml")
    if not picture and not size:
        if not sys.stdin.isatty():
            help_ = f"ur new world {name} --size 8x6, or ur new world {name} --picture plan.png --width 12"
            raise user_error("neither --picture nor --size is given", rule="not-given", help=help_)
        picture = click.prompt("Picture of the floor plan (empty for an empty room)", default="", show_default=False)
        if not picture:
            size = click.prompt("Size of the room in m", default="8x6")
    _check_length("--cell", cell, 0.005, 1.0)

    from ur.worlds.drawing import draw_picture, draw_room

    if picture:
        path = Path(picture).expanduser()
        if not path.is_file():
            draw_picture(path, 1.0)  # fails before further questions
        metres = width if width is not None else _ask_width(name, picture)
        _check_length("--width", metres, 0.5, 1000.0)
        drawing = draw_picture(path, metres, cell)
        title = f"World {name}, made from {' '.join(path.name.split())}."
    else:
        lengths = _read_size(size or "")
        drawing = draw_room(*lengths, cell)
        title = f"World {name}: a room of {lengths[0]:g} x {lengths[1]:g} m."
    return _write(name, drawing, title)


def _write(name: str, drawing: object, title: str) -> int:
    from ur.worlds.drawing import Drawing, write_png, write_world

    assert isinstance(drawing, Drawing)
    files = (
        NewFile(f"{name}.yaml", write_world(drawing, f"{name}.png", title)),
        NewFile(f"{name}.png", write_png(drawing.levels)),
    )
    write_files(Path.cwd(), files)
    for file in files[::-1]:
        click.echo(f"wrote {file.path}")
    x, y = drawing.origin
    width, height = drawing.size
    click.echo(f"{width:g} x {height:g} m: x from {x:g} to {x + width:g}, y from {y:g} to {y + height:g}", err=True)
    if drawing.added_wall:
        click.echo("note: the floor reached the edge of the picture: a wall was drawn around it", err=True)
    click.echo(f"next: ur run keyboard_navigate world:=.{os.sep}{name}.yaml", err=True)
    return 0


def _ask_width(name: str, picture: str) -> float:
    if not sys.stdin.isatty():
        help_ = f"ur new world {name} --picture {picture} --width 12"
        raise user_error("--width is not given, expected the width of the picture in m", rule="not-given", help=help_)
    answer: float = click.prompt("How wide is the picture, in m", type=float)
    return answer


def _read_size(text: str) -> tuple[float, float]:
    found = _SIZE.fullmatch(text)
    if found is None:
        raise _wrong(f"--size {text!r}, expected WIDTHxHEIGHT in m", "for example --size 8x6")
    lengths = float(found.group(1)), float(found.group(2))
    for length in lengths:
        _check_length("--size", length, 1.0, 1000.0)
    return lengths


def _check_length(option: str, value: float, least: float, most: float) -> None:
    if not (math.isfinite(value) and least <= value <= most):
        raise _wrong(f"{option} {value:g}, expected {least:g} to {most:g} m")


def _wrong(message: str, help: str | None = None) -> UserError:
    return user_error(message, rule="bad-options", help=help)
