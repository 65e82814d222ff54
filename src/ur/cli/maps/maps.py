"""`ur maps`: list, show, rename, delete and exchange the maps that robots have made."""

from __future__ import annotations

import json
import math
import os
import shutil
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from ur.maps.names import read_places, waypoint_path
from ur.maps.record import EditKind, MapRecord
from ur.maps.store import MapStore, own_store
from ur.source.ansi import BOLD, RESET, speaks_unicode, strip_styles
from ur.source.diagnostic import UserError, user_error
from ur.source.printable import printable
from ur.source.render import shows_colour

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_HELP = "ur maps edit NAME rotate|origin|erase|wall|keep-out|zone|place NUMBERS"


@click.command("edit", context_settings={"ignore_unknown_options": True})
@click.argument("name")
@click.argument("change")
@click.argument("values", nargs=-1, metavar="[VALUE ...]")
def edit(name: str, change: str, values: tuple[str, ...]) -> int:
    """Edit a map: rotate it, erase people and other moved obstacles, draw walls and zones, name places.

    Numbers are metres in the frame of the map, and degrees. `rotate` rotates the map about (0, 0), without a number so
    that its walls are parallel to the axes; `origin X Y` moves the origin (0, 0) to a point. `erase` takes two corners
    of a rectangle, or the corners of a polygon; `wall` takes the points of a line. `place PLACE X Y [ANGLE]` names a
    place for keyboard_navigate. These edits stay on top of what make_map adds later.

    `keep-out` makes a zone that navigation avoids and that localisation ignores; its corners are given as for `erase`.
    `zone ZONE keep-out X Y ...` gives it a name, `zone ZONE PERCENT X Y ...` limits the speed in it to a share of the
    highest, `zone ZONE delete` deletes it. Zones apply at once, also to a robot that is navigating.
    """
    store = own_store(os.environ)
    name = store.resolve(name)
    action = _CHANGES.get(change)
    if action is None:
        raise _bad(f"unknown change {change!r}, expected one of {', '.join(_CHANGES)}")
    try:
        click.echo(f"{name}: {action(store, name, values)}")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise _bad(f"'{problem.filename or store.folder}' cannot be written: {reason}") from None
    return 0


def _rotate(store: MapStore, name: str, values: Sequence[str]) -> str:
    from ur.maps.change import move_map, propose

    numbers = _numbers(values, "rotate [DEGREES]", (0, 1))
    turn = math.radians(numbers[0]) if numbers else propose(store, name)
    if not turn:
        return "its walls lie along the axes; nothing to do"
    move_map(store, name, (0.0, 0.0, turn), waypoint_path(name, os.environ))
    return f"turned by {math.degrees(turn):.1f} degrees"


def _origin(store: MapStore, name: str, values: Sequence[str]) -> str:
    from ur.maps.change import move_map

    x, y = _numbers(values, "origin X Y", (2,))
    move_map(store, name, (-x, -y, 0.0), waypoint_path(name, os.environ))
    return f"({x:g}, {y:g}) is (0, 0) now"


def _draw(kind: EditKind) -> Callable[[MapStore, str, Sequence[str]], str]:
    def draw(store: MapStore, name: str, values: Sequence[str]) -> str:
        from ur.maps.change import add_edit, make_edit

        numbers = _numbers(values, f"{kind} X Y X Y ...", range(4, 2001, 2))
        count = add_edit(store, name, make_edit(kind, list(zip(numbers[::2], numbers[1::2], strict=True))))
        return f"{kind}: {count} cells changed"

    return draw


def _keep_out(store: MapStore, name: str, values: Sequence[str]) -> str:
    from ur.maps.zones import fresh_zone_name

    _numbers(values, "keep-out X Y X Y ...", range(4, 2001, 2))
    return _zone(store, name, (fresh_zone_name("keep-out", store.record(name).zones), "keep-out", *values))


def _zone(store: MapStore, name: str, values: Sequence[str]) -> str:
    from ur.maps.zones import delete_zone, describe_zone, make_zone, put_zone
    from ur.worlds.map_file import read_map

    form = "zone ZONE keep-out|PERCENT X Y X Y ..., or zone ZONE delete"
    if len(values) < 2:
        raise _bad(f"{len(values)} values, expected {form}")
    title, rule, *rest = values
    plan = read_map(store.picture(name))
    if rule == "delete":
        _numbers(rest, "zone ZONE delete", (0,))
        delete_zone(store, name, title, plan)
        return f"zone {title} is deleted"
    numbers = _numbers(rest, form, range(4, 2001, 2))
    points = list(zip(numbers[::2], numbers[1::2], strict=True))
    if rule == "keep-out":
        zone = make_zone(title, "keep-out", points)
    elif rule.isascii() and rule.isdigit() and len(rule) < 4:
        zone = make_zone(title, "speed", points, int(rule))
    else:
        raise _bad(f"{rule!r}, expected {form}")
    put_zone(store, name, zone, plan)
    return describe_zone(zone)


def _place(store: MapStore, name: str, values: Sequence[str]) -> str:
    from ur.maps.change import name_place

    if not values:
        raise _bad("no name, expected place PLACE X Y [ANGLE]")
    numbers = _numbers(values[1:], "place PLACE X Y [ANGLE]", (2, 3))
    x, y, degrees = (*numbers, 0.0)[:3]
    name_place(store, name, waypoint_path(name, os.environ), values[0], (x, y, degrees))
    return f"{values[0]} is at {x:g} {y:g} {degrees:g}"


_CHANGES: dict[str, Callable[[MapStore, str, Sequence[str]], str]] = {
    "rotate": _rotate,
    "origin": _origin,
    "erase": _draw("erase"),
    "wall": _draw("wall"),
    "keep-out": _keep_out,
    "zone": _zone,
    "place": _place,
}


def _numbers(values: Sequence[str], form: str, counts: Sequence[int]) -> list[float]:
    try:
        numbers = [float(each) for each in values]
    except ValueError as problem:
        raise _bad(f"{str(problem).rpartition(': ')[2]} is not a number, expected {form}") from None
    if len(numbers) not in counts:
        raise _bad(f"{len(numbers)} numbers, expected {form}")
    if not all(math.isfinite(each) for each in numbers):
        raise _bad(f"a number is not finite, expected {form}")
    return numbers


def _bad(message: str) -> UserError:
    return user_error(message, rule="bad-edit", help=_HELP)


Result = TypeVar("Result")
_NAME = click.argument("name")


@click.group("maps", invoke_without_command=True)
@click.option("--json", "as_json", is_flag=True, help="As JSON, for a script.")
@click.option("--pictures", is_flag=True, help="With --json: a small picture of each, as lines of ' ', '.' and '#'.")
@click.option("--robot", help="The maps on a robot, by name only.")
@click.pass_context
def command(context: click.Context, as_json: bool, pictures: bool, robot: str | None) -> None:
    """List, show, edit and exchange the maps that robots have made.

    They are in ~/.local/share/ubiquity_launches/maps of the computer where the mapping ran.
    """
    if context.invoked_subcommand is not None:
        return
    if robot:
        from ur.cli.maps.copying import list_remote

        click.echo("".join(f"{name}\n" for name in list_remote(robot)), nl=False)
        return
    store = _store()
    if as_json:
        rows = [list_facts(store, name, os.environ, picture=pictures) for name in store.names()]
        click.echo(json.dumps(rows, indent=1))
        return
    names = store.names()
    if not names:
        click.echo("no maps yet; make one: ur run make_map")
    elif sys.stdout.isatty():
        click.echo("\n".join(list_maps(store, shutil.get_terminal_size().columns, colour=shows_colour(sys.stdout))))
    else:
        click.echo("\n".join(f"{name}: {describe_map(store, name)}" for name in names))


@command.command("show")
@_NAME
def show(name: str) -> int:
    """Draw a map in the terminal, with its facts."""
    from ur.worlds.map_file import read_map

    store = _store()
    name = store.resolve(name)
    size = shutil.get_terminal_size()
    image = read_map(store.picture(name))
    drawn = shows_colour(sys.stdout) and speaks_unicode(sys.stdout.encoding, os.environ)
    lines = draw_lines(image.values, size.columns - 1, max(size.lines - 4, 10), colour=drawn)
    left, bottom, right, top = image.bounds
    extent = f"x from {left:.1f} to {right:.1f} m, y from {bottom:.1f} to {top:.1f} m"
    click.echo("\n".join([*lines, f"{name}: {describe_map(store, name)}", extent]))
    return 0


@command.command("rename")
@_NAME
@click.argument("new_name")
def rename(name: str, new_name: str) -> int:
    """Rename a map, together with its waypoints."""
    store = _store()
    _guard(lambda: store.rename(name, new_name))
    before, after = (waypoint_path(each, os.environ) for each in (name, new_name))
    if before.is_file() and not after.exists():
        before.rename(after)
    click.echo(f"{name} is now {new_name}")
    return 0


@command.command("delete")
@click.argument("names", nargs=-1, required=True, metavar="NAME ...")
@click.option("--yes", is_flag=True, help="Do not ask.")
def delete(names: tuple[str, ...], yes: bool) -> int:
    """Delete maps permanently, with their scans, after a question."""
    store = _store()
    for name in names:
        store.resolve(name)
        store.path(name)
    if not yes:
        if not sys.stdin.isatty():
            message = "there is no terminal to ask on, so nothing was deleted"
            raise user_error(message, rule="not-confirmed", help="--yes deletes without asking")
        for name in names:
            click.echo(f"{name}: {describe_map(store, name)}")
        if not click.confirm(f"delete {' and '.join(names)}?", default=False):
            click.echo("nothing was deleted")
            return 1
    for name in names:
        _guard(lambda name=name: store.delete(name))  # type: ignore[misc]
        click.echo(f"{name}: deleted")
    return 0


@command.command("export")
@_NAME
@click.argument("file", type=click.Path(path_type=Path))
def export(name: str, file: Path) -> int:
    """Write the picture of a map for other programs, as map_server reads it: FILE.yaml and FILE.png, or FILE.pgm.

    Maps in files of these names are replaced.
    """
    from ur.maps.exchange import export_picture

    written = _guard(lambda: export_picture(_store(), name, file))
    click.echo("\n".join(f"wrote {path}" for path in written))
    return 0


@command.command("import")
@click.argument("file", type=click.Path(path_type=Path))
@click.argument("name", required=False)
def import_(file: Path, name: str | None) -> int:
    """Import a map: a YAML file of map_server, or the folder of another user's map.

    A map without scans can be navigated on and edited, but not continued.
    """
    from ur.maps.exchange import import_picture, treats_grey_as_free
    from ur.maps.names import check_map_name

    store = _store()
    name = check_map_name(name or (file.name if file.is_dir() else file.stem))
    image = _guard(lambda: import_picture(store, file.expanduser(), name))
    click.echo(f"{name}: {describe_map(store, name)}")
    if treats_grey_as_free(image):
        click.echo(
            f"note: free_thresh: {image.file.free_thresh:g} makes the grey of unknown floor (205) free; "
            "to keep it unknown, write free_thresh: 0.196 in the file and import it again"
        )
    return 0


@command.command("copy")
@_NAME
@click.option("--to", "target", metavar="ROBOT", help="Copy the map from here to this robot.")
@click.option("--from", "source", metavar="ROBOT", help="Copy the map from this robot to here.")
@click.option("--as", "new_name", metavar="NAME", help="Its name there. [default: the same]")
def copy(name: str, target: str | None, source: str | None, new_name: str | None) -> int:
    """Copy a map to or from a robot; an existing map is not replaced."""
    from ur.cli.maps.copying import fetch_map, send_map

    if (target is None) == (source is None):
        raise click.UsageError("expected one of --to ROBOT and --from ROBOT")
    if target is not None:
        place = send_map(_store(), name, target, new_name or name)
    else:
        assert source is not None
        place = fetch_map(_store(), name, source, new_name or name)
    click.echo(f"{new_name or name}: copied {'to' if target else 'from'} {place}")
    return 0


@command.command("merge")
@click.argument("first")
@click.argument("second")
@click.option("--as", "new_name", metavar="NAME", required=True, help="The name of the new map.")
def merge(first: str, second: str, new_name: str) -> int:
    """Merge two overlapping maps into a new one; both stay unchanged.

    The new map has the frame of FIRST. Where the two differ, SECOND is taken as the newer one. The new map has the
    edits and waypoints of both.
    """
    from ur.cli.maps.merging import MergeFailed, merge_maps

    try:
        click.echo(_guard(lambda: merge_maps(_store(), first, second, new_name)))
    except MergeFailed as problem:
        return int(problem.args[0])
    return 0


def _store() -> MapStore:
    return own_store(os.environ)


def _guard(action: Callable[[], Result]) -> Result:
    """Run an action on files. Raises UserError if they cannot be used."""
    try:
        return action()
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"'{problem.filename or _store().folder}' cannot be used: {reason}"
        raise user_error(message, rule="unusable-file", help="is the disk full, or the folder read-only?") from None


command.add_command(edit)


_PICTURE = (30, 6)  # columns and lines of the picture of a map in a list
_SCRIPT_PICTURE = (64, 32)  # the same for a script
_WALLS_FROM = 50
_UNKNOWN, _FREE, _WALL = 0, 1, 2
_COLOURS = ((28, 28, 28), (78, 78, 78), (208, 208, 208))
_NARROW = 70  # columns: without pictures


def describe_map(store: MapStore, name: str) -> str:
    """Describe a map: its size, time of change, the robot that made it, and its uses."""
    from ur.worlds.map_file import read_map

    try:
        image, record = read_map(store.picture(name)), store.record(name)
    except UserError as problem:
        return f"damaged: {problem.diagnostics[0].message}"
    parts = [f"{image.width * image.resolution:.1f} x {image.height * image.resolution:.1f} m"]
    if record.changed:
        parts.append(time.strftime("%Y-%m-%d %H:%M", time.localtime(record.changed)))
    if record.robot:
        parts.append(printable(record.robot))
    parts.append(f"{record.keyframes} scans" if record.graph else "picture only")
    if store.latest() == name:
        parts.append("the last one of this robot")
    return ", ".join(parts)


def list_maps(store: MapStore, columns: int, *, colour: bool) -> list[str]:
    """Return lines for a terminal: the picture of each map, and its properties beside it."""
    from ur.worlds.map_file import read_map

    lines: list[str] = []
    for name in store.names():
        text = [f"{BOLD}{name}{RESET}" if colour else name, *describe_map(store, name).split(", ")]
        try:
            picture = draw_lines(read_map(store.picture(name)).values, *_PICTURE, colour=colour)
        except UserError:
            picture = []
        if columns < _NARROW:
            picture = []
        width = _PICTURE[0] + 2 if columns >= _NARROW else 0
        for row in range(max(len(picture), len(text))):
            left = picture[row] if row < len(picture) else ""
            right = text[row] if row < len(text) else ""
            lines.append((left + " " * (width - len(strip_styles(left))) + right).rstrip())
        lines.append("")
    return lines[:-1]


def list_facts(store: MapStore, name: str, environment: Mapping[str, str], *, picture: bool) -> dict[str, object]:
    """Return the properties of a map for a script.

    `width` and `height` are in m, `places` is the number of places, and `problem` is set if the map is damaged.
    `picture` is a list of lines from `draw_lines` without colours.
    """
    from ur.worlds.map_file import read_map

    record, image, places, problem = MapRecord(), None, 0, ""
    try:
        record, image = store.record(name), read_map(store.picture(name))
        places = len(read_places(waypoint_path(name, environment)))
    except UserError as found:
        problem = printable(found.diagnostics[0].message)
    facts: dict[str, object] = {
        "name": name,
        "robot": record.robot,
        "made": record.made,
        "changed": record.changed,
        "keyframes": record.keyframes,
        "width": None if image is None else round(image.width * image.resolution, 2),
        "height": None if image is None else round(image.height * image.resolution, 2),
        "places": places,
        "file": str(store.picture(name)),
        "latest": store.latest() == name,
        "problem": problem,
    }
    if picture:
        facts["picture"] = [] if image is None else draw_lines(image.values, *_SCRIPT_PICTURE, colour=False)
    return facts


def draw_lines(values: NDArray[np.int8], columns: int, rows: int, *, colour: bool) -> list[str]:
    """Draw cells (height, width), row 0 at the bottom, as at most `rows` lines of at most `columns` characters.

    The unknown margin of the map is cut off. A pixel with any wall in it shows a wall.
    """
    import numpy as np

    from ur.tui.screen.half_blocks import draw_half_blocks
    from ur.worlds.cells import OCCUPIED

    seen = values >= 0
    if not seen.any() or columns < 1 or rows < 1:
        return []
    height_at, width_at = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    part = values[height_at[0] : height_at[-1] + 1, width_at[0] : width_at[-1] + 1][::-1]
    height, width = part.shape
    side = max(1, math.ceil(max(width / columns, height / (2 * rows))))
    high, wide = math.ceil(height / side), math.ceil(width / side)
    padded = np.full((2 * math.ceil(high / 2) * side, wide * side), -1, np.int8)
    padded[:height, :width] = part
    blocks = padded.reshape(-1, side, wide, side)
    walls = ((blocks >= _WALLS_FROM) & (blocks <= OCCUPIED)).any(axis=(1, 3))
    free = (blocks >= 0).mean(axis=(1, 3)) >= 0.5
    pixels = np.where(walls, _WALL, np.where(free, _FREE, _UNKNOWN))
    lines = draw_half_blocks(np.array(_COLOURS, np.uint8)[pixels], "palette" if colour else "letters")
    return lines if colour else [line.rstrip() for line in lines]
