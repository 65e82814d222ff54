"""A room with exact walls, and robots in it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from ur.robot.base import Base, load_base
from ur.worlds.world_file import WorldModel, read_world
from ur_nodes.simulator.simulation import Simulation

PACKAGE = Path(__file__).resolve().parents[3] / "ubiquity_launches"
MakeWorld = Callable[[str], WorldModel]


@pytest.fixture
def make_world(tmp_path: Path) -> MakeWorld:
    """Reads a room of 6 x 4 m inside, whose inner lower left corner is (-1, -2), with further lines in its file."""
    cells = np.full((84, 124), 254, np.uint8)
    cells[:2] = cells[-2:] = 0
    cells[:, :2] = cells[:, -2:] = 0
    Image.fromarray(cells).save(tmp_path / "room.png")
    (tmp_path / "room.yaml").write_text(
        "image: room.png\nresolution: 0.05\norigin: [-1.1, -2.1, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )

    def make(lines: str = "") -> WorldModel:
        (tmp_path / "world.yaml").write_text("floor_plan: room.yaml\n" + lines)
        return read_world(tmp_path / "world.yaml")

    return make


@pytest.fixture
def room(make_world: MakeWorld) -> WorldModel:
    return make_world("")


@pytest.fixture(scope="session")
def stage() -> Base:
    return load_base(PACKAGE, "stage")


@pytest.fixture(scope="session")
def magni() -> Base:
    return load_base(PACKAGE, "magni", "lidar")


@pytest.fixture(scope="session")
def drive() -> Callable[..., None]:
    """Sends a robot the same command all the time for so many simulated seconds."""

    def send(simulation: Simulation, seconds: float, linear: float = 0.0, angular: float = 0.0, robot: int = 0) -> None:
        end = simulation.time + seconds - 1e-9
        while simulation.time < end:
            simulation.command(robot, linear, angular)
            simulation.advance()

    return send
