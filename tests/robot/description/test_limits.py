"""Descriptions and meshes of hostile sizes are refused or measured, within bounds of time and memory."""

import os
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import pytest
from tests.limits import run_limited

from ur.robot.description.mesh_file import read_mesh
from ur.robot.description.parse import parse_urdf
from ur.robot.description.reading import read_base_figures
from ur.source.diagnostic import UserError

MEASURE = """
import sys
from pathlib import Path
from ur.robot.description.mesh_file import read_mesh
points = read_mesh(Path(sys.argv[1]))
print(len(points), *(points.max(axis=0) - points.min(axis=0)).round(3).tolist() if len(points) else ())
"""
MEMORY = 200_000  # kB, with Python and NumPy
SECONDS = 60  # of computing, on a slow computer


def link_chain(count: int, name: str = "l{}", kind: str = "continuous", axis: str = "0 0 1") -> str:
    links = "".join(f'<link name="{name.format(n)}"/>' for n in range(count))
    joints = "".join(
        f'<joint name="j{n}" type="{kind}"><parent link="{name.format(n)}"/><child link="{name.format(n + 1)}"/>'
        f'<axis xyz="{axis}"/></joint>'
        for n in range(count - 1)
    )
    return f"<robot>{links}{joints}</robot>"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (link_chain(20_000), "20,000 elements <link>, expected at most 2,000"),
        ("<robot><link name='a'/>" + "<joint name='j' type='fixed'/>" * 2001 + "</robot>", "<joint>, expected at most"),
        ("<robot><link name='a'/>" + "<gazebo/>" * 4001 + "</robot>", "<gazebo>, expected at most"),
        (
            "<robot><link name='a'>" + "<visual><geometry><sphere radius='1'/></geometry></visual>" * 20_001
            + "</link></robot>",
            "20,001 shapes and meshes, expected at most",
        ),
        ("<robot>" + "<a>" * 300_000 + "</a>" * 300_000 + "</robot>", "nested deeper than"),
        ("<robot>" + "<a/>" * 300_000 + "</robot>", "more than 200,000 elements"),
        ("<robot>" + " " * 5_000_000 + "</robot>", "expected at most 5,000,000"),
        ('<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:arm/></robot>', "uses xacro (<xacro:arm>)"),
    ],
    ids=["links", "joints", "plugins", "shapes", "nesting", "elements", "characters", "xacro"],
)  # fmt: skip
def test_description_of_hostile_size_is_refused(text: str, message: str) -> None:
    with pytest.raises(UserError) as caught:
        parse_urdf(text, "robot.urdf")
    assert message in str(caught.value)


@pytest.mark.parametrize("name", ["l{}", "caster_{}", "wheel_{}", "camera_{}", "sonar_{}", "imu{}", "lidar {}"])
@pytest.mark.parametrize(("kind", "axis"), [("continuous", "0 1 0"), ("continuous", "0 0 1"), ("fixed", "0 0 1")])
def test_work_grows_at_most_with_the_square_of_a_description(name: str, kind: str, axis: str) -> None:
    def count_steps(links: int) -> int:
        description = parse_urdf(link_chain(links, name, kind, axis), "robot.urdf")
        steps = 0

        def step(frame: FrameType, *_: object) -> object:
            nonlocal steps
            if frame.f_globals["__name__"].startswith("slipcover"):  # takes out probes of coverage
                return None
            steps += 1
            return step

        before = sys.gettrace()
        sys.settrace(step)  # type: ignore[arg-type]
        try:
            read_base_figures(description, {})
        finally:
            sys.settrace(before)
        return steps

    assert count_steps(200) < 4.5 * count_steps(100)


def write_obj(path: Path) -> None:
    with path.open("wb") as file:
        file.write(16 * b"".join(b"v %d %d %d.00000000000000\n" % (n % 7, n % 11, n % 13) for n in range(40_000)))


def write_text(path: Path) -> None:
    with path.open("wb") as file:
        file.write(b"solid large\n")
        file.write(16 * b"".join(b"   vertex %d %d %d.0000000000\n" % (n % 7, n % 11, n % 13) for n in range(40_000)))


def write_binary(path: Path) -> None:
    count = 1_000_000
    with path.open("wb") as file:
        file.write(bytes(80) + count.to_bytes(4, "little"))
        file.truncate(84 + 50 * count)


def write_collada(path: Path) -> None:
    numbers = b"0 1 2 " * 1_000_000
    path.write_bytes(
        b"<COLLADA><library_geometries><geometry id='g'><mesh><source id='s'><float_array>" + numbers
        + b"</float_array></source><vertices><input semantic='POSITION' source='#s'/></vertices></mesh></geometry>"
        b"</library_geometries></COLLADA>"
    )  # fmt: skip


@pytest.mark.parametrize(
    ("name", "write", "result"),
    [
        ("a.obj", write_obj, "6.0 10.0 12.0"),
        ("a.stl", write_text, "6.0 10.0 12.0"),
        ("a.stl", write_binary, "1 0.0 0.0 0.0"),
        ("a.dae", write_collada, "1 0.0 0.0 0.0"),
    ],
    ids=["obj", "text", "binary", "collada"],
)
def test_large_mesh_is_measured_in_little_memory(
    tmp_path: Path, name: str, write: Callable[[Path], None], result: str
) -> None:
    write(tmp_path / name)
    used = run_limited([sys.executable, "-c", MEASURE, str(tmp_path / name)], SECONDS, tmp_path, dict(os.environ))
    assert used.code == 0
    assert used.output.strip().endswith(result)
    assert used.memory < MEMORY


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.obj", b"v 1 2 " + b"3" * 3_000_000),
        ("a.stl", b"solid" + b" vertex 1 2 3" * 300_000),
        ("a.dae", b"<COLLADA>" + b"<a>" * 300_000),
        ("a.dae", b"<COLLADA>" + b"<a/>" * 300_000 + b"</COLLADA>"),
        ("a.dae", b"<COLLADA/>" + b" " * 32_000_000),
        ("a.dae", '<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>'.encode("utf-16")),
    ],
    ids=["long line", "no lines", "nesting", "elements", "size", "entities in UTF-16"],
)
def test_mesh_of_hostile_size_has_no_points(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    assert len(read_mesh(tmp_path / name)) == 0


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".dae"])
def test_special_file_has_no_points(tmp_path: Path, suffix: str) -> None:
    os.mkfifo(tmp_path / f"pipe{suffix}")
    (tmp_path / f"zero{suffix}").symlink_to("/dev/zero")
    (tmp_path / f"folder{suffix}").mkdir()
    (tmp_path / f"loop{suffix}").symlink_to(tmp_path / f"loop{suffix}")
    with (tmp_path / f"huge{suffix}").open("wb") as file:
        file.truncate(1 << 40)
    for path in sorted(tmp_path.iterdir()):
        assert len(read_mesh(path)) == 0, path.name
