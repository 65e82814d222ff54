"""The lists of slow tests and of promises: what they name is there, and the README's commands each have a test."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from tests.slow_list import (
    LIMIT,
    LIST,
    PROMISES,
    function_of,
    is_listed,
    lowest,
    main,
    name_of,
    read_promises,
    read_rows,
    renew,
    write_rows,
)

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
ROWS = read_rows(LIST.read_text(encoding="utf-8"))
PROMISED = read_promises(PROMISES.read_text(encoding="utf-8"))


def functions_of(file: str) -> set[str]:
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8")) if (ROOT / file).is_file() else ast.Module([], [])
    return {node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)}


def find_lost(names: list[str]) -> list[str]:
    known = {file: functions_of(file) for file in {name.partition("::")[0] for name in names}}
    return [name for name in names if function_of(name).split("::")[-1] not in known[name.partition("::")[0]]]


def test_lists_name_tests_that_exist() -> None:
    assert find_lost([*ROWS, *(test for _, test in PROMISED)]) == [], "rename or remove these rows"


def test_list_is_as_it_is_written_and_has_the_sum_of_its_seconds() -> None:
    assert LIST.read_text(encoding="utf-8") == write_rows(ROWS)
    assert min(ROWS.values()) > LIMIT


def test_every_command_of_the_readme_is_a_promise_with_a_test() -> None:
    lines = re.findall(r"^    (?=\./ur |printf .*\./ur |eval |roslaunch )(.*?)(?: +#.*)?$", README, re.MULTILINE)
    promised = {promise for promise, _ in PROMISED}
    assert [line for line in lines if line not in promised] == []
    assert [promise for promise in promised if promise not in README] == []


def test_function_with_slow_parameters_only_has_one_row() -> None:
    measured = {"a.py::f[1]": 1.0, "a.py::f[2]": 2.0, "a.py::g[1]": 1.0, "a.py::g[2]": 0.1, "a.py::h": 0.1}
    assert renew({}, measured) == {"a.py::f": 3.0, "a.py::g[1]": 1.0}


def test_test_that_was_measured_again_has_its_new_time_or_leaves() -> None:
    rows = {"a.py::f": 3.0, "a.py::g": 1.0, "a.py::h": 5.0}
    assert renew(rows, {"a.py::f": 0.9, "a.py::g": 0.1}) == {"a.py::f": 0.9, "a.py::h": 5.0}


def test_lowest_of_several_runs_counts() -> None:
    assert lowest([{"a": 1.0, "b": 2.0}, {"a": 0.2}]) == {"a": 0.2, "b": 2.0}


def test_row_of_a_function_lists_its_parameters() -> None:
    assert is_listed("a.py::f[1-x]", {"a.py::f"})
    assert is_listed("a.py::f[1]", {"a.py::f[1]"})
    assert not is_listed("a.py::f[2]", {"a.py::f[1]"})


def test_name_of_a_test_is_on_one_line() -> None:
    assert name_of("a.py::f[ä\t\n]") == "a.py::f[\\xe4\\t\\n]"


def test_unlisted_test_that_takes_seconds_fails_by_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    times = tmp_path / "times.tsv"
    times.write_text("29.5\ttests/test_new.py::test_that_is_slow\n0.1\ttests/test_new.py::test_other\n")
    assert main([str(times)]) == 1
    assert "error: tests/test_new.py::test_that_is_slow takes 29.5 s of processor" in capsys.readouterr().out
    times.write_text("0.1\ttests/test_new.py::test_other\n")
    assert main([str(times)]) == 0


def test_skipped_test_has_no_time_so_that_the_check_sees_it(tmp_path: Path) -> None:
    lines = ["import pytest", "def test_runs(): pass", "@pytest.mark.skip", "def test_lacks_a_browser(): pass"]
    (tmp_path / "test_both.py").write_text("\n".join(lines))
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "tests.times",
        "--times",
        str(tmp_path / "times"),
        "--rootdir",
    ]
    done = subprocess.run(
        [*command, str(tmp_path), "test_both.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        timeout=60,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "1 passed, 1 skipped" in done.stdout
    assert set(read_rows((tmp_path / "times").read_text())) == {"test_both.py::test_runs"}
    [path] = re.findall(r"grep -m 1 (\S+)::", (ROOT / ".ci/run").read_text())
    assert (ROOT / path).exists()
