"""The fiducials of the simulated world `office` as a map file, as if somebody had mapped them without an error."""

from pathlib import Path

import numpy as np

from ur.worlds.world_file import read_world
from ur_nodes.geometry.rigid import from_angles
from ur_nodes.vision.fiducial_map import MapEntry, write_map

OFFICE = Path(__file__).resolve().parents[1] / "ubiquity_launches" / "n_simulator" / "worlds" / "office.yaml"


def write_office_map(path: Path) -> Path:
    """Write it, and return its path."""
    covariance = np.eye(6) * 1e-4
    write_map(
        path,
        (
            MapEntry(each.id, from_angles(each.pose[:3], each.pose[3:]), covariance)
            for each in read_world(OFFICE).fiducials
        ),
    )
    return path
