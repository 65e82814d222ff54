"""The comparison of coverage with its record, and the record itself."""

from __future__ import annotations

import yaml
from tools.measure_coverage import RECORD, TOLERANCE, compare, list_packages, summarise


def file_with(lines: int, branches: int, of_lines: int, of_branches: int) -> dict[str, dict[str, float]]:
    figures = {"covered_lines": lines, "covered_branches": branches}
    return {"summary": {**figures, "num_statements": of_lines, "num_branches": of_branches}}


def test_figure_counts_statements_and_branches_of_all_files() -> None:
    assert summarise({"a.py": file_with(8, 1, 10, 4), "b.py": file_with(5, 0, 5, 1)}) == 70.0


def test_package_that_is_covered_less_than_recorded_is_named() -> None:
    recorded = {"ur.graph": 90.0, "ur.find": 80.0}
    assert compare(recorded, {"ur.graph": 90.0 - TOLERANCE, "ur.find": 81.0, "ur.new": 10.0}) == []
    assert compare(recorded, {"ur.graph": 89.0}) == ["ur.graph is covered by 89.0 %, recorded are 90.0 %"]


def test_record_names_only_packages_that_can_be_measured() -> None:
    assert set(yaml.safe_load(RECORD.read_text(encoding="utf-8"))) <= set(list_packages())
