"""A map that the robot makes of a world by exploring, and its place in the world."""

import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench.mapping_parts.measure import best_fit
from bench.navigation_parts.launch_files import Simulated, exploration_launch
from bench.navigation_parts.stack import Stack
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ur.maps.store import PICTURE, own_store
from ur_nodes.geometry.grid import FREE, UNKNOWN, Grid, load_map
from ur_nodes.geometry.pose import Pose2

_LONGEST = 3600.0  # s of this computer for an exploration
_OCCUPIED = 65
_ROUNDS = 30
_REACHES = (0.5, 0.2, 0.1)  # m: cells farther from any wall are left out, in the first rounds, the next, and the last
_ENDS = ("the map is ", "the exploration ", "stopped ")


@dataclass(frozen=True, slots=True, eq=False)
class ExploredMap:
    """A map, its file, the pose of its frame in the world, and the rms distance in m of its walls from true ones."""

    file: Path
    grid: Grid
    pose: Pose2
    error: float


def explore(simulated: Simulated, folder: Path, ros: str) -> Path:
    """Explore a world with real nodes; return the file of the stored map. Raises SystemExit: there is none."""
    name = simulated.world.name
    extra = {"XDG_DATA_HOME": str(folder / "explored")}
    with Stack(f"explore_{name}", exploration_launch(simulated, name), folder, extra, ros=ros) as stack:
        ended = stack.wait_for_end(_LONGEST)
        output = stack.output()
    file = own_store(extra).picture(name)
    if not ended or not file.is_file():
        tail = "\n".join(output[-15:])
        raise SystemExit(f"error: exploration of {name} ended without a map, expected one\n{tail}")
    for line in output:
        if line.startswith(_ENDS):
            print(f"  {line}")
    return file


def explore_once(simulated: Simulated, folder: Path, kept: Path | None, ros: str) -> Path:
    """Likewise, but a map of this base, world and seed in `kept` is taken instead, and a new one is left there."""
    if kept is None:
        return explore(simulated, folder, ros)
    base = "_".join(filter(None, (simulated.base.name, simulated.base.variant)))
    place = kept / f"{base}_{simulated.world.name}_{simulated.seed}"
    if not (place / PICTURE).is_file():
        kept.mkdir(parents=True, exist_ok=True)
        shutil.copytree(explore(simulated, folder, ros).parent, place, dirs_exist_ok=True)
    return place / PICTURE


def read_explored(file: Path, world: Grid) -> ExploredMap:
    """Read a map that began about where the world's frame is, and fit it to the world. Raises UserError."""
    grid = load_map(file)
    pose, error = align(grid, world)
    return ExploredMap(file, grid, pose, error)


def align(grid: Grid, world: Grid) -> tuple[Pose2, float]:
    """Fit the surfaces of a map's walls to those of the true ones, by least squares and iterated nearest points.

    Returns the pose of the map's frame in the world, and the rms distance in m of the surfaces that count.
    """
    surface = surface_points(world)
    tree = cKDTree(surface)
    drawn = surface_points(grid, only_free=True)
    pose, error = Pose2(0.0, 0.0, 0.0), 0.0
    for number in range(_ROUNDS):
        distances, nearest = tree.query(pose.transform_points(drawn))
        near = distances < _REACHES[number * len(_REACHES) // _ROUNDS]
        fit = best_fit(drawn[near], surface[nearest[near]])
        pose, error = Pose2(fit.x, fit.y, fit.yaw), float(np.sqrt(np.mean(np.square(distances[near]))))
    return pose, error


def surface_points(grid: Grid, spacing: float = 0.01, *, only_free: bool = False) -> NDArray[np.float64]:
    """Return points (n, 2) in m on the edges between occupied cells and others, at most `spacing` m apart.

    With `only_free`, on those to free cells: where a map ends behind a wall that was seen from one side, is no surface.
    """
    values = np.pad(grid.values, 1, constant_values=UNKNOWN)
    occupied = values >= _OCCUPIED
    other = values == FREE if only_free else ~occupied
    along = np.arange(0.0, 1.0, spacing / grid.resolution)
    lower, upper = slice(None, -1), slice(1, None)
    rows, columns = np.nonzero((occupied[lower] & other[upper]) | (other[lower] & occupied[upper]))
    flat = np.stack(np.broadcast_arrays(columns[:, None] - 1.0 + along, rows[:, None] * 1.0), axis=-1).reshape(-1, 2)
    rows, columns = np.nonzero((occupied[:, lower] & other[:, upper]) | (other[:, lower] & occupied[:, upper]))
    upright = np.stack(np.broadcast_arrays(columns[:, None] * 1.0, rows[:, None] - 1.0 + along), axis=-1).reshape(-1, 2)
    points: NDArray[np.float64] = grid.origin.transform_points(grid.resolution * np.concatenate((flat, upright)))
    return points
