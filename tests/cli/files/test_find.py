"""`ur find` as it is typed."""

import json
from pathlib import Path

import pytest

from ur.cli.files import find
from ur.cli.main import main
from ur.tools.find.search import KINDS


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.launch").write_text(
        '<launch>\n  <arg name="rate"/>\n  <param name="r" value="$(arg rate)"/>\n</launch>\n'
    )
    return tmp_path


def test_kinds_are_those_of_the_search() -> None:
    assert find._KINDS == KINDS


def test_find_shows_place_and_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", "rate"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "arg rate",
        "  defined  a.launch:2:14",
        '             <arg name="rate"/>',
        "  used     a.launch:3:32",
        '             <param name="r" value="$(arg rate)"/>',
    ]


def test_json_names_role_and_place(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", "--json", "--kind", "param", "r"]) == 0
    (only,) = json.loads(capsys.readouterr().out)
    assert only == {
        "kind": "param", "name": "/r", "role": "definition", "path": str(folder / "a.launch"),
        "line": 3, "column": 3, "note": "",
    }  # fmt: skip


def test_nothing_found_is_said_with_what_to_try(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", "speed"]) == 1
    assert capsys.readouterr().err == "no 'speed' in .; use * as a wildcard: ur find '*speed*'\n"


def test_search_of_a_folder_without_launch_files_is_refused(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "a.launch").rename(folder / "a.txt")
    assert main(["find", "speed"]) == 2
    assert "launch files end in .launch" in capsys.readouterr().err
