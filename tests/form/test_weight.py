"""The size of the project does not grow beyond tests/weight.tsv."""

from collections.abc import Mapping
from pathlib import Path

import pytest
from tests.form.facts import Facts, find_facts, read_facts
from tools.weigh import RECORD, ROOT, Record, Weight, compare, lower, main, measure, read_record, total, write_record

MODULE = '"""A module."""\n\n# Why.\nA = 1\n'
HUNDRED = "".join(f"B{number} = 1\n" for number in range(100))


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    for name, text in {
        "src/ur/__init__.py": MODULE,
        "src/ur/robot/setup/engine.py": MODULE,
        "src/ur_nodes/slam/map.py": MODULE + "from typing import Any\nx: Any = 1\n",
        "src/ur/web/page.js": "/* The page.\n\n */\nlet a = 1 // one\n// two\n",
        "tests/run/test_run.py": MODULE + "monkeypatch.setattr(a, 'b', 1)\n",
        "tests/twice": "#!/bin/bash\n# Twice.\ntrue\n",
        "bench/link": "#!/usr/bin/env python3\n" + MODULE,
        "tools/set_up.bash": "true\n\ntrue\n",
        "docs/how-to/drive.md": "Drive a robot.\n",
        "README.md": "A robot.\n",
        "CHANGELOG.md": "Much changed.\n",
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def measure_tree(root: Path) -> dict[str, dict[str, Weight]]:
    return {scale: dict(subjects) for scale, subjects in measure(read_facts(root), root).items()}


def append(path: Path, text: str) -> None:
    path.write_text(path.read_text() + text)


def test_no_scale_is_above_its_base_and_allowances(facts: Mapping[str, Facts]) -> None:
    problems = compare(read_record((ROOT / RECORD).read_text(encoding="utf-8")), measure(facts))
    assert not problems, "\n".join(problems)


def test_scales_count_packages_folders_words_and_code_lines(tree: Path) -> None:
    assert measure_tree(tree) == {
        "source": {"ur": Weight(4, 1), "ur.robot": Weight(4, 1), "ur_nodes.slam": Weight(6, 3)},
        "javascript": {"ur.web": Weight(5, 1)},
        "tests": {"tests": Weight(3, 1), "tests/run": Weight(5, 2)},
        "bench": {"bench": Weight(5, 1)},
        "tools": {"tools": Weight(3, 2)},
        "docs": {".": Weight(2), "docs/how-to": Weight(3)},
        "any": {"ur_nodes.slam": Weight(2)},
        "patches": {"tests/run": Weight(1)},
    }


def test_code_lines_leave_out_docstrings_comments_and_blank_lines_but_not_texts() -> None:
    text = 'class A:\n    """One.\n\n    Two.\n    """\n\n    # Three.\n    b = """\n# four\n\n"""  # five\n'
    assert find_facts(text).code_lines == 5


def test_hundred_lines_without_an_allowance_fail_by_name_and_pass_with_one(tree: Path) -> None:
    record = Record(measure_tree(tree))
    assert compare(record, measure_tree(tree)) == []
    append(tree / "src/ur/robot/setup/engine.py", HUNDRED)
    (problem,) = compare(record, measure_tree(tree))
    assert problem.splitlines() == [
        "source has 114 lines (105 code lines), expected at most 14 lines (5 code lines), the base and its allowances",
        "  ur.robot grew by 100 lines (100 code lines)",
        "  help: take out as much in source, or add the row that the issue of this change grants: "
        "allowance<tab>source<tab>SUBJECT<tab>LINES",
    ]
    assert compare(Record(record.base, (("source", "a new robot", 100),)), measure_tree(tree)) == []
    assert compare(Record(record.base, (("source", "a new robot", 99),)), measure_tree(tree)) != []
    assert compare(Record(record.base, (("tests", "a new robot", 100),)), measure_tree(tree)) != []


def test_blank_lines_and_code_lines_are_limited_each(tree: Path) -> None:
    record = Record(measure_tree(tree))
    (tree / "src/ur/__init__.py").write_text("A = 1\nB = 2\nC = 3\nD = 4\n")
    (problem,) = compare(record, measure_tree(tree))
    assert "ur grew by 0 lines (3 code lines)" in problem


@pytest.mark.parametrize(
    ("name", "text", "scale"),
    [
        ("src/ur/web/page.js", "let b = 2\n", "javascript"),
        ("tests/twice", "true\n", "tests"),
        ("bench/link", "B = 1\n", "bench"),
        ("tools/set_up.bash", "true\n", "tools"),
        ("docs/how-to/drive.md", "Again.\n", "docs"),
    ],
)
def test_each_scale_has_a_limit(tree: Path, name: str, text: str, scale: str) -> None:
    record = Record(measure_tree(tree))
    append(tree / name, text)
    (problem,) = compare(record, measure_tree(tree))
    assert problem.startswith(f"{scale} has ")


def test_code_may_move_between_packages(tree: Path) -> None:
    record = Record(measure_tree(tree))
    (tree / "src/ur_nodes/slam/engine.py").write_text((tree / "src/ur/robot/setup/engine.py").read_text())
    (tree / "src/ur/robot/setup/engine.py").unlink()
    measured = measure_tree(tree)
    assert compare(record, measured) == []
    assert lower(record, measured).base["source"] == {"ur": Weight(4, 1), "ur_nodes.slam": Weight(10, 4)}


def test_base_is_lowered_and_never_raised() -> None:
    record = Record({"source": {"ur.a": Weight(10, 5), "ur.b": Weight(10, 5)}, "docs": {"docs": Weight(7)}})
    fallen = {"source": {"ur.a": Weight(12, 6), "ur.b": Weight(5, 4)}, "docs": {"docs": Weight(8)}}
    assert lower(record, fallen).base["source"] == fallen["source"]
    assert lower(record, fallen).base["docs"] == {"docs": Weight(7)}
    more_code = {"source": {"ur.a": Weight(8, 11)}}
    assert lower(record, more_code).base["source"] == record.base["source"]


def test_scale_without_base_rows_gets_those_of_today() -> None:
    measured = {"source": {"ur.a": Weight(10, 5)}}
    assert total(lower(Record({}), measured).base, "source") == Weight(10, 5)


def test_record_is_read_as_it_is_written() -> None:
    record = Record({"source": {"ur.a": Weight(10, 5)}, "any": {"ur.a": Weight(2)}}, (("docs", "a page", 100),))
    assert read_record(write_record(record)) == record
    for line in ("base\tsauce\tur\t1\t1", "allowance\tsource\tnothing", "<<<<<<< ours"):
        with pytest.raises(ValueError, match="line 1"):
            read_record(line)


def test_command_names_what_grew_and_writes_what_fell(tree: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record = tree / RECORD
    record.write_text(write_record(Record({})))
    assert main(["--write"], tree) == 0
    assert "source      14 lines (5 code lines), at most 14 lines (5 code lines)" in capsys.readouterr().out
    before = record.read_text()
    append(tree / "src/ur/robot/setup/engine.py", HUNDRED)
    assert main(["--write"], tree) == 1
    assert "ur.robot grew by 100 lines" in capsys.readouterr().out
    assert record.read_text() == before
    append(record, "allowance\tsource\ta new robot\t100\n")
    assert main([], tree) == 0
