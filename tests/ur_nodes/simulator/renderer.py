"""Whether pictures can be drawn here."""

import functools
from pathlib import Path

import numpy as np
import pytest

from ur.robot.base import Camera
from ur.source.diagnostic import UserError
from ur.worlds.map_file import MapFile, MapImage
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.camera.camera_process import CameraProcess


@functools.cache
def _reason() -> str:
    from tests.ur_nodes.simulator.conftest import PACKAGE

    from ur.robot.base import load_base

    file = MapFile(
        Path("none.png"), 1.0, (-1.0, -1.0, 0.0), negate=False, occupied_thresh=0.65, free_thresh=0.2, mode="trinary"
    )
    plan = MapImage(file, np.zeros((2, 2), np.int8))
    world = WorldModel(plan, 1.0, 0.9, (), (), (0.0, 0.0, 0.0))
    camera = Camera("raspicam", "raspicam_node", (0.0,) * 6, 16, 16, 1.0, 1.0)
    try:
        CameraProcess(world, load_base(PACKAGE, "magni"), camera, 1).close()
    except UserError as problem:
        return str(problem)
    return ""


def needs_renderer() -> None:
    """Skip the test where nothing can draw, saying why."""
    if _reason():
        pytest.skip(_reason())
