"""`ur maps edit`: change a stored map by hand."""

import math
import os
from collections.abc import Callable, Sequence

import click

from ur.maps.record import EditKind
from ur.maps.store import MapStore, own_store
from ur.maps.waypoint_file import waypoint_path
from ur.source.diagnostic import UserError, error

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
    return UserError(error(message, rule="bad-edit", help=_HELP))
