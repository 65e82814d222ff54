import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros_session import RosSession

ROOT = Path(__file__).parents[3]
PACKAGE = ROOT / "ubiquity_launches"
MAP_SERVER = PACKAGE / "n_map_server" / "bin" / "map_server"
AMCL = PACKAGE / "n_amcl" / "bin" / "amcl"
MAZE = PACKAGE / "n_map_server" / "maps" / "maze.yaml"
PARAMETERS = ("_base_frame_id:=base_footprint", "_update_min_d:=0.05", "_update_min_a:=0.05", "_resample_interval:=1",
              "_min_particles:=200", "_max_particles:=20000", "_kld_err:=0.05", "_kld_z:=2.33",
              "_odom_model_type:=diff-corrected", "_odom_alpha1:=0.02", "_odom_alpha2:=0.02", "_odom_alpha3:=0.02",
              "_odom_alpha4:=0.02", "_laser_max_beams:=60", "_laser_sigma_hit:=0.1", "_laser_z_rand:=0.1",
              "_save_pose_rate:=1000.0", "_initial_cov_xx:=0.04", "_initial_cov_yy:=0.04")  # fmt: skip


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[RosSession]:
    client = (sys.executable, "-m", "tests.ur_nodes.localisation.localisation_client_node", str(MAZE))
    session = RosSession(tmp_path, client)
    yield session
    session.close()


@pytest.mark.ros
def test_map_server_offers_the_map_on_topics_and_as_a_service(ros: RosSession) -> None:
    ros.start(str(MAP_SERVER), str(MAZE), "_frame_id:=floor")
    answer = ros.ask("map")
    first = answer["maps"][0]
    assert first[:3] == [420, 320, "floor"]
    assert first[3] > 0
    assert answer["maps"] == [first, first, first]
    assert answer["meta"] == [420, 320, 0.05]


@pytest.mark.ros
def test_amcl_speaks_with_the_rest_of_ros_as_upstream_does(ros: RosSession) -> None:
    ros.start(str(MAP_SERVER), str(MAZE))
    ros.start(str(AMCL), "__name:=amcl", *PARAMETERS)
    assert max(ros.ask("drive", steps=5, distance=0.04, turn=0.02)) < 0.1
    frame, x, y, variance = ros.ask("pose")
    assert frame == "map"
    assert 0.1 < x < 0.3
    assert abs(y) < 0.1
    assert 0.0 < variance < 0.05
    assert ros.ask("cloud") >= 200
    ros.ask("search")
    ros.ask("initialpose", x=x, y=y, yaw=0.1)
    assert max(ros.ask("drive", steps=5, distance=0.04, turn=0.0)[-3:]) < 0.05


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "no argument, expected one map file"),
        (("one.yaml", "0.05"), "2 arguments, expected one map file"),
        (("none.yaml",), "none.yaml: no such file or directory, expected a map file"),
    ],
)
def test_map_server_without_a_usable_map_ends_with_one_line(arguments: tuple[str, ...], words: str) -> None:
    done = subprocess.run([str(MAP_SERVER), *arguments], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
