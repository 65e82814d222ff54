"""A new base needs nothing but files that are named after it: every program runs on it."""

import os
import re
import subprocess
from pathlib import Path

import pytest
import yaml
from tests.e2e.dropped_base import NAME, drop_base
from tests.e2e.matrix_cell import try_cell
from tests.e2e.matrix_table import load_cells

from ur.request.programs import PACKAGE, list_programs

SAMPLE = ("robot_base", "keyboard_drive", "keyboard_navigate", "make_map")


def test_only_files_named_after_the_base_are_added(tmp_path: Path) -> None:
    drop_base(tmp_path)
    added = [path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()]
    assert len(added) > 5
    others = [path for path in added if path.stem != NAME and path.parent.name != NAME]
    assert [str(path) for path in others] == [".catkin"]
    assert not [path for path in added if (PACKAGE / Path(*path.parts[2:])).is_file()]


@pytest.mark.ros
@pytest.mark.timeout(600)
@pytest.mark.parametrize(
    "program",
    [
        pytest.param(program.name, marks=[] if program.name in SAMPLE else [pytest.mark.nightly])
        for program in list_programs(PACKAGE / "bin")
    ],
)
def test_program_runs_on_a_base_that_was_dropped_in(program: str, tmp_path: Path) -> None:
    workspace, folder = tmp_path / "workspace", tmp_path / "run"
    folder.mkdir()
    base = drop_base(workspace)
    (cell,) = (cell for cell in load_cells([base]) if cell.program.name == program)
    assert not cell.lacks
    prefixes = os.pathsep.join(filter(None, [str(workspace), os.environ.get("CMAKE_PREFIX_PATH", "")]))
    result = try_cell(cell, folder, environment={"CMAKE_PREFIX_PATH": prefixes})
    assert not result.faults, "\n".join(result.faults)


def test_launch_files_name_no_folder_of_the_package_that_a_workspace_would_hide() -> None:
    """roslaunch takes a whole folder from the workspace that has it: only files may be looked for."""
    looked_for = re.compile(r"\$\(find ubiquity_launches\)/([\w./]+)\"")
    for path in PACKAGE.glob("*/launch/*.xml"):
        found = [place for place in looked_for.findall(path.read_text(encoding="utf-8")) if (PACKAGE / place).is_dir()]
        assert not found, f"{path}: {found}"


def test_plain_roslaunch_finds_the_files_of_the_base_too(tmp_path: Path) -> None:
    drop_base(tmp_path)
    kept = {name: value for name, value in os.environ.items() if not name.startswith("ROS")}
    env = kept | {
        "CMAKE_PREFIX_PATH": str(tmp_path),
        "ROS_PACKAGE_PATH": f"{PACKAGE}:/usr/share",
        "ROS_HOME": str(tmp_path / "home"),
        "PATH": f"/usr/bin:{kept['PATH']}",
    }
    words = [PACKAGE.name, "m_local_costmap.launch.xml", f"robot_base:={NAME}"]
    command = ["/usr/bin/roslaunch", "--dump-params", *words]
    done = subprocess.run(command, env=env, capture_output=True, text=True, check=True, timeout=150)
    values = yaml.safe_load(done.stdout)
    assert Path(values["/simulator/package"]).resolve() == (tmp_path / "share" / PACKAGE.name).resolve()
    assert f'<robot name="{NAME}"' in values["/robot_description"]
    assert "/local_costmap/costmap/footprint" in values
