"""Robot descriptions: URDF with its meshes, and xacro. Meshes are also pipes, devices, folders and of huge sizes."""

import os
from contextlib import suppress
from pathlib import Path

from tests.fuzz.target import Target
from tests.robot.description.urdfs import MESHES, SMALL

from ur.robot.description.base_text import write_base_file
from ur.robot.description.expansion.xacro import ExpansionComputer
from ur.robot.description.meshes import load_description
from ur.robot.description.reading import read_base_figures
from ur.robot.description.surroundings import find_surroundings
from ur.source.diagnostic import UserError

_CUT = b"\n====\n"  # between a description and its mesh
_HUGE = 1 << 40
_XML = (
    *(b"<robot>", b"</robot>", b'<link name="a">', b"</link>", b"<visual>", b"<collision>", b"<geometry>", b"<gazebo>"),
    *(b'<joint name="a" type="continuous">', b'<parent link="a"/>', b'<child link="b"/>', b'<origin xyz="1e9 0 0"/>'),
    *(b'<mesh filename="a.stl"/>', b'<mesh filename="package://a/a.dae"/>', b'<mesh filename="file:///dev/zero.stl"/>'),
    *(b"<!DOCTYPE a [<!ENTITY b 'c'>]>", b"&b;", b"<!--", b"-->", b"<![CDATA[", b"<a>" * 2000, b"<a/>" * 20_000),
    *(
        b"vertex 1 2 3\n",
        b"v 1 2 3\n",
        b'<node id="a"><instance_node url="#a"/></node>',
        b"0 " * 3000,
        b"nan",
        b"1e308",
    ),
)
_XACRO = (
    *(b'<xacro:include filename="a.xacro"/>', b'<xacro:include filename="/etc/*"/>', b"$(find a)", b"$(env HOME)"),
    *(b'<xacro:macro name="m" params="a *b **c d:=1 e:=^">', b"</xacro:macro>", b"<xacro:m/>", b"$(eval 1 + 1)", b"$$"),
    *(b'<xacro:property name="p" value="${p}"/>', b"${'a' * 10 ** 9}", b"${xacro.load_yaml('a.yaml')}", b"${1 / 0}"),
    *(b"${(lambda: 1)()}", b"${[n for n in range(99)]}", b"<xacro:if value='1'>", b"<xacro:insert_block name='b'/>"),
)


def _read_urdf(data: bytes, folder: Path) -> None:
    text, _, mesh = data.partition(_CUT)
    (folder / "a.urdf").write_bytes(text)
    for name in ("a.stl", "a.obj", "a.dae"):
        _make_mesh(folder / name, mesh)
    _load(folder / "a.urdf")


def _make_mesh(path: Path, content: bytes) -> None:
    match content:
        case b"pipe":
            os.mkfifo(path)
        case b"zero":
            path.symlink_to("/dev/zero")
        case b"folder":
            path.mkdir()
        case b"loop":
            path.symlink_to(path)
        case b"huge":
            with path.open("wb") as file:
                file.truncate(_HUGE)
        case _:
            path.write_bytes(content)


def _read_xacro(data: bytes, folder: Path) -> None:
    (folder / "a.xacro").write_bytes(data)
    os.mkfifo(folder / "b.xacro")
    (folder / "a.yaml").write_bytes(b"a: {b: [1, 2]}\n")
    _load(folder / "a.xacro")


def _load(path: Path) -> None:
    environment = {"HOME": "/nonexistent", "PATH": ""}
    computer = ExpansionComputer(environment, dict, Path("/nonexistent"), lambda _: False)
    with suppress(UserError):
        loaded = load_description(path, find_surroundings(path, environment), computer)
        reading = read_base_figures(loaded.description, {}, lidar=True)
        if not reading.open:
            write_base_file(reading, "A robot.", path.name)


def _make_urdf() -> list[bytes]:
    texts = [text.replace("package://small/", "").encode() for text in (SMALL, MESHES)]
    meshes = (b"pipe", b"zero", b"folder", b"loop", b"huge", b"v 0 0 0\nv 1 1 1\n", b"vertex 0 0 0\nvertex 1 1 1\n")
    return [text + _CUT + mesh for text in texts for mesh in meshes]


def _make_xacro() -> list[bytes]:
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    body = '<xacro:property name="w" value="0.3"/><xacro:macro name="m" params="a"><link name="${a}"/></xacro:macro>'
    calls = '<xacro:m a="b"/><xacro:if value="${w > 1}"><xacro:include filename="b.xacro"/></xacro:if>'
    return [f"{head}{body}{calls}</robot>".encode()]


TARGETS = (
    Target("urdf", _read_urdf, _XML, _make_urdf),
    Target("xacro", _read_xacro, (*_XACRO, *_XML), _make_xacro),
)
