"""Make the pictures of docs/how-to/make-a-map.md in docs/images: the same on every computer, without nodes or a screen.

Usage: tools/make_map_pictures.py [NAME ...]. The names: map_grows (a map at three moments of a drive), map_spoiled (the
map of a flat with a closed door, a person and a glass wall), map_explored (the end of an exploration).
"""

import io
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw
from rich.console import Console
from rich.text import Text

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # flats and drives are the benches'

from bench.exploration_parts.flat import make_flat  # noqa: E402 - after the path
from bench.exploration_parts.quick import explore_quickly  # noqa: E402
from bench.exploration_parts.truth import Truth  # noqa: E402
from bench.mapping_parts.simulated import drive, grid_of_world, load_bench_base  # noqa: E402
from tools.pictures import clean_svg, make_named  # noqa: E402

from ur.worlds.world_file import WorldModel  # noqa: E402
from ur_nodes.costmap.footprint import footprint_of_outline  # noqa: E402
from ur_nodes.exploration.explorer_step import ExplorerSettings  # noqa: E402
from ur_nodes.exploration.status import describe_end  # noqa: E402
from ur_nodes.geometry.grid import FREE, OCCUPIED, Grid  # noqa: E402
from ur_nodes.geometry.pose import Pose2  # noqa: E402
from ur_nodes.geometry.scan import SensorMount  # noqa: E402
from ur_nodes.simulator.simulation import Simulation  # noqa: E402
from ur_nodes.slam.matching.scan import make_scan  # noqa: E402
from ur_nodes.slam.occupancy import OccupancyMap  # noqa: E402
from ur_nodes.slam.tracker import MapTracker  # noqa: E402

FLAT = 0
SCALE = 2  # pixels of a cell
GAP = 12  # pixels between two maps
MOMENTS = (0.12, 0.5, 1.0)  # of a drive
EVERY = 3  # scans
AREA = (-1.2, -5.0, 9.7, 4.8)  # m: left, low, right, high
SHADES = {FREE: 255, OCCUPIED: 0}
UNKNOWN_SHADE = 205
ROBOT = (204, 0, 0)
BEHIND_DOOR = ((0.6, -1.8), (3.2, -1.8))  # m: places of a tour
TOUR = ((5.75, -1.6), (8.0, -1.6), (6.5, 1.6), (3.5, 1.5), (0.2, 1.6), (0.0, 0.0))
DOOR = ((0.15, -0.88), (1.05, -0.72))  # m: two corners of what is closed
PERSON = ((2.3, 2.3), (2.6, 2.55))
GLASS = ((4.2, 1.8), (4.6, 3.4))


def make_map_grows() -> Image.Image:
    """Draw the map of a flat at three moments of one drive."""
    world = make_flat(FLAT)
    return _beside(_maps(world, grid_of_world(world), (*BEHIND_DOOR, *TOUR), MOMENTS))


def make_map_spoiled() -> Image.Image:
    """Draw the map of the same flat with a closed door, a person who stands still, and a glass wall."""
    world = make_flat(FLAT)
    closed = _changed(_changed(world, DOOR, 100), PERSON, 100)
    return _beside(_maps(_changed(closed, GLASS, 0), grid_of_world(closed), TOUR, (1.0,)))


def make_map_explored() -> str:
    """Render the last lines of an exploration."""
    footprint = footprint_of_outline(load_bench_base().footprint, 0.05, 0.01)
    settings = ExplorerSettings(radius=footprint.inscribed, room=footprint.circumscribed)
    status = explore_quickly(Truth(grid_of_world(make_flat(FLAT)), footprint.inscribed), settings).status
    console = Console(record=True, width=110, file=io.StringIO())
    console.print(Text("$ ur run make_map explore:=true map:=flat"))
    console.print(Text("..."))
    console.print(Text(describe_end(status)))
    console.print(Text("the map is stored as 'flat'; navigate on it with\n    ur run keyboard_navigate map:=flat"))
    return clean_svg(console.export_svg(title="make_map", unique_id="terminal"))


def _maps(
    world: WorldModel, floor: Grid, tour: Sequence[tuple[float, float]], moments: Sequence[float]
) -> list[Image.Image]:
    """Drive through a world as the lidar sees it, on a floor; return the map after these shares of the drive."""
    base = load_bench_base()
    assert base.lidar
    taken = list(drive(Simulation(world, base, seed=0), base, floor, tour))[::EVERY]
    angles = np.linspace(base.lidar.angle_min, base.lidar.angle_max, base.lidar.samples)
    directions = np.column_stack((np.cos(angles), np.sin(angles)))
    limits, mount = (base.lidar.range_min, base.lidar.range_max), SensorMount(np.eye(3), np.array(base.lidar.pose[:3]))
    ends = [max(1, round(moment * len(taken))) for moment in moments]
    tracker, pictures = MapTracker(), []
    for number, moment in enumerate(taken, start=1):
        scan = make_scan(moment.ranges, directions, limits, mount)
        estimate = tracker.add_scan(scan, moment.odometry)
        if number in ends:
            drawn = OccupancyMap()
            drawn.update(tracker.keyframes, tracker.scans)
            pictures.append(_picture(drawn.grid(), estimate.pose))
    return pictures


def _changed(world: WorldModel, corners: tuple[tuple[float, float], tuple[float, float]], value: int) -> WorldModel:
    """Fill a rectangle of the floor plan: 100 is wall, 0 floor."""
    plan = world.floor_plan
    values = plan.values.copy()
    x, y = (plan.origin[axis] + plan.resolution * (np.arange(values.shape[1 - axis]) + 0.5) for axis in (0, 1))
    low, high = corners
    values[np.ix_((y > low[1]) & (y < high[1]), (x > low[0]) & (x < high[0]))] = value
    return replace(world, floor_plan=replace(plan, values=values))


def _picture(grid: Grid, robot: Pose2) -> Image.Image:
    left, low, right, high = AREA
    step = grid.resolution
    x, y = np.arange(left, right, step) + 0.5 * step, np.arange(low, high, step) + 0.5 * step
    values = grid.values_at(np.stack(np.meshgrid(x, y[::-1]), axis=-1))
    shades = np.full(values.shape, UNKNOWN_SHADE, np.uint8)
    for value, shade in SHADES.items():
        shades[values == value] = shade
    picture = Image.fromarray(shades).convert("RGB")
    picture = picture.resize((picture.width * SCALE, picture.height * SCALE), Image.Resampling.NEAREST)
    centre = np.array(((robot.x - left) / step, (high - robot.y) / step)) * SCALE
    radius = 0.2 / step * SCALE
    ImageDraw.Draw(picture).ellipse((*(centre - radius), *(centre + radius)), fill=ROBOT)
    return picture


def _beside(pictures: Sequence[Image.Image]) -> Image.Image:
    width = sum(each.width + GAP for each in pictures) - GAP
    sheet = Image.new("RGB", (width, pictures[0].height), (255, 255, 255))
    left = 0
    for each in pictures:
        sheet.paste(each, (left, 0))
        left += each.width + GAP
    return sheet


PICTURES: dict[str, Callable[[], Image.Image | str]] = {
    "map_grows": make_map_grows,
    "map_spoiled": make_map_spoiled,
    "map_explored": make_map_explored,
}


def main(names: list[str]) -> int:
    """Make the pictures with these names, all without any. Returns the exit code."""
    return make_named(PICTURES, names, 16)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
