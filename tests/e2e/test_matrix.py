"""Every program on every base and variant, on ROS 1 and on ROS 2: topics, rates, frames, a clean end.

`docs/reference/programs.md` shows what is expected.
"""

from collections.abc import Collection
from pathlib import Path

import pytest
from tests.e2e.matrix_cell import try_cell
from tests.e2e.matrix_table import Cell, list_all_bases, load_cells
from tests.ros2_session import PYTHON, free_domain

from ur.request.bases.base_argument import describe_base

CELLS = load_cells(list_all_bases())
ROS_1 = {
    cell.name
    for cell in CELLS
    if cell.base.name == "stage"
    or cell.program.name == "robot_base"
    or (
        cell.program.name in ("keyboard_drive", "keyboard_navigate", "make_map")
        and describe_base(cell.base) in ("botvac", "magni", "magni:lidar")
    )
}
"""Cells of .ci/run: every program, every base, and programs that depend on the sensors with and without a lidar."""
ROS_2 = {
    f"{program}-stage"
    for program in ("keyboard_drive", "keyboard_navigate", "local_costmap", "make_map", "raspicam", "robot_base")
}


def _parameters(sample: Collection[str]) -> list[object]:
    """All cells; those outside of the sample are for tests/nightly."""
    return [
        pytest.param(cell, id=cell.name, marks=[] if cell.name in sample else [pytest.mark.nightly]) for cell in CELLS
    ]


@pytest.mark.ros
@pytest.mark.timeout(600)
@pytest.mark.parametrize("cell", _parameters(ROS_1))
def test_program_runs_on_base_or_says_what_it_lacks(cell: Cell, tmp_path: Path) -> None:
    result = try_cell(cell, tmp_path)
    assert not result.faults, "\n".join(result.faults)


@pytest.mark.timeout(600)
@pytest.mark.skipif(not PYTHON.exists(), reason="no wheels of ROS 2 for this processor")
@pytest.mark.parametrize("cell", _parameters(ROS_2))
def test_program_runs_on_base_or_says_what_it_lacks_on_ros_2(cell: Cell, tmp_path: Path) -> None:
    result = try_cell(cell, tmp_path, domain=free_domain())
    assert not result.faults, "\n".join(result.faults)
