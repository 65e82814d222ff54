"""`ur new world`: a new world, from a picture or a size."""

from __future__ import annotations

import math
import os
import re
import sys
from pathlib import Path

import click

from ur.cli.files.new_things import ask
from ur.source.diagnostic import UserError, error

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]*")
_SIZE = re.compile(r"\s*(\d+(?:\.\d+)?|\.\d+)\s*(?:[xX*]|\s)\s*(\d+(?:\.\d+)?|\.\d+)\s*")


@click.command("world")
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
    if not _NAME.fullmatch(name.removesuffix(".yaml")):
        raise _wrong(f"world name {name!r}, expected letters, digits, - and _", "the files go into this folder")
    name = name.removesuffix(".yaml")
    if not picture and not size:
        if not sys.stdin.isatty():
            help_ = f"ur new world {name} --size 8x6, or ur new world {name} --picture plan.png --width 12"
            raise UserError(error("neither --picture nor --size is given", rule="not-given", help=help_))
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
    from ur.tools.new.parts import NewFile
    from ur.tools.new.write import write_files
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
        raise UserError(
            error("--width is not given, expected the width of the picture in m", rule="not-given", help=help_)
        )
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
    return UserError(error(message, rule="bad-options", help=help))
