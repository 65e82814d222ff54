"""Every program on every base and variant, in the simulator: topics, rates, frames, silence, and a clean end.

`bench/matrix` runs the same cells and prints them; `docs/reference/programs.md` shows what is expected.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.e2e.matrix_cell import try_cell
from tests.e2e.matrix_table import Cell, list_all_bases, load_cells

SAMPLE = ("robot_base-stage", "rviz_sonar-stage")  # one that runs and one that is refused: the default suite's
CELLS = load_cells(list_all_bases())


def _parameters() -> list[object]:
    return [pytest.param(cell, id=cell.name, marks=[] if cell.name in SAMPLE else [pytest.mark.long]) for cell in CELLS]


@pytest.mark.ros
@pytest.mark.timeout(400)
@pytest.mark.parametrize("cell", _parameters())
def test_program_runs_on_base_or_says_what_it_lacks(cell: Cell, tmp_path: Path) -> None:
    result = try_cell(cell, tmp_path)
    assert not result.faults, "\n".join(result.faults)
