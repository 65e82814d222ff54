"""A world of the simulator: a YAML file, read and validated.

The file names its floor plan, a map in map_server's format, or has the keys of one itself: so every such map is a
world, and a world file of that kind is a map.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from ur.source.section import Section, read_section
from ur.worlds.map_file import MapImage, parse_map_file, read_map, read_map_section

MOST_PEOPLE = 50

# Name: cells along an edge without the black border, number of markers.
DICTIONARIES = {f"{n}X{n}_{count}": (n, count) for n in (4, 5, 6, 7) for count in (50, 100, 250, 1000)}


@dataclass(frozen=True, slots=True)
class Box:
    """A box. `pose` is x, y, z (m) of its centre and yaw (rad); `size` are its full edge lengths.

    With a `mass` (kg) it is an obstacle that can be pushed and placed; without, it is fixed. Lidars and cameras look
    through `glass`.
    """

    name: str
    pose: tuple[float, float, float, float]
    size: tuple[float, float, float]
    mass: float | None = None
    glass: bool = False


@dataclass(frozen=True, slots=True)
class Drop:
    """A rectangle without floor, such as the top of a stair. `pose` is x, y (m) of its centre and yaw (rad)."""

    pose: tuple[float, float, float]
    size: tuple[float, float]

    def holds(self, x: float, y: float) -> bool:
        """Return True for a point of the map (m) inside of it."""
        dx, dy = x - self.pose[0], y - self.pose[1]
        c, s = math.cos(self.pose[2]), math.sin(self.pose[2])
        return abs(c * dx + s * dy) <= self.size[0] / 2.0 and abs(c * dy - s * dx) <= self.size[1] / 2.0


@dataclass(frozen=True, slots=True)
class Fiducial:
    """A square marker. `pose` is x, y, z (m), roll, pitch, yaw (rad) of its centre in the map.

    Its x axis points to the right and y up in reading direction, z out of it. `size` (m) is the edge of the black
    square; `dictionary` names one of OpenCV's: "5X5_1000".
    """

    id: int
    pose: tuple[float, float, float, float, float, float]
    size: float
    dictionary: str


@dataclass(frozen=True, slots=True)
class WorldModel:
    """The world of the robots, in the map frame: m, rad.

    `start` (x, y, yaw) is where they begin, `people` the number of people who walk in it.
    """

    floor_plan: MapImage
    wall_height: float
    floor_friction: float
    boxes: tuple[Box, ...]
    obstacles: tuple[Box, ...]
    start: tuple[float, float, float]
    fiducials: tuple[Fiducial, ...] = ()
    drops: tuple[Drop, ...] = ()
    people: int = 0


def read_world(path: str | Path) -> WorldModel:
    """Read a world file and its floor plan. Raises UserError with file, line and column."""
    top = read_section(path, "a world file")
    floor_plan = _floor_plan(top, Path(path))
    return _read_parts(top)(floor_plan)


def check_world(top: Section, path: Path) -> None:
    """Raise UserError as `read_world` does for keys and values of a world file, without reading other files."""
    if top.has("image"):
        parse_map_file(top, path.parent)
    elif not top.text("floor_plan"):
        top.fail("floor_plan", "floor_plan: '' in a world file, expected the path of a map file")
    _read_parts(top)


def _read_parts(top: Section) -> Callable[[MapImage], WorldModel]:
    start = top.numbers("start", 3, (0.0, 0.0, 0.0))
    seen: set[str] = set()
    people = top.integer("people", 0, minimum=0)
    if people > MOST_PEOPLE:
        top.fail("people", f"people: {people}, expected at most {MOST_PEOPLE}")
    world = partial(
        WorldModel,
        wall_height=top.number("wall_height", 1.0, minimum=0.05, maximum=100.0),
        floor_friction=top.number("floor_friction", 0.9, minimum=0.05, maximum=5.0),
        boxes=tuple(_box(part, movable=False, seen=seen) for part in top.sections("boxes")),
        obstacles=tuple(_box(part, movable=True, seen=seen) for part in top.sections("obstacles")),
        start=(start[0], start[1], start[2]),
        fiducials=_fiducials(top.optional_section("fiducials")),
        drops=tuple(_drop(part) for part in top.sections("drops")),
        people=people,
    )
    top.finish()
    return world


def _floor_plan(top: Section, path: Path) -> MapImage:
    if top.has("image") and top.has("floor_plan"):
        top.fail("floor_plan", f"floor_plan: {path.name} has an image of its own, expected one of them")
    if top.has("image"):
        return read_map_section(top, path.parent)
    plan = path.parent / top.text("floor_plan")
    if not plan.is_file():
        top.fail("floor_plan", f"floor_plan: {plan} does not exist, expected a map file relative to {path.name}")
    return read_map(plan)


def _box(part: Section, *, movable: bool, seen: set[str]) -> Box:
    name = part.text("name")
    if name in seen:
        part.fail("name", f"name: {name!r} is given twice in {part.name}, expected each box once")
    seen.add(name)
    size = part.numbers("size", 3)
    if min(size) <= 0.0:
        part.fail("size", f"size: {list(size)} in {part.name}, expected three lengths above 0")
    if movable:  # an obstacle stands on the floor
        x, y, yaw = part.numbers("pose", 3)
        pose = (x, y, size[2] / 2.0, yaw)
        mass, glass = part.number("mass", minimum=0.01), False
    else:
        x, y, z, yaw = part.numbers("pose", 4)
        pose, mass = (x, y, z, yaw), None
        glass = part.boolean("glass", False)
    part.finish()
    return Box(name, pose, (size[0], size[1], size[2]), mass, glass)


def _drop(part: Section) -> Drop:
    size = part.numbers("size", 2)
    if min(size) <= 0.0:
        part.fail("size", f"size: {list(size)} in {part.name}, expected two lengths above 0")
    x, y, yaw = part.numbers("pose", 3)
    part.finish()
    return Drop((x, y, yaw), (size[0], size[1]))


def _fiducials(part: Section | None) -> tuple[Fiducial, ...]:
    """Read one dictionary for all markers, a size for those without one, and the list `places`."""
    if part is None:
        return ()
    dictionary = part.text("dictionary", "5X5_1000", choices=sorted(DICTIONARIES))
    size = part.number("size", 0.14, minimum=0.01, maximum=10.0)
    found: dict[int, Fiducial] = {}
    for item in part.sections("places"):
        number = item.integer("id", minimum=0)
        if number in found or number >= DICTIONARIES[dictionary][1]:
            reason = "is given twice" if number in found else f"is not in {dictionary}"
            expected = f"another number below {DICTIONARIES[dictionary][1]}"
            item.fail("id", f"id: {number} {reason} in {item.name}, expected {expected}")
        x, y, z, roll, pitch, yaw = item.numbers("pose", 6)
        own = item.number("size", size, minimum=0.01, maximum=10.0)
        found[number] = Fiducial(number, (x, y, z, roll, pitch, yaw), own, dictionary)
        item.finish()
    part.finish()
    return tuple(found.values())
