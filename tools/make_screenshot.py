"""Make pictures of the real terminal program over a robot in the maze, in docs/images: NAME.svg.

Usage: tools/make_screenshot.py [NAME] [COLUMNSxROWS] [dark|light]. The names: keyboard_navigate (a robot on its way),
assistant (one that an assistant drives), script (one that a script drives), lost (one that was carried elsewhere),
people (one that waits for them). The same input gives the same file.
"""

import asyncio
import math
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, uniform_filter1d
from skimage.graph import route_through_array
from textual.widgets import Input

from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.mux import MuxRequest
from ur_nodes.client.patrol_text import PatrolAction, PatrolRoute
from ur_nodes.client.saving import save_recordings
from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.lease.view import LeaseView
from ur_nodes.teleop.navigate.app import NavigateApp

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from tools.pictures import IMAGES, ROOT, clean_svg, read_size, save

MAP = ROOT / "ubiquity_launches/n_map_server/maps/maze.yaml"
START = Pose2(0.0, 0.0, 0.0)
ROBOT_AT = 0.62  # of the way
GOAL = Pose2(12.1, 7.65, math.pi / 2)
SINCE = 39720.0  # s since 1970: 11:02
ASSISTANT = "assistant, at most 0.2 m/s until 11:32, not kitchen"
CARRIED_TO = Pose2(6.4, 10.7, 2.2)
SEARCHING = "lost: the scan does not fit the map here; searching the whole map"
PEOPLE = ((1.1, 0.0), (1.6, 0.35), (2.6, -0.2))  # m ahead of the robot and to its left
PERSON_RADIUS = 0.2  # m
PLACES = {"dock": START, "kitchen": Pose2(16.6, 1.65, 0.0), "desk": Pose2(6.4, 4.65, 0.0)}


class StillNavigator:
    """A Navigator whose robot is on its way and never arrives."""

    def __init__(self, snapshot: RobotSnapshot) -> None:
        self._snapshot = snapshot

    def snapshot(self) -> RobotSnapshot:
        """Always the same."""
        return self._snapshot

    def go(self, _place: Pose2, *, any_heading: bool = False) -> int:  # noqa: ARG002 - see Navigator
        """Nothing."""
        return 1

    def ask_patrol(self, _action: PatrolAction, _route: PatrolRoute) -> str:
        """Nothing."""
        return ""

    def resume(self) -> None:
        """Nothing."""

    def request_lease(self, _request: DriverRequest) -> None:
        """Nothing."""

    def stop(self) -> None:
        """Nothing."""

    def ask_mux(self, _wish: MuxRequest) -> None:
        """Nothing."""

    def set_pose(self, _place: Pose2) -> None:
        """Nothing."""

    def relocalise(self) -> None:
        """Nothing."""


def find_path(grid: Grid, start: Pose2, goal: Pose2) -> NDArray[np.float64]:
    """A way (n, 2) that keeps off the walls."""
    room = distance_transform_edt(grid.values == 0) * grid.resolution
    cost = np.where(room < 0.25, 1e6, 1.0 + 3.0 * np.exp(-3.0 * (room - 0.25)))
    cells = grid.cells_of_points(np.array([start[:2], goal[:2]])).tolist()
    route, _ = route_through_array(cost, cells[0], cells[1], geometric=True)
    rows_columns = uniform_filter1d(np.array(route, dtype=float), 9, axis=0, mode="nearest")
    return grid.points_of_cells(rows_columns)


def cast_scan(grid: Grid, pose: Pose2, reach: float = 8.0) -> NDArray[np.float64]:
    """Where 360 beams from a pose end, (n, 2); beams that reach nothing are left out."""
    angles = pose.yaw + np.radians(np.arange(360.0))
    ranges = np.arange(0.1, reach, grid.resolution / 2)
    directions = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    points = pose[:2] + ranges[:, None] * directions[:, None]
    hit = grid.values_at(points) > 50
    seen = np.flatnonzero(hit.any(axis=1))
    ends: NDArray[np.float64] = points[seen, hit.argmax(axis=1)[seen]]
    return ends


def make_snapshot() -> RobotSnapshot:
    """Return a robot some way along its path."""
    grid = load_map(MAP)
    path = find_path(grid, START, GOAL)
    at = int(len(path) * ROBOT_AT)
    ahead = path[at + 6] - path[at]
    pose = Pose2(float(path[at, 0]), float(path[at, 1]), math.atan2(ahead[1], ahead[0]))
    return RobotSnapshot(
        grid=grid,
        pose=pose,
        scan=cast_scan(grid, pose),
        path=path[at:],
        goal=GoalReport(1, GOAL, LastGoalState.DRIVING),
        speed=0.5,
        spread=0.04,
        lease=LeaseView(),
    )


def add_assistant(snapshot: RobotSnapshot) -> RobotSnapshot:
    """Return the snapshot while an assistant drives."""
    return replace(snapshot, speed=0.2, lease=LeaseView("held", "desk", ASSISTANT, SINCE, link_age=0.0))


def add_script(snapshot: RobotSnapshot) -> RobotSnapshot:
    """Return the snapshot while a script drives."""
    return replace(snapshot, lease=LeaseView("held", "laptop", "look_around", SINCE, link_age=0.0))


def carry_away(snapshot: RobotSnapshot) -> RobotSnapshot:
    """Return the snapshot after the robot was carried elsewhere: its scan is not that of its estimated pose."""
    assert snapshot.grid is not None
    assert snapshot.pose is not None
    moved = snapshot.pose.compose(CARRIED_TO.inverse())
    scan = moved.transform_points(cast_scan(snapshot.grid, CARRIED_TO))
    return replace(snapshot, scan=scan, lost=SEARCHING, speed=0.0, spread=0.9)


def add_people(snapshot: RobotSnapshot) -> RobotSnapshot:
    """Return the snapshot while people stand in the way: the scan ends at them, and the robot waits."""
    assert snapshot.grid is not None
    assert snapshot.pose is not None
    grid = snapshot.grid
    values = grid.values.copy()
    cells = grid.points_of_cells(np.moveaxis(np.indices(values.shape), 0, -1))
    for person in snapshot.pose.transform_points(np.array(PEOPLE)):
        values[np.hypot(*np.moveaxis(cells - person, -1, 0)) < PERSON_RADIUS] = 100
    return replace(snapshot, scan=cast_scan(replace(grid, values=values), snapshot.pose), speed=0.0)


PICTURES: dict[str, Callable[[RobotSnapshot], RobotSnapshot]] = {
    "keyboard_navigate": lambda snapshot: snapshot,
    "assistant": add_assistant,
    "script": add_script,
    "lost": carry_away,
    "people": add_people,
}


async def take_screenshot(size: tuple[int, int], light: bool, picture: str = "keyboard_navigate") -> str:
    """Return the screen as SVG."""
    snapshot = PICTURES[picture](make_snapshot())
    with tempfile.TemporaryDirectory() as folder:
        store = WaypointStore(Path(folder) / "maze.yaml")
        for name, place in PLACES.items():
            store.remember(name, place)
        recording = save_recordings(Bus().node("keyboard_navigate"))
        app = NavigateApp(StillNavigator(snapshot), lambda _: store, recording=recording, title="maze", light=light)
        async with app.run_test(size=size) as pilot:
            for line in app.query(Input):
                line.cursor_blink = False
            await pilot.pause(0.5)
            svg = app.export_screenshot(title="keyboard_navigate", simplify=True)
    return clean_svg(svg)


def main() -> None:
    """Write the picture."""
    name = sys.argv[1] if len(sys.argv) > 1 else "keyboard_navigate"
    if name not in PICTURES:
        sys.exit(f"error: '{name}' is not known, expected one of {', '.join(PICTURES)}")
    size, light = read_size(sys.argv[2:], "96x32")
    save(asyncio.run(take_screenshot(size, light, name)), IMAGES / f"{name}.svg")


if __name__ == "__main__":
    main()
