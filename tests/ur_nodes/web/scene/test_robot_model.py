"""Shapes of a robot's description, and the files of its meshes."""

from pathlib import Path

import pytest

from ur_nodes.web.scene.robot_model import BadModelError, find_mesh, package_of, read_model

URDF = """<robot name="r"><material name="red"><color rgba="1 0 0 1"/></material>
<link name="a"><visual><origin xyz="0 0 1"/><geometry><box size="1 2 3"/></geometry><material name="red"/></visual>
<visual><geometry><mesh filename="package://demo/meshes/a.stl" scale="1 1 2"/></geometry></visual>
<visual><geometry><mesh filename="file:///etc/passwd"/></geometry></visual>
<visual><geometry><cylinder radius="nan" length="1"/></geometry></visual>
<visual><geometry><sphere/></geometry></visual></link></robot>"""


def test_shapes_are_read_and_what_is_malformed_is_left_out() -> None:
    box, mesh = read_model(URDF)
    pose = {"xyz": [0.0, 0.0, 1.0], "rpy": [0.0, 0.0, 0.0]}
    assert box == {"link": "a", "kind": "box", "size": [1.0, 2.0, 3.0], **pose, "rgba": [1.0, 0.0, 0.0, 1.0]}
    assert (mesh["kind"], mesh["mesh"], mesh["size"]) == ("mesh", "package://demo/meshes/a.stl", [1.0, 1.0, 2.0])


@pytest.mark.parametrize(
    "text",
    ["", "<robot>", "x" * 3_000_000, '<!DOCTYPE r [<!ENTITY a "b">]><robot>&a;</robot>', "<a>" * 500 + "</a>" * 500],
)
def test_text_that_is_no_description_is_refused(text: str) -> None:
    with pytest.raises(BadModelError):
        read_model(text)


def test_shapes_are_bounded_in_number() -> None:
    visual = "<visual><geometry><sphere radius='1'/></geometry></visual>"
    assert len(read_model(f"<robot><link name='a'>{visual * 1000}</link></robot>")) == 400


def test_mesh_is_a_file_of_its_package_alone(tmp_path: Path) -> None:
    package = tmp_path / "demo"
    (package / "meshes").mkdir(parents=True)
    (package / "meshes" / "a.stl").write_text("solid")
    (tmp_path / "secret.stl").write_text("secret")
    (package / "link.stl").symlink_to(tmp_path / "secret.stl")
    assert find_mesh("package://demo/meshes/a.stl", str(package)) == package / "meshes" / "a.stl"
    for name in ("../secret.stl", "link.stl", "meshes/../../secret.stl", "meshes/a.yaml", "\x00.stl"):
        assert find_mesh(f"package://demo/{name}", str(package)) is None, name
    assert package_of("package://demo/a.stl") == "demo"
    assert package_of("file:///demo/a.stl") == ""
