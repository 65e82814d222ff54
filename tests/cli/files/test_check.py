"""`ur check` and `ur explain` as they are typed."""

import json
from pathlib import Path

import pytest

from ur.cli.main import main

GOOD = '<launch>\n  <arg name="rate" default="1"/>\n  <param name="rate" value="$(arg rate)"/>\n</launch>\n'
WARNS = '<launch>\n  <arg name="rate" default="1"/>\n</launch>\n'
BAD = '<launch>\n  <group if="yes">\n    <param name="rate" value="1"/>\n  </group>\n</launch>\n'


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    for name, text in (("good", GOOD), ("warns", WARNS), ("bad", BAD)):
        (tmp_path / f"{name}.launch").write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["good.launch"], 0),
        (["warns.launch"], 0),
        (["warns.launch", "--strict"], 1),
        (["bad.launch"], 1),
        (["."], 1),
        ([], 1),
        (["bad.launch", "--ignore", "values"], 0),
        (["bad.launch", "--select", "xml,yaml"], 0),
        (["good.launch", "rate:=2"], 0),
        (["good.launch", "rat:=2"], 1),
        (["nothing.launch"], 2),
        (["good.launch", "--select", "nothing"], 2),
        (["--explain", "bad-boolean"], 0),
        (["--explain", "bad-bolean"], 2),
    ],
)
def test_exit_code_says_what_was_found(words: list[str], code: int) -> None:
    assert main(["check", *words]) == code


@pytest.mark.parametrize("form", ["human", "json"])
def test_check_that_read_nothing_ends_with_code_two(folder: Path, form: str) -> None:
    (folder / "ros2").mkdir()
    (folder / "ros2" / "robot.py").write_text("")
    assert main(["check", "ros2", "--format", form]) == 2


def test_findings_are_shown_with_short_paths(capsys: pytest.CaptureFixture[str]) -> None:
    main(["check"])
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "bad.launch:2:14: error: 'if' of <group> is 'yes', expected true, false, 1 or 0 [bad-boolean]"
    assert lines[-1] == "1 error and 1 warning in 3 files"


def test_fix_repairs_the_file_and_keeps_its_mode(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "bad.launch").chmod(0o640)
    assert main(["check", "bad.launch", "--fix"]) == 0
    assert (folder / "bad.launch").read_text() == BAD.replace("yes", "true")
    assert (folder / "bad.launch").stat().st_mode & 0o777 == 0o640
    assert "repaired 1 finding in 1 file" in capsys.readouterr().err
    assert sorted(path.name for path in folder.glob("*.ur-new")) == []


def test_format_for_programs_is_json(capsys: pytest.CaptureFixture[str]) -> None:
    main(["check", "--format", "json"])
    assert isinstance(json.loads(capsys.readouterr().out), dict)


def test_package_beside_the_checked_one_is_known(folder: Path) -> None:
    for name in ("one", "two"):
        (folder / "src" / name).mkdir(parents=True)
        (folder / "src" / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
    (folder / "src/two/part.launch").write_text(GOOD)
    (folder / "src/one/main.launch").write_text('<launch><include file="$(find two)/part.launch"/></launch>')
    assert main(["check", "src/one/main.launch"]) == 0
    assert main(["check", "src"]) == 0


def test_explain_shows_layers_with_short_paths(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "good.launch", "rate", "rate:=3"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "parameter /rate = 3"
    assert lines[1] == '  good.launch:3:3: <param name="rate" value="$(arg rate)"/>'
    assert "      given: rate:=3" in lines


@pytest.mark.parametrize("words", [["good.launch"], ["good.launch", "nothing"], ["none.launch", "rate"]])
def test_explain_of_nothing_ends_with_code_two(words: list[str]) -> None:
    assert main(["explain", *words]) == 2
