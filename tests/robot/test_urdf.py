from __future__ import annotations

import importlib.util
import subprocess
from pathlib import Path
from xml.etree import ElementTree as Xml  # our own output, read back

import pytest

from ur.robot.base import load_base
from ur.robot.urdf import write_urdf

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "ubiquity_launches"
FOLDER = PACKAGE / "n_robot_state_publisher" / "urdf"


def make_urdfs() -> dict[str, str]:
    spec = importlib.util.spec_from_file_location("make_urdf", ROOT / "tools" / "make_urdf.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    made: dict[str, str] = module.make_urdfs(PACKAGE)
    return made


def test_committed_urdfs_are_those_the_bases_give() -> None:
    assert make_urdfs() == {path.name: path.read_text(encoding="utf-8") for path in FOLDER.iterdir()}


@pytest.mark.parametrize("path", sorted(FOLDER.iterdir()), ids=lambda path: path.name)
def test_urdf_passes_check_urdf(path: Path) -> None:
    done = subprocess.run(["check_urdf", path], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "root Link: base_footprint" in done.stdout


def test_lidar_frame_is_where_the_base_file_says() -> None:
    base = load_base(PACKAGE, "magni", "lidar")
    assert base.lidar
    tree = Xml.fromstring(write_urdf(base))
    heights = {
        joint.find("child").get("link"): [float(v) for v in joint.find("origin").get("xyz").split()]  # type: ignore[union-attr]  # a URDF joint has both
        for joint in tree.iter("joint")
    }
    laser = [a + b for a, b in zip(heights["base_link"], heights["laser"], strict=True)]
    assert laser == pytest.approx(base.lidar.pose[:3])


def test_optical_frame_of_a_camera_looks_along_its_body() -> None:
    base = load_base(PACKAGE, "magni")
    assert base.raspicam
    joints = {joint.find("child").get("link"): joint for joint in Xml.fromstring(write_urdf(base)).iter("joint")}  # type: ignore[union-attr]  # a URDF joint has both
    origin = joints["raspicam_body"].find("origin")
    assert origin is not None
    assert [float(v) for v in origin.get("rpy", "").split()] == pytest.approx(base.raspicam.pose[3:])
    optical = joints["raspicam"].find("origin")
    assert optical is not None
    assert optical.get("rpy") == "-1.570796 0 -1.570796"
