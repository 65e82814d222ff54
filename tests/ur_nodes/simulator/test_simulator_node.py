from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import psutil
import pytest
from tests.ros_session import RosSession

HERE = Path(__file__).parent
ROOT = HERE.parents[2]
WORLDS = ROOT / "ubiquity_launches" / "n_simulator" / "worlds"
SIMULATOR = ROOT / "ubiquity_launches" / "n_simulator" / "bin" / "simulator"

pytestmark = pytest.mark.ros


class Ros(RosSession):
    """A client, and simulators."""

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, (sys.executable, str(HERE / "client_node.py")))

    def simulate(self, *parameters: str) -> subprocess.Popen[str]:
        return self.start(str(SIMULATOR), "__name:=simulator", *parameters)


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[Ros]:
    started = Ros(tmp_path)
    yield started
    started.close()


def test_node_publishes_what_stage_ros_does_at_the_rates_of_the_base(ros: Ros) -> None:
    ros.simulate()
    ros.ask("listen", topics=["odom", "scan", "tf", "joint_states", "base_pose_ground_truth"])
    scans = ros.ask("collect", topic="scan", count=12, seconds=60)
    gaps = [b["stamp"] - a["stamp"] for a, b in pairwise(scans)]
    assert sorted(gaps)[len(gaps) // 2] == pytest.approx(0.1, abs=0.01)
    assert abs(scans[-1]["stamp"] - time.time()) < 10.0  # wall time
    assert scans[0]["frame"] == "laser"
    assert len(scans[0]["ranges"]) == 360
    odometry = ros.ask("past", topic="odom")
    gaps = [b["stamp"] - a["stamp"] for a, b in pairwise(odometry)]
    assert sorted(gaps)[len(gaps) // 2] == pytest.approx(1 / 30, abs=0.006)
    assert (odometry[0]["frame"], odometry[0]["child"]) == ("odom", "base_footprint")
    assert len(odometry[0]["covariance"]) == 36
    joints = ros.ask("past", topic="joint_states")
    assert joints[0]["names"] == ["left_wheel_joint", "right_wheel_joint"]
    assert ros.ask("past", topic="base_pose_ground_truth")[0]["frame"] == "map"
    transforms = ros.ask("past", topic="tf")
    assert transforms[0]["frames"] == ["odom", "base_footprint"]
    known = {each["stamp"] for each in transforms}
    assert all(scan["stamp"] in known for scan in scans)  # nobody has to wait for the transform of a scan


def test_node_drives_and_stops_when_commands_cease(ros: Ros) -> None:
    ros.simulate()
    ros.ask("listen", topics=["odom", "base_pose_ground_truth"])
    ros.ask("collect", topic="base_pose_ground_truth", count=1, seconds=60)
    ros.ask("command", linear=0.4, angular=0.0, times=20)
    assert max(truth["v"] for truth in ros.ask("past", topic="base_pose_ground_truth")) > 0.1
    end = time.monotonic() + 60.0
    while abs((after := ros.ask("collect", topic="base_pose_ground_truth", count=5, seconds=60)[-1])["v"]) > 0.001:
        assert time.monotonic() < end, "it drives on without commands"
    assert 0.2 < after["x"] < 0.9
    assert ros.ask("collect", topic="odom", count=1, seconds=60)[-1]["x"] == pytest.approx(after["x"], abs=0.05)


def test_node_goes_step_by_step_and_repeats_itself_after_a_reset(ros: Ros) -> None:
    ros.simulate("_speed:=0", "_seed:=4")
    ros.ask("listen", topics=["odom", "scan"])
    assert ros.ask("call", service="step")[0] is False  # not paused
    ros.ask("call", service="pause", data=True)
    runs = []
    for _ in range(2):
        before = simulated_time(ros.ask("call", service="step")[1])
        ros.ask("call", service="reset")
        for number in range(1, 6):
            after = simulated_time(ros.ask("call", service="step")[1])
            scans = ros.ask("since", topic="scan", stamp=before, count=number)
        assert after - before == pytest.approx(0.5)
        runs.append([scan["ranges"] for scan in scans])
    assert runs[0] == runs[1]
    assert runs[0][0] != runs[0][1]


def simulated_time(message: str) -> float:
    assert message.startswith("simulated time ")
    return float(message.split()[2])


def test_node_places_robot_and_obstacles_and_counts_collisions(ros: Ros) -> None:
    ros.simulate()
    ros.ask("listen", topics=["base_pose_ground_truth", "scan", "simulator/collisions"])
    assert ros.ask("call", service="place", x=2.0, y=0.0) is True
    # A message that was under way may still tell the old place.
    assert ros.ask("collect", topic="base_pose_ground_truth", count=3, seconds=60)[-1]["x"] == pytest.approx(2.0)
    assert ros.ask("call", service="place", name="obstacle_1", x=3.0, y=0.0) is True
    ahead = ros.ask("collect", topic="scan", count=2, seconds=60)[-1]["ranges"][180]
    assert float(ahead) == pytest.approx(3.0 - 0.15 - 2.1, abs=0.06)
    mistakes: list[tuple[dict[str, Any], str]] = [
        ({"x": -0.6, "y": 0.0}, "robot_0 cannot be at x -0.6, y 0: a wall, expected free floor"),
        ({"x": 3.0, "y": 0.0}, "robot_0 cannot be at x 3, y 0: obstacle_1"),
        ({"x": 1.0, "y": 0.0, "name": "obstakle_1"}, "expected one of robot_0, obstacle_1"),
        ({"x": 1.0, "y": 0.0, "frame": "odom"}, "a pose in frame 'odom', expected 'map'"),
    ]
    for values, message in mistakes:
        assert message in ros.try_to("call", service="place", **values)["error"]
    assert ros.ask("past", topic="simulator/collisions", count=1) == [{"count": 0}]
    ros.ask("drive_until", topic="simulator/collisions", count=2, linear=0.5, seconds=60)
    assert ros.ask("past", topic="simulator/collisions", count=2)[1] == {"count": 1}


def test_node_at_another_speed_is_the_clock(ros: Ros) -> None:
    ros.simulate("_speed:=5.0")
    ros.ask("listen", topics=["clock", "scan"])
    # The two connections need not carry messages from the same moment on.
    first = ros.ask("past", topic="clock", count=1)[0]["stamp"]
    scans = ros.ask("since", topic="scan", stamp=first, count=30)[:30]
    assert scans[-1]["stamp"] - scans[0]["stamp"] == pytest.approx(2.9, abs=0.001)
    ros.ask("since", topic="clock", stamp=scans[-1]["stamp"], count=1)  # it may come after the scan
    assert {scan["stamp"] for scan in scans} <= {each["stamp"] for each in ros.ask("past", topic="clock")}


def test_node_gives_several_robots_names_of_their_own(ros: Ros) -> None:
    ros.simulate("_robots:=2", f"_world_file:={WORLDS / 'office.yaml'}")
    ros.ask("listen", topics=["robot_1/odom", "robot_1/scan", "robot_1/base_pose_ground_truth"])
    odometry = ros.ask("collect", topic="robot_1/odom", count=1, seconds=60)[0]
    assert (odometry["frame"], odometry["child"]) == ("robot_1/odom", "robot_1/base_footprint")
    assert ros.ask("collect", topic="robot_1/scan", count=1, seconds=60)[0]["frame"] == "robot_1/laser"
    ros.ask("command", linear=0.5, angular=0.0, times=15, topic="robot_1/cmd_vel")
    assert max(truth["v"] for truth in ros.ask("past", topic="robot_1/base_pose_ground_truth")) > 0.1


@pytest.mark.parametrize(
    ("parameter", "message"),
    [
        ("_base:=stagge", "unknown base 'stagge'"),
        ("_world_file:=/nowhere/maze.yaml", "/nowhere/maze.yaml: no such file or directory"),
        ("_world_file:=BROKEN", "broken.yaml:3:1: error: not valid YAML"),
        ("_speed:=fast", "parameter /simulator/speed: 'fast', expected a number"),
        ("_x:=-0.6", "robot_0 cannot be at x -0.6, y 0: a wall"),
    ],
)
def test_node_refuses_what_it_cannot_use_in_one_clear_message(
    ros: Ros, tmp_path: Path, parameter: str, message: str
) -> None:
    (tmp_path / "broken.yaml").write_text("floor_plan: x.yaml\nboxes: [\n")
    node = ros.simulate(parameter.replace("BROKEN", str(tmp_path / "broken.yaml")))
    _, errors = node.communicate(timeout=60)
    assert node.returncode == 2
    assert message in errors
    assert "Traceback" not in errors


def test_node_ends_when_told_to_even_at_full_speed(ros: Ros) -> None:
    node = ros.simulate("_speed:=0")
    ros.ask("listen", topics=["odom"])
    ros.ask("collect", topic="odom", count=1, seconds=60)
    node.terminate()
    _, errors = node.communicate(timeout=60)
    assert "Traceback" not in errors


def test_camera_publishes_as_raspicam_node_while_somebody_looks(ros: Ros) -> None:
    from tests.ur_nodes.simulator.renderer import needs_renderer

    needs_renderer()
    process = ros.simulate("_base:=magni", "_camera_width:=160", "_camera_height:=120", "_camera_rate:=5.0")
    ros.ask("listen", topics=["odom"])
    ros.ask("collect", topic="odom", count=1, seconds=60)
    assert not psutil.Process(process.pid).children()  # nobody looks: nothing draws
    topics = ["raspicam_node/image_raw", "raspicam_node/image/compressed", "raspicam_node/camera_info"]
    ros.ask("listen", topics=topics)
    images = ros.ask("collect", topic=topics[0], count=3, seconds=60)
    assert images[0]["size"] == [160, 120, 480, 57600]
    assert images[0]["frame"] == "raspicam"
    assert images[1]["stamp"] - images[0]["stamp"] > 0.15
    jpegs = ros.ask("past", topic=topics[1], count=3)
    assert (jpegs[0]["format"], jpegs[0]["begin"]) == ("jpeg", "ffd8")
    info = ros.ask("past", topic=topics[2], count=3)
    assert info[0]["K"][2] == 79.5
    assert {each["stamp"] for each in images} <= {each["stamp"] for each in info}
    drawing = psutil.Process(process.pid).children()
    assert len(drawing) == 1
    process.kill()
    assert not psutil.wait_procs(drawing, timeout=60)[1], "it draws on without a simulator"


def test_node_refuses_a_camera_rate_that_is_none(ros: Ros) -> None:
    process = ros.simulate("_base:=magni", "_camera_rate:=fast")
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    assert "parameter /simulator/camera_rate: 'fast', expected a number from 0 to 200" in errors
