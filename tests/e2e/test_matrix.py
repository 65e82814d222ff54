"""Every program on every base and variant on ROS 1, on the simplest base on ROS 2: topics, rates, frames, a clean end.

`bench/matrix` runs the same cells and prints them, `bench/matrix --ros 2` those of every base on ROS 2, which take as
long again; `docs/reference/programs.md` shows what is expected.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.e2e.matrix_cell import try_cell
from tests.e2e.matrix_table import Cell, list_all_bases, load_cells
from tests.ros2_session import PYTHON, free_domain

SAMPLE = {  # the default suite's: one that runs and one that is refused; on ROS 2 one that runs
    "1": ("robot_base-stage", "rviz_sonar-stage"),
    "2": ("robot_base-stage",),
}
CELLS = load_cells(list_all_bases())
CELLS_OF = {"1": CELLS, "2": [cell for cell in CELLS if cell.name.endswith("-stage")]}


def _parameters(ros: str) -> list[object]:
    sample = SAMPLE[ros]
    return [
        pytest.param(cell, id=cell.name, marks=[] if cell.name in sample else [pytest.mark.long])
        for cell in CELLS_OF[ros]
    ]


@pytest.mark.ros
@pytest.mark.timeout(400)
@pytest.mark.parametrize("cell", _parameters("1"))
def test_program_runs_on_base_or_says_what_it_lacks(cell: Cell, tmp_path: Path) -> None:
    result = try_cell(cell, tmp_path)
    assert not result.faults, "\n".join(result.faults)


@pytest.mark.timeout(400)
@pytest.mark.skipif(not PYTHON.exists(), reason="no wheels of ROS 2 for this processor")
@pytest.mark.parametrize("cell", _parameters("2"))
def test_program_runs_on_base_or_says_what_it_lacks_on_ros_2(cell: Cell, tmp_path: Path) -> None:
    result = try_cell(cell, tmp_path, domain=free_domain())
    assert not result.faults, "\n".join(result.faults)
