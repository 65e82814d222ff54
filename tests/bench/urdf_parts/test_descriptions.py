from pathlib import Path

import pytest
from bench.urdf_parts.descriptions import find_robots, list_roots
from tests.robot.description.urdfs import MESHES

PART = '<robot name="part"><link name="camera_link"/></robot>'


def write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def test_files_that_others_include_are_parts(tmp_path: Path) -> None:
    include = '<robot xmlns:xacro="x"><xacro:include filename="{}"/></robot>'
    write(tmp_path / "a/urdf/rover.urdf.xacro", include.format("$(find a)/urdf/wheels.xacro"))
    write(tmp_path / "a/urdf/wheels.xacro", include.format("material.xacro"))
    write(tmp_path / "a/urdf/material.xacro", PART)
    write(tmp_path / "b/urdf/wheels.xacro", include.format("../../c/tyre.xacro"))
    write(tmp_path / "c/tyre.xacro", PART)
    write(tmp_path / "c/model.urdf", "<sdf/>")
    assert list_roots(tmp_path / "a") == (tmp_path / "a/urdf/rover.urdf.xacro",)
    assert tmp_path / "c/tyre.xacro" not in list_roots(tmp_path)


def test_robots_of_a_checkout_are_those_with_driven_wheels(tmp_path: Path) -> None:
    write(tmp_path / "rover/urdf/rover.urdf", MESHES)
    write(tmp_path / "rover/urdf/camera.urdf", PART)
    write(tmp_path / "arm/arm.urdf", PART)
    write(tmp_path / ".git/rover.urdf", MESHES)
    robots = {robot.name: robot.path.relative_to(tmp_path).as_posix() for robot in find_robots(tmp_path)}
    assert robots == {"rover": "rover/urdf/rover.urdf", "arm": "arm/arm.urdf"}, "one robot for each checkout, at least"


def test_every_robot_has_a_name_of_its_own_that_no_base_of_the_library_has(tmp_path: Path) -> None:
    for path in ("magni.urdf", "x-1/Rover v2.urdf", "x-2/rover_v2.urdf", "3d.urdf"):
        write(tmp_path / path, MESHES)
    names = [robot.name for robot in find_robots(tmp_path)]
    assert len(set(names)) == 4
    assert "magni" not in names
    assert {"robot_3d", "rover_v2", "x_2_rover_v2"} <= set(names)


@pytest.mark.parametrize("text", ["<robot><link", "<robot name='x'>"])
def test_file_that_cannot_be_read_is_listed_with_the_reason(tmp_path: Path, text: str) -> None:
    write(tmp_path / "broken.urdf", text)
    (robot,) = find_robots(tmp_path)
    assert robot.description is None
    assert "broken.urdf" in robot.problem
