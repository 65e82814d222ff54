"""`ur list`: programs, summaries, and what the selected base lacks."""

import json
import re
from pathlib import Path

import pytest
from tests.ros_session import free_port

import ur.web
from ur.cli.launch.list_programs import FIRST
from ur.cli.main import main


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home without a selection, and no master."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setenv("ROS_MASTER_URI", f"http://localhost:{free_port()}")
    monkeypatch.delenv("UR_SELECTION", raising=False)
    return tmp_path


def find_line(text: str, name: str) -> str:
    (line,) = (line for line in text.splitlines() if line.split()[:1] == [name])
    return line


def test_programs_are_listed_with_what_the_selected_base_lacks(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["use", "sim:botvac:botvac50"]) == 0
    assert main(["list"]) == 0
    text = capsys.readouterr().out
    assert find_line(text, "raspicam_view").endswith("  [botvac:botvac50 has no raspicam]")
    assert find_line(text, "rviz_sonar").endswith("  [botvac:botvac50 has no sonars]")
    assert not find_line(text, "keyboard_drive").endswith("]")


def test_base_that_is_not_known_is_said_and_the_list_comes_all_the_same(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (home / "ubiquity_launches").mkdir()
    (home / "ubiquity_launches" / "selection").write_text("sim:magnni\n", encoding="utf-8")
    assert main(["list"]) == 0
    captured = capsys.readouterr()
    assert "unknown base 'magnni'" in captured.err
    assert find_line(captured.out, "rviz_sonar")


def test_programs_that_most_people_want_come_first_as_on_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    first, others = capsys.readouterr().out.split("\n\n")
    assert tuple(line.split()[0] for line in first.splitlines()) == FIRST
    head, *rest = (line.split()[0] for line in others.splitlines())
    assert head == "other"
    assert rest == sorted(rest)
    assert not set(rest) & set(FIRST)
    texts = Path(ur.web.__path__[0], "static/texts.js").read_text(encoding="utf-8")
    (names,) = re.findall(r"programNames: \{(.*)\}", texts)
    assert tuple(re.findall(r"(\w+):", names)) == FIRST


def test_programs_are_grouped_by_package_where_others_have_some(
    home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    assert main(["list"]) == 0
    assert "ubiquity_launches:" not in capsys.readouterr().out
    folder = home / "my_robot"
    (folder / "bin").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>my_robot</name></package>")
    (folder / "bin" / "ur_wander").write_text("#!/bin/sh\n##Summary: Let a robot wander.\n")
    (folder / "bin" / "ur_wander").chmod(0o755)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(home))
    assert main(["list"]) == 0
    _, own, theirs = capsys.readouterr().out.split("\n\n")
    assert own.startswith("ubiquity_launches:\n  ")
    assert theirs.split() == ["my_robot:", "wander", "Let", "a", "robot", "wander."]


def test_programs_are_listed_as_json_with_their_arguments(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["use", "sim:botvac:botvac50"]) == 0
    capsys.readouterr()
    assert main(["list", "--json"]) == 0
    programs = {each["name"]: each for each in json.loads(capsys.readouterr().out)}
    assert programs["rviz_sonar"]["lack"] == "botvac:botvac50 has no sonars"
    navigate = programs["keyboard_navigate"]
    assert navigate["launch_file"].endswith("m_keyboard_navigate.launch.xml")
    assert navigate["problem"] == ""
    arguments = {each["name"]: each for each in navigate["arguments"]}
    assert arguments["robot_base"]["default"] == "botvac"
    assert [each["text"] for each in arguments["world"]["values"]] == ["maze", "office"]
    assert [each["text"] for each in arguments["bring_up"]["values"]] == ["true", "false"]
    assert arguments["x"]["doc"]


def test_summaries_and_arguments_hold_on_the_page_as_in_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list", "--json"]) == 0
    programs = json.loads(capsys.readouterr().out)
    texts = [text for each in programs for text in (each["summary"], *(one["doc"] for one in each["arguments"]))]
    assert [text for text in texts if "terminal" in text.lower()] == []
