from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.ros_session import RosSession
from tests.ur_nodes.simulator.renderer import needs_renderer

from ur.worlds.world_file import read_world
from ur_nodes.vision.fiducial_map import read_map, write_map

ROOT = Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "ubiquity_launches"
WORLD = PACKAGE / "n_simulator" / "worlds" / "office.yaml"
CAMERA = ("camera/compressed:=raspicam_node/image/compressed", "camera_info:=raspicam_node/camera_info")

pytestmark = [pytest.mark.ros, pytest.mark.timeout(400)]


class Ros(RosSession):
    """Nodes of ours, and one who looks."""

    def node(self, folder: str, name: str, *parameters: str) -> subprocess.Popen[str]:
        return self.start(str(PACKAGE / folder / "bin" / name), *parameters)

    def simulate(self) -> None:
        size = ("_camera_width:=480", "_camera_height:=360", "_camera_rate:=8.0")
        self.node("n_simulator", "simulator", "_base:=magni", f"_world_file:={WORLD}", *size)

    def watch(self, *arguments: str) -> dict[str, Any]:
        client = self.start(sys.executable, str(Path(__file__).with_name("client_node.py")), *arguments)
        out, errors = client.communicate(timeout=200)
        assert client.returncode == 0, errors
        answer: dict[str, Any] = json.loads(out)
        assert answer["complete"], f"only {sorted(answer)} came"
        return answer


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[Ros]:
    started = Ros(tmp_path)
    yield started
    started.close()


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros]:
    """One master for nodes that end at once; each has a name, and so parameters, of its own."""
    started = Ros(tmp_path_factory.mktemp("ros"))
    yield started
    started.close()


def test_fiducials_are_seen_mapped_and_saved_and_tell_the_place_again(ros: Ros, tmp_path: Path) -> None:
    needs_renderer()
    ros.simulate()
    ros.node("n_fiducial_detect", "aruco_detect", "_fiducial_len:=0.3", *CAMERA)
    path = tmp_path / "maps" / "map.txt"
    mapper = ros.node(
        *("n_fiducial_slam", "fiducial_slam", "_fiducial_len:=0.3", f"_map_file:={path}"),
        *("_initial_pose_x:=0.0", "camera_info:=raspicam_node/camera_info"),
    )
    topics = "tf,fiducials,fiducial_map,fiducial_pose,fiducial_transforms,fiducial_images"
    seen = ros.watch(topics, "save")
    assert seen["frame"] == "raspicam"
    assert all(error < 1.0 for _, error in seen["fiducial_transforms"])
    assert seen["fiducial_images"] == [480, 360]
    assert seen["tf"][0] == "map"
    assert abs(seen["tf"][1]) < 0.05  # the robot has not moved
    assert seen["saved"] == f"{len(seen['fiducial_map'])} fiducials written to {path}"
    truth = {each.id: each.pose[:3] for each in read_world(WORLD).fiducials}
    entries = read_map(path)
    for entry in entries:
        assert np.linalg.norm(entry.pose[:3, 3] - truth[entry.id]) < 0.25
    mapper.terminate()
    mapper.communicate(timeout=90)

    # The same map a metre further on: so is the robot.
    for entry in entries:
        entry.pose[0, 3] += 1.0
    write_map(path, entries)
    before = path.read_text()
    slam = ("_fiducial_len:=0.3", f"_map_file:={path}", "_read_only_map:=true")
    ros.node("n_fiducial_slam", "fiducial_slam", *slam, "camera_info:=raspicam_node/camera_info")
    ros.watch("tf,fiducial_pose,fiducials")
    found = ros.watch("tf,fiducial_pose", "relocalise")  # forgotten, and found again by what is seen
    assert found["fiducial_pose"][0] == pytest.approx(1.0, abs=0.1)
    assert found["fiducial_pose"][2] > 0.0
    assert path.read_text() == before


def test_localising_without_a_map_is_refused(shared: Ros, tmp_path: Path) -> None:
    node = shared.node(
        "n_fiducial_slam", "fiducial_slam", "_read_only_map:=true", f"_map_file:={tmp_path / 'none.txt'}"
    )
    _, errors = node.communicate(timeout=90)
    assert node.returncode == 2
    assert "none.txt" in errors
    assert "expected a map of fiducials" in errors
    assert "Traceback" not in errors


@pytest.mark.parametrize(
    ("parameter", "message"),
    [
        ("_dictionary:=99", "dictionary: 99, expected a number from 0 to"),
        ("_dictionary:=5X5_100O", "did you mean"),
        ("_image_transport:=theora", "expected one of compressed, raw"),
    ],
)
def test_detection_refuses_parameters_that_cannot_be(shared: Ros, parameter: str, message: str) -> None:
    name = parameter.strip("_").partition(":=")[0] + str(len(shared.running))
    node = shared.node("n_fiducial_detect", "aruco_detect", f"__name:={name}", parameter)
    _, errors = node.communicate(timeout=90)
    assert node.returncode == 2
    assert message in errors
    assert "Traceback" not in errors
