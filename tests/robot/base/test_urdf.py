import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree as Xml  # our own output, read back

import pytest

from ur.robot.base import list_bases, list_variants, load_base
from ur.robot.base.urdf import write_urdf

ROOT = Path(__file__).parents[3]
PACKAGE = ROOT / "ubiquity_launches"
FOLDER = PACKAGE / "n_robot_state_publisher"
MESH = "package://p/body.stl"
EVERY = [(name, variant) for name in list_bases(PACKAGE) for variant in ("", *list_variants(PACKAGE, name))]


def load_tool() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_urdf", ROOT / "tools" / "make_urdf.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_committed_urdfs_and_meshes_are_those_the_bases_give() -> None:
    tool = load_tool()
    made: dict[str, bytes] = tool.make_urdfs(PACKAGE)
    assert tool.list_urdfs(PACKAGE) == set(made)
    for path, content in made.items():
        assert (PACKAGE / path).read_bytes() == content, f"{path}: out of date, run tools/make_urdf.py"


def test_tool_serves_another_package_and_takes_old_files_away(tmp_path: Path) -> None:
    package = tmp_path / "robots"
    shutil.copytree(PACKAGE / "bases" / "botvac", package / "bases" / "mine")
    (package / "package.xml").write_text("<package><name>my_robots</name></package>")
    old = package / "n_robot_state_publisher" / "urdf" / "gone.urdf"
    old.parent.mkdir(parents=True)
    old.write_text("")
    done = run_tool(package)
    assert (done.returncode, done.stderr) == (0, "")
    assert not old.exists()
    meshes = sorted(path.name for path in (old.parents[1] / "meshes").iterdir())
    assert meshes == ["mine.stl", "mine.xv11.stl"]  # botvac50 has the body of the plain base
    text = (old.parent / "mine.botvac50.urdf").read_text()
    assert "package://my_robots/n_robot_state_publisher/meshes/mine.stl" in text


def test_tool_serves_a_workspace_that_adds_bases_to_a_package(tmp_path: Path) -> None:
    added = tmp_path / "share" / "ubiquity_launches"
    shutil.copytree(PACKAGE / "bases" / "stage", added / "bases" / "mine")
    assert run_tool(added).returncode == 1
    (tmp_path / ".catkin").touch()
    done = run_tool(added)
    assert (done.returncode, done.stderr) == (0, "")
    text = (added / "n_robot_state_publisher" / "urdf" / "mine.urdf").read_text()
    (mesh,) = {shape.get("filename", "") for shape in Xml.fromstring(text).iter("mesh")}
    assert mesh.startswith("file:///")
    assert Path(mesh.removeprefix("file://")).is_file()


def test_tool_says_what_is_wrong_with_a_package_or_a_base(tmp_path: Path) -> None:
    done = run_tool(tmp_path)
    assert done.returncode == 1
    assert "package.xml: no name of a package, expected a launch package" in done.stderr
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    (tmp_path / "bases" / "bad").mkdir(parents=True)
    (tmp_path / "bases" / "bad" / "base.yaml").write_text("summary: 3\n")
    done = run_tool(tmp_path)
    assert done.returncode == 1
    assert "bases/bad/base.yaml:1:1: error: footprint is missing" in done.stderr


def run_tool(package: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "tools" / "make_urdf.py"), str(package)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("path", sorted((FOLDER / "urdf").iterdir()), ids=lambda path: path.name)
def test_urdf_passes_check_urdf(path: Path) -> None:
    if not shutil.which("check_urdf"):
        pytest.skip("check_urdf is not installed: apt-get install liburdfdom-tools")
    done = subprocess.run(["check_urdf", path], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "root Link: base_footprint" in done.stdout


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_frames_of_a_base_are_one_tree_below_base_footprint(name: str, variant: str) -> None:
    base = load_base(PACKAGE, name, variant)
    text = write_urdf(base, MESH)
    links = [link.get("name", "") for link in Xml.fromstring(text).iter("link")]
    parents = {child: joint.find("parent").get("link", "") for child, joint in find_joints(text).items()}  # type: ignore[union-attr]  # a URDF joint has one
    assert len(set(links)) == len(links)
    assert set(parents) == set(links) - {"base_footprint"}
    assert parents["base_link"] == "base_footprint"
    wanted = {base.lidar.frame if base.lidar else None, base.raspicam.frame if base.raspicam else None}
    wanted |= {base.imu.frame if base.imu else None} | {
        sonar.frame for sonar in (base.sonars.at if base.sonars else ())
    }
    assert wanted - {None} <= set(links)
    for link in links:
        while link != "base_footprint":
            link = parents[link]


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_masses_of_a_urdf_add_up_to_that_of_the_base(name: str, variant: str) -> None:
    base = load_base(PACKAGE, name, variant)
    masses = [float(mass.get("value", "")) for mass in Xml.fromstring(write_urdf(base, MESH)).iter("mass")]
    assert sum(masses) == pytest.approx(base.mass)


def find_joints(text: str) -> dict[str, Xml.Element]:
    """The joint above each link."""
    joints = {}
    for joint in Xml.fromstring(text).iter("joint"):
        child = joint.find("child")
        assert child is not None
        joints[child.get("link", "")] = joint
    return joints


def read_origin(joint: Xml.Element) -> list[float]:
    """x, y, z, roll, pitch, yaw."""
    origin = joint.find("origin")
    assert origin is not None
    return [float(value) for key in ("xyz", "rpy") for value in origin.get(key, "0 0 0").split()]


def test_every_sonar_is_where_the_base_file_says() -> None:
    base = load_base(PACKAGE, "loki")
    assert base.sonars
    joints = find_joints(write_urdf(base, MESH))
    for sonar in base.sonars.at:
        found = read_origin(joints[sonar.frame])
        found[2] += base.wheels.radius
        assert found == pytest.approx(sonar.pose)


def test_lidar_frame_is_where_the_base_file_says() -> None:
    base = load_base(PACKAGE, "magni", "lidar")
    assert base.lidar
    joints = find_joints(write_urdf(base, MESH))
    laser = [a + b for a, b in zip(read_origin(joints["base_link"]), read_origin(joints["laser"]), strict=True)]
    assert laser == pytest.approx(base.lidar.pose)


def test_optical_frame_of_a_camera_looks_along_its_body() -> None:
    base = load_base(PACKAGE, "magni")
    assert base.raspicam
    joints = find_joints(write_urdf(base, MESH))
    assert read_origin(joints["raspicam_body"])[3:] == pytest.approx(base.raspicam.pose[3:])
    assert read_origin(joints["raspicam"])[3:] == [-1.570796, 0.0, -1.570796]
