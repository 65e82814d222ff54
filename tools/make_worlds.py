#!/usr/bin/env python
"""Make the worlds that come with the simulator: floor plans (also the maps of navigation) and world files.

Everything is drawn in whole cells of 0.05 m and comes from fixed numbers, so that a second run makes the same pixels.
Run it from anywhere: `tools/make_worlds.py [DIRECTORY]` writes into the launch package, or into DIRECTORY.
"""

import argparse
import math
from dataclasses import dataclass
from pathlib import Path
from random import Random

import numpy as np
import numpy.typing as npt
from PIL import Image

CELL = 0.05
FREE, OCCUPIED, UNKNOWN = 254, 0, 205
MARGIN = 10  # unknown cells round the outer wall
WALL = 2
DOOR = 18
CEILING, ON_WALL = 2.4, 0.65  # heights of fiducials, m
FIDUCIAL_SIZE = 0.3  # their edges, m
FIDUCIAL_PITCH = 46  # cells between those on the ceiling

Grid = npt.NDArray[np.uint8]
Rect = tuple[int, int, int, int]  # x, y, width, height in cells; y goes up


@dataclass(frozen=True, slots=True)
class Fiducial:
    """A marker: where in the plan (cells), its height (m), and the way it faces (rad); None: down, turned by `turn`."""

    x: float
    y: float
    z: float
    facing: float | None
    turn: float = 0.0


@dataclass(frozen=True, slots=True)
class Drawing:
    """A floor plan: `grid` (rows go up from the bottom), the cell corner where robots start, boxes above the floor."""

    name: str
    title: str
    grid: Grid
    start: tuple[int, int]
    boxes: tuple[tuple[str, Rect, float, float], ...] = ()  # name, place, bottom and top (m)
    fiducials: tuple[Fiducial, ...] = ()


def fill(grid: Grid, rect: Rect, value: int) -> None:
    """Paint a rectangle."""
    x, y, width, height = rect
    grid[y : y + height, x : x + width] = value


def draw_maze(seed: int = 7, columns: int = 14, rows: int = 10, size: tuple[int, int] = (400, 300)) -> Drawing:
    """A maze of passages 1.2 to 1.5 m wide: a random tree, then loops, some passages narrowed to doors."""
    random = Random(seed)  # noqa: S311 - it must repeat, not surprise
    widths = split_length(random, size[0] - WALL * (columns + 1), columns)
    heights = split_length(random, size[1] - WALL * (rows + 1), rows)
    x_of = [MARGIN + WALL + sum(widths[:i]) + WALL * i for i in range(columns)]
    y_of = [MARGIN + WALL + sum(heights[:j]) + WALL * j for j in range(rows)]
    grid = np.full((size[1] + 2 * MARGIN, size[0] + 2 * MARGIN), UNKNOWN, np.uint8)
    fill(grid, (MARGIN, MARGIN, size[0], size[1]), OCCUPIED)
    for i in range(columns):
        for j in range(rows):
            fill(grid, (x_of[i], y_of[j], widths[i], heights[j]), FREE)
    for (i, j), (k, m) in open_passages(random, columns, rows):
        door = random.random() < 0.3
        if i != k:
            gap, offset = (DOOR, (heights[j] - DOOR) // 2) if door else (heights[j], 0)
            fill(grid, (x_of[k] - WALL, y_of[j] + offset, WALL, gap), FREE)
        else:
            gap, offset = (DOOR, (widths[i] - DOOR) // 2) if door else (widths[i], 0)
            fill(grid, (x_of[i] + offset, y_of[m] - WALL, gap, WALL), FREE)
    remove_posts(grid)
    start = (x_of[0] + 10, y_of[0] + 10)  # the corner at the bottom left: nearly all coordinates are positive
    return Drawing("maze", "A maze of narrow passages and doors.", grid, start)


def split_length(random: Random, total: int, parts: int) -> list[int]:
    """Lengths from 24 to 30 cells (1.2 to 1.5 m) that add up to `total`."""
    lengths = [24 + int(random.random() * 7) for _ in range(parts)]
    while sum(lengths) != total:
        step = 1 if sum(lengths) < total else -1
        index = int(random.random() * parts)
        if 24 <= lengths[index] + step <= 30:
            lengths[index] += step
    return lengths


def open_passages(random: Random, columns: int, rows: int) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Pairs of neighbouring cells (the lower or left one first) to join: a tree over all cells, and some loops."""
    joined: list[tuple[tuple[int, int], tuple[int, int]]] = []
    seen, stack = {(0, 0)}, [(0, 0)]
    while stack:
        i, j = stack[-1]
        ways = [(i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)]
        ways = [(k, m) for k, m in ways if 0 <= k < columns and 0 <= m < rows and (k, m) not in seen]
        if not ways:
            stack.pop()
            continue
        way = ways[int(random.random() * len(ways))]
        joined.append(((i, j), way) if (i, j) < way else (way, (i, j)))
        seen.add(way)
        stack.append(way)
    tree = set(joined)
    for i in range(columns):
        for j in range(rows):
            for way in ((i + 1, j), (i, j + 1)):
                inside = way[0] < columns and way[1] < rows
                if inside and ((i, j), way) not in tree and random.random() < 0.16:
                    joined.append(((i, j), way))
    return joined


def remove_posts(grid: Grid) -> None:
    """Clear posts of one wall's width that no wall touches."""
    for y in range(1, grid.shape[0] - WALL):
        for x in range(1, grid.shape[1] - WALL):
            around = grid[y - 1 : y + WALL + 1, x - 1 : x + WALL + 1]
            post = around[1:-1, 1:-1]
            if (post == OCCUPIED).all() and (around == OCCUPIED).sum() == WALL * WALL:
                post[:] = FREE


def draw_office() -> Drawing:
    """Rooms on both sides of a corridor, joined by doors, with furniture."""
    grid = np.full((320, 420), UNKNOWN, np.uint8)

    def paint(value: int, *rects: Rect) -> None:
        for x, y, width, height in rects:
            fill(grid, (x + MARGIN, y + MARGIN, width, height), value)

    paint(OCCUPIED, (0, 0, 400, 300))
    # Corridors: one along, one across; then the rooms, walls of 0.1 m between them, 0.15 m outside.
    paint(FREE, (3, 138, 394, 30), (236, 3, 28, 135))
    paint(FREE, (3, 170, 90, 127), (95, 170, 70, 127), (167, 170, 110, 127), (279, 170, 118, 127))
    paint(FREE, (3, 3, 128, 133), (133, 3, 101, 64), (133, 69, 101, 67), (266, 3, 131, 60), (266, 65, 131, 71))
    # Doors to the corridors, then between rooms.
    paint(FREE, (40, 168, DOOR, 2), (120, 168, DOOR, 2), (185, 168, DOOR, 2), (300, 168, DOOR, 2), (364, 168, DOOR, 2))
    paint(FREE, (20, 136, DOOR, 2), (98, 136, DOOR, 2), (170, 136, DOOR, 2), (320, 136, DOOR, 2))
    paint(FREE, (234, 24, 2, DOOR), (264, 20, 2, DOOR), (264, 92, 2, DOOR))
    paint(FREE, (93, 262, 2, DOOR), (277, 255, 2, DOOR), (131, 30, 2, DOOR), (340, 63, DOOR, 2))
    # Shelves and cupboards along walls.
    paint(OCCUPIED, (3, 289, 50, 8), (157, 190, 8, 60), (167, 289, 60, 8), (389, 200, 8, 56), (3, 60, 8, 50))
    paint(OCCUPIED, (150, 3, 60, 8), (224, 80, 10, 30), (380, 3, 17, 17), (266, 128, 30, 8), (383, 90, 14, 30))
    # Desks, tables, a sofa, pillars.
    paint(OCCUPIED, (3, 200, 14, 28), (3, 240, 14, 28), (79, 205, 14, 28), (105, 279, 28, 14), (121, 225, 14, 28))
    paint(OCCUPIED, (40, 40, 28, 28), (40, 90, 28, 14), (95, 65, 14, 28), (150, 100, 28, 14), (190, 40, 28, 14))
    paint(OCCUPIED, (310, 25, 40, 16), (300, 90, 14, 14), (345, 96, 14, 14), (330, 200, 10, 10), (330, 250, 10, 10))
    tables = {"meeting_table": (198, 205, 48, 26), "kitchen_table": (350, 222, 20, 16)}
    for x, y, width, height in tables.values():
        for dx in (0, width - 2):
            for dy in (0, height - 2):
                paint(OCCUPIED, (x + dx, y + dy, 2, 2))
    # Chairs, none of them in line with its neighbours: people leave them so.
    paint(OCCUPIED, (203, 192, 8, 8), (228, 189, 8, 8), (207, 238, 8, 8), (231, 242, 8, 8), (25, 210, 8, 8))
    paint(OCCUPIED, (26, 252, 8, 8), (63, 212, 8, 8), (52, 75, 8, 8), (158, 118, 8, 8), (196, 58, 8, 8))
    boxes = tuple(
        (name, (x + MARGIN, y + MARGIN, width, height), 0.70, 0.74) for name, (x, y, width, height) in tables.items()
    )
    title = "An office: rooms, doors, furniture, fiducials."
    return Drawing("office", title, grid, (30 + MARGIN, 153 + MARGIN), boxes, place_fiducials(grid))


def place_fiducials(grid: Grid) -> tuple[Fiducial, ...]:
    """Fiducials in a grid on the ceiling, and from below each one on the next wall one way, every time another way."""
    found: list[Fiducial] = []
    ways = ((1, 0), (0, 1), (-1, 0), (0, -1))
    number = 0
    for y in range(MARGIN + FIDUCIAL_PITCH // 2, grid.shape[0] - MARGIN, FIDUCIAL_PITCH):
        for x in range(MARGIN + FIDUCIAL_PITCH // 2, grid.shape[1] - MARGIN, FIDUCIAL_PITCH):
            if grid[y, x] != FREE:
                continue
            found.append(Fiducial(x + 0.5, y + 0.5, CEILING, None, number % 4 * math.pi / 2.0))
            way = ways[(number + number // 4) % 4]
            number += 1
            if wall := next_wall(grid, (x, y), way):
                found.append(wall)
    return tuple(found)


def next_wall(grid: Grid, start: tuple[int, int], way: tuple[int, int]) -> Fiducial | None:
    """The fiducial on the first wall from a cell in a direction, if that wall is wide enough for its plate."""
    (x, y), (dx, dy) = start, way
    while grid[y, x] == FREE:
        x, y = x + dx, y + dy
    if grid[y, x] != OCCUPIED:
        return None
    for aside in range(-4, 5):
        here = x + aside * dy, y + aside * dx
        if grid[here[1], here[0]] != OCCUPIED or grid[here[1] - dy, here[0] - dx] != FREE:
            return None
    gap = 0.6  # cells from the middle of the wall's cell: just off its face
    return Fiducial(x + 0.5 - gap * dx, y + 0.5 - gap * dy, ON_WALL, math.atan2(-dy, -dx))


def write_world(drawing: Drawing, package: Path) -> None:
    """Write the map (image and YAML) and the world file of a drawing."""
    maps = package / "n_map_server" / "maps"
    worlds = package / "n_simulator" / "worlds"
    maps.mkdir(parents=True, exist_ok=True)
    worlds.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.flipud(drawing.grid)).save(maps / f"{drawing.name}.png", optimize=True)
    origin = [round(-CELL * c, 3) for c in drawing.start]
    (maps / f"{drawing.name}.yaml").write_text(
        f"# {drawing.title} Made by tools/make_worlds.py.\n"
        f"image: {drawing.name}.png\nresolution: {CELL}\norigin: [{origin[0]:g}, {origin[1]:g}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    (worlds / f"{drawing.name}.yaml").write_text(world_text(drawing, origin))


def world_text(drawing: Drawing, origin: list[float]) -> str:
    """The world file of a drawing. Three obstacles wait outside, where no lidar sees them."""
    lines = [
        f"# {drawing.title} Made by tools/make_worlds.py.",
        f"floor_plan: ../../n_map_server/maps/{drawing.name}.yaml",
        "wall_height: 1.0",
    ]
    if drawing.boxes:
        lines.append("boxes: # table tops: robots drive below them; the legs are part of the floor plan")
    for name, (x, y, width, height), bottom, top in drawing.boxes:
        centre = [origin[0] + CELL * (x + width / 2), origin[1] + CELL * (y + height / 2), (bottom + top) / 2]
        pose = ", ".join(f"{round(v, 3):g}" for v in centre)
        size = f"{width * CELL:g}, {height * CELL:g}, 0.04"
        lines.append(f"  - name: {name}\n    pose: [{pose}, 0.0]\n    size: [{size}]")
    lines.append("obstacles: # wait outside the walls until somebody places them (service ~place)")
    for number in (1, 2, 3):
        left, low = origin[0] - 2.0, origin[1] + 2.0 * number
        lines.append(f"  - name: obstacle_{number}\n    pose: [{left:g}, {low:g}, 0.0]")
        lines.append("    size: [0.3, 0.3, 0.6]\n    mass: 20.0")
    return "\n".join(lines + fiducial_lines(drawing, origin)) + "\n"


def fiducial_lines(drawing: Drawing, origin: list[float]) -> list[str]:
    """The fiducials of a world file, numbered from 0."""
    if not drawing.fiducials:
        return []
    lines = ["fiducials: # cameras see them, lidars do not", "  dictionary: 5X5_1000", f"  size: {FIDUCIAL_SIZE}"]
    lines.append("  places:")
    for number, each in enumerate(drawing.fiducials):
        x, y = origin[0] + CELL * each.x, origin[1] + CELL * each.y
        angles = (math.pi, 0.0, each.turn) if each.facing is None else (math.pi / 2.0, 0.0, each.facing + math.pi / 2.0)
        pose = ", ".join(f"{round(value, 6) + 0.0:g}" for value in (x, y, each.z, *angles))
        lines.append(f"    - {{id: {number}, pose: [{pose}]}}")
    return lines


def main() -> None:
    """Write both worlds."""
    default = Path(__file__).resolve().parent.parent / "ubiquity_launches"
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", nargs="?", type=Path, default=default, help="the launch package to write into")
    for drawing in (draw_maze(), draw_office()):
        write_world(drawing, parser.parse_args().directory)


if __name__ == "__main__":
    main()
