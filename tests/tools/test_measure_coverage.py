"""The comparison of coverage with its record, and the record itself."""

import yaml
from tools.measure_coverage import (
    RECORD,
    ROOT,
    TOLERANCE,
    compare,
    group_by_package,
    package_of,
    raise_record,
    summarise,
)


def file_with(lines: int, branches: int, of_lines: int, of_branches: int) -> dict[str, dict[str, float]]:
    missing = {"missing_lines": of_lines - lines, "missing_branches": of_branches - branches}
    return {"summary": {"covered_lines": lines, "covered_branches": branches, **missing}}


def test_figure_counts_statements_and_branches_of_all_files() -> None:
    assert summarise({"a.py": file_with(8, 1, 10, 4), "b.py": file_with(5, 0, 5, 1)}) == 70.0


def test_files_count_for_the_package_below_ur_or_ur_nodes() -> None:
    file = file_with(1, 0, 1, 0)
    paths = ("src/ur/__main__.py", "src/ur/cli/launch/run.py", "src/ur/cli/main.py", "src/ur_nodes/motion/mux_node.py")
    assert {name: list(files) for name, files in group_by_package(dict.fromkeys(paths, file)).items()} == {
        "ur": [paths[0]],
        "ur.cli": [paths[1], paths[2]],
        "ur_nodes.motion": [paths[3]],
    }


def test_package_that_is_covered_less_than_recorded_is_named() -> None:
    recorded = {"ur.graph": 90.0, "ur.find": 80.0}
    assert compare(recorded, {"ur.graph": 90.0 - TOLERANCE, "ur.find": 81.0, "ur.new": 10.0}) == []
    (line,) = compare(recorded, {"ur.graph": 88.6})
    assert line.startswith("ur.graph is covered by 88.6 %, expected at least 90.0 %; ")
    assert line.endswith("tools/measure_coverage.py --missing ur.graph")


def test_record_is_raised_and_never_lowered() -> None:
    assert raise_record({"a": 90.0, "gone": 50.0}, {"a": 89.0, "b": 10.0}) == {"a": 90.0, "b": 10.0}
    assert raise_record({"a": 90.0}, {"a": 91.5}) == {"a": 91.5}


def test_record_names_only_packages_that_there_are() -> None:
    there = {package_of(str(path)) for path in (ROOT / "src").rglob("*.py")}
    assert set(yaml.safe_load(RECORD.read_text(encoding="utf-8"))) <= there
