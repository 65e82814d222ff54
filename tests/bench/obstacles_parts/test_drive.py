import numpy as np
import pytest
from bench.obstacles_parts.drive import Drive
from bench.obstacles_parts.scenes import make_scene

from ur.robot.base import load_base
from ur.source.project import launch_library
from ur_nodes.motion.mux_events import Velocity


def test_obstacle_stop_of_a_drive_knows_how_the_robot_moves() -> None:
    world = make_scene("wall", np.random.default_rng(1))
    drive = Drive(load_base(launch_library(), "magni"), world, lambda _now, _pose: Velocity(0.4, 0.5))
    drive.run(2.0)
    newest = drive.sight.track.readings[-1]
    assert newest.at == pytest.approx(drive.simulation.time, abs=0.1)
    assert newest.pose.x > 0.3
    assert newest.forward == pytest.approx(0.4, abs=0.1)
    assert newest.turn == pytest.approx(0.5, abs=0.2)
