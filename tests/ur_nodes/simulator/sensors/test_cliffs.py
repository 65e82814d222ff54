import math
from collections.abc import Callable
from dataclasses import replace

import pytest
from tests.ur_nodes.simulator.conftest import MakeWorld

from ur.robot.base import Base, Cliff, Cliffs
from ur.worlds.world_file import Drop, WorldModel
from ur_nodes.geometry.pose import Pose2
from ur_nodes.simulator.sensors.cliffs import CliffSense, see_drops
from ur_nodes.simulator.simulation import Simulation

CLIFFS = Cliffs("cliff", (Cliff("left", (0.1, 0.1, 0.02)), Cliff("right", (0.1, -0.1, 0.02))))
DROPS = "drops:\n  - {pose: [2.0, 0.0, 0.0], size: [1.0, 4.0]}\n"
Drive = Callable[..., None]


@pytest.mark.parametrize(
    ("pose", "seen"),
    [
        (Pose2(0.0, 0.0, 0.0), set[str]()),
        (Pose2(1.0, 0.05, 0.0), {"left", "right"}),
        (Pose2(1.0, 0.3, 0.0), {"right"}),
        (Pose2(1.3, 0.0, math.pi), {"left", "right"}),
        (Pose2(1.0, 0.15, math.pi / 2.0), {"right"}),
    ],
)
def test_sensors_above_a_turned_drop_see_it(pose: Pose2, seen: set[str]) -> None:
    drop = Drop((1.2, 0.0, math.pi / 2.0), (0.5, 0.4))  # x from 1.0 to 1.4, y from -0.25 to 0.25
    states = see_drops(CLIFFS, [drop], pose)
    assert set(states) == {"left", "right"}
    assert {name for name, state in states.items() if state} == seen


def test_robot_that_drives_to_a_drop_sees_it_and_no_longer_after_driving_back(
    make_world: MakeWorld, stage: Base, drive: Drive
) -> None:
    simulation = Simulation(make_world(DROPS), replace(stage, cliffs=CLIFFS), start=(1.2, 0.0, 0.0))
    assert simulation.senses[0].find(CliffSense).seen() == {"left": False, "right": False}
    drive(simulation, 2.0, 0.3)
    assert simulation.senses[0].find(CliffSense).seen() == {"left": True, "right": True}
    drive(simulation, 2.0, -0.3)
    assert simulation.senses[0].find(CliffSense).seen() == {"left": False, "right": False}


def test_base_without_cliff_sensors_and_world_without_drops_see_none(room: WorldModel, stage: Base) -> None:
    assert not Simulation(room, stage).senses[0].each.keys() & {"cliffs"}
    assert Simulation(room, replace(stage, cliffs=CLIFFS)).senses[0].find(CliffSense).seen() == {
        "left": False,
        "right": False,
    }
