"""Meshes of a description are measured, in whatever format and place they are; what cannot be read stays a mesh."""

from itertools import product
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.robot.base.body_mesh import write_stl
from ur.robot.description.expansion.xacro import ExpansionComputer
from ur.robot.description.mesh_file import read_mesh
from ur.robot.description.meshes import LoadedDescription, load_description
from ur.robot.description.reading import DescriptionReading, read_base_figures
from ur.robot.description.surroundings import find_surroundings
from ur.robot.description.urdf_parts import Description

CORNERS = [(x, y, z) for x, y, z in product((-0.3, 0.3), (-0.2, 0.2), (0.0, 0.25))]
ROBOT = """<robot name="r">
  <link name="base_link">
    <visual><geometry><mesh filename="{file}" scale="{scale}"/></geometry></visual>
    <inertial><mass value="9"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
  </link>
  <joint name="left" type="continuous">
    <parent link="base_link"/><child link="left_wheel"/><origin xyz="0 0.15 0.05"/><axis xyz="0 1 0"/>
  </joint>
  <link name="left_wheel">{wheel}</link>
  <joint name="right" type="continuous">
    <parent link="base_link"/><child link="right_wheel"/><origin xyz="0 -0.15 0.05"/><axis xyz="0 1 0"/>
  </joint>
  <link name="right_wheel">{wheel}</link>
</robot>
"""
WHEEL = '<visual><origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.05" length="0.02"/></geometry></visual>'
COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="centimetre" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="s"><float_array id="a" count="24">{numbers}</float_array>
      <technique_common><accessor source="#a" count="8" stride="3"/></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
  </mesh></geometry></library_geometries>
  <library_nodes><node id="n"><instance_geometry url="#g"/></node></library_nodes>
  <library_visual_scenes><visual_scene id="scene">
    <node><translate>100 0 0</translate><rotate>0 0 1 90</rotate><scale>1 1 2</scale><instance_node url="#n"/></node>
    {more}
  </visual_scene></library_visual_scenes>
</COLLADA>
"""


def write_collada(path: Path, more: str = "") -> None:
    numbers = " ".join(f"{100.0 * number:g}" for corner in CORNERS for number in corner)
    path.write_text(COLLADA.format(numbers=numbers, more=more), encoding="utf-8")


def write_binary(path: Path) -> None:
    path.write_bytes(write_stl([(CORNERS[n], CORNERS[(n + 3) % 8], CORNERS[(n + 5) % 8]) for n in range(8)]))


def load(folder: Path, file: str, *, scale: str = "1 1 1", wheel: str = WHEEL, **packages: str) -> Description:
    path = folder / "robot.urdf"
    path.write_text(ROBOT.format(file=file, scale=scale, wheel=wheel), encoding="utf-8")
    return load_file(path, packages).description


def load_file(path: Path, packages: dict[str, str]) -> LoadedDescription:
    computer = ExpansionComputer({}, lambda: packages, Path("/nonexistent"), lambda _: False)
    return load_description(path, find_surroundings(path, {}), computer)


def read(folder: Path, file: str, *, scale: str = "1 1 1", wheel: str = WHEEL, **packages: str) -> DescriptionReading:
    return read_base_figures(load(folder, file, scale=scale, wheel=wheel, **packages), {})


def size(folder: Path, file: str) -> tuple[float, ...]:
    points = read_mesh(folder / file)
    return tuple((points.max(axis=0) - points.min(axis=0)).tolist())


def test_body_is_as_large_as_its_mesh_and_not_as_its_inertia_says(tmp_path: Path) -> None:
    write_binary(tmp_path / "body.STL")
    found = read(tmp_path, "body.STL")
    assert {key: found.figures[key].value for key in ("length", "width")} == pytest.approx(
        {"length": 0.6, "width": 0.4}
    )
    assert found.figures["height"].value == pytest.approx(0.25)
    assert not any("mesh" in note for note in found.notes)


def test_mesh_is_scaled(tmp_path: Path) -> None:
    write_binary(tmp_path / "body.stl")
    assert read(tmp_path, "body.stl", scale="0.5 1 1").figures["length"].value == pytest.approx(0.3)


def test_mesh_in_text_and_objects_are_read(tmp_path: Path) -> None:
    facets = "".join("  vertex {:e} {:e} {:e}\n".format(*corner) for corner in CORNERS)
    (tmp_path / "text.stl").write_text(f"solid body\n facet normal 0 0 1\n outer loop\n{facets}", encoding="utf-8")
    lines = "".join("v {} {} {}\n".format(*corner) for corner in CORNERS)
    (tmp_path / "body.obj").write_text(f"# body\n{lines}vn 0 0 9\nf 1 2 3\n", encoding="utf-8")
    assert size(tmp_path, "text.stl") == pytest.approx((0.6, 0.4, 0.25))
    assert size(tmp_path, "body.obj") == pytest.approx((0.6, 0.4, 0.25))


def test_collada_scene_is_placed_by_its_nodes_in_its_units(tmp_path: Path) -> None:
    write_collada(tmp_path / "body.dae")
    assert size(tmp_path, "body.dae") == pytest.approx((0.4, 0.6, 0.5))
    assert read_mesh(tmp_path / "body.dae")[:, 0].mean() == pytest.approx(1.0)


def test_collada_nodes_that_name_one_another_have_no_points(tmp_path: Path) -> None:
    loops = '<node id="a"><instance_node url="#b"/><instance_node url="#b"/></node>'
    loops += '<node id="b"><instance_geometry url="#g"/><instance_node url="#a"/><instance_node url="#a"/></node>'
    write_collada(tmp_path / "body.dae", more=loops)
    assert len(read_mesh(tmp_path / "body.dae")) == 0


def test_collada_nodes_that_name_the_next_again_and_again_have_no_points(tmp_path: Path) -> None:
    chain = "".join(f'<node id="n{n}">' + f'<instance_node url="#n{n + 1}"/>' * 20 + "</node>" for n in range(30))
    write_collada(tmp_path / "body.dae", more=f"{chain}<node id='n30'/>")
    assert len(read_mesh(tmp_path / "body.dae")) == 0


@pytest.mark.parametrize(
    "file",
    ["package://bot/meshes/body.stl", "file://{folder}/bot/meshes/body.stl", "bot/meshes/body.stl"],
)
def test_mesh_is_found_in_a_package_a_file_and_beside_the_description(tmp_path: Path, file: str) -> None:
    (tmp_path / "bot/meshes").mkdir(parents=True)
    write_binary(tmp_path / "bot/meshes/body.stl")
    (tmp_path / "urdf").mkdir()
    folder = tmp_path if "://" not in file else tmp_path / "urdf"
    found = read(folder, file.format(folder=tmp_path), **({"bot": f"{tmp_path}/bot"} if "package" in file else {}))
    assert found.figures["length"].value == pytest.approx(0.6)


def test_package_without_a_manifest_is_found_above_the_description(tmp_path: Path) -> None:
    (tmp_path / "bot/meshes").mkdir(parents=True)
    (tmp_path / "bot/urdf").mkdir()
    write_binary(tmp_path / "bot/meshes/body.stl")
    assert read(tmp_path / "bot/urdf", "package://bot/meshes/body.stl").figures["length"].value == pytest.approx(0.6)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"solid nothing",
        b"\0" * 80 + b"\xff\xff\xff\x7f",
        b"vertex 1 2 three",
        b"vertex nan nan nan",
        b"vertex 0 0 0\nvertex 999 0 0",
    ],
    ids=["empty", "no facets", "cut off", "no number", "not finite", "other units"],
)
def test_mesh_that_cannot_be_read_stays_one_and_is_noted(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "body.stl").write_bytes(content)
    assert any("link base_link is a mesh" in note for note in read(tmp_path, "body.stl").notes)


@pytest.mark.parametrize(
    "content",
    [
        "<COLLADA",
        '<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>',
        "<COLLADA/>",
        "<COLLADA><asset><unit meter='x'/></asset></COLLADA>",
        COLLADA.format(numbers="0 " * 24, more="<node><rotate>0 0 1</rotate></node>"),
        COLLADA.format(numbers="0 " * 24, more="<node><matrix>1 2</matrix></node>"),
    ],
)
def test_collada_that_is_none_has_no_points(tmp_path: Path, content: str) -> None:
    (tmp_path / "body.dae").write_text(content, encoding="utf-8")
    assert len(read_mesh(tmp_path / "body.dae")) == 0


@given(content=st.binary(max_size=300), suffix=st.sampled_from([".stl", ".obj", ".dae"]))
def test_any_content_has_points_or_none(tmp_path_factory: pytest.TempPathFactory, content: bytes, suffix: str) -> None:
    file = tmp_path_factory.getbasetemp() / f"body{suffix}"
    file.write_bytes(content)
    assert read_mesh(file).shape[1] == 3


@pytest.mark.parametrize(
    "file", ["gone.stl", "package://gone/body.stl", "package://../body.stl", "robot.urdf", "a://b"]
)
def test_mesh_that_is_not_there_stays_one(tmp_path: Path, file: str) -> None:
    assert [mesh.file for mesh in load(tmp_path, file).links[0].meshes] == [file]


def test_wheel_has_the_size_of_its_mesh_and_stands_where_that_is(tmp_path: Path) -> None:
    round_ = [(0.06 * x, 0.04 + y, 0.06 * z) for x, y, z in product((-1.0, 1.0), (0.0, 0.03), (-1.0, 1.0))]
    lines = "".join("v {} {} {}\n".format(*corner) for corner in round_)
    (tmp_path / "tyre.obj").write_text(lines, encoding="utf-8")
    wheel = '<visual><geometry><mesh filename="tyre.obj"/></geometry></visual>'
    figures = read(tmp_path, "gone.stl", wheel=wheel).figures
    assert figures["wheel_radius"].value == pytest.approx(0.06)
    assert figures["wheel_radius"].source == "mesh of link left_wheel"
    assert figures["wheel_width"].value == pytest.approx(0.03)
    assert figures["wheel_separation"].value == pytest.approx(0.3), "both meshes lie 0.055 m further left"
    flat = "".join(f"v {x} {y} {0.1 * z}\n" for x, y, z in round_)
    (tmp_path / "tyre.obj").write_text(flat, encoding="utf-8")
    assert "wheel_radius" not in read(tmp_path, "other.stl", wheel=wheel.replace("tyre", "gone")).figures
