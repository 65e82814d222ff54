"""How far from walls the local costmap marks while a robot, whose lidar takes time for a scan, turns on the spot."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
from bench.navigation_parts.stack import load_robot
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from tests.ur_nodes.first_drive.drive import FirstDrive

from ur_nodes.ports.values import Map
from ur_nodes.simulator import simulator_node

_FAR, _GOAL = 0.15, 0.05  # m


def print_spins(name: str, speeds: list[float], rates: list[float] | None, seed: int) -> int:
    """Print a line for each rate of the lidar (Hz; None: that of the base) and speed (rad/s). Returns an exit code."""
    base = load_robot(name)
    assert base.lidar
    good = True
    for rate in rates or [base.lidar.rate]:
        for speed in speeds:
            off, turned = measure_spin(name, rate, speed, seed)
            good &= bool(off.max() <= _GOAL + 1e-6)
            figures = ", ".join(f"{share:g} %: {np.quantile(off, share / 100.0):.2f}" for share in (50, 90, 99, 100))
            far = 100.0 * float(np.mean(off > _FAR))
            print(f"{name} {rate:4.1f} Hz {turned:5.2f} rad/s: {figures} m; {far:.2f} % above {_FAR} m", flush=True)
    return 0 if good else 1


def measure_spin(
    name: str, rate: float, speed: float, seed: int, seconds: int = 8
) -> tuple[NDArray[np.float64], float]:
    """The distances (n,) in m of marked cells to the nearest wall, and the mean speed (rad/s) that was reached."""
    base = load_robot(name)
    assert base.lidar
    limits = replace(base.limits, angular_velocity=max(abs(speed), base.limits.angular_velocity))
    base = replace(base, lidar=replace(base.lidar, rate=rate), limits=limits)
    kind, _, variant = name.partition(":")
    with patch.object(simulator_node, "load_base", lambda *_: base):
        drive = FirstDrive("maze", base=kind, variant=variant, seed=seed)
    grids, walls = drive.record("move_base/local_costmap/costmap", Map), drive.grid()
    frames = drive.client.transforms
    away = distance_transform_edt(np.asarray(walls.values) < 65) * walls.resolution
    drive.drive(0.0, speed, 1.0, "cmd_vel")
    off, begun = [], len(drive.truths)
    for _ in range(seconds):
        grids.clear()
        drive.drive(0.0, speed, 1.0, "cmd_vel")
        for each in grids:
            place = frames.find_planar("map", each.frame)
            assert place is not None
            marked = each.grid.points_of_cells(np.argwhere(each.grid.values >= 100))
            cells = (place.transform_points(marked) - walls.origin[:2]) / walls.resolution
            columns, rows = np.floor(cells).astype(int).T
            off.append(away[rows.clip(0, away.shape[0] - 1), columns.clip(0, away.shape[1] - 1)])
    return np.concatenate(off), float(np.mean([each.twist.turn for each in drive.truths[begun:]]))
