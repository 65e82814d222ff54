"""Tab after `ur run`: programs of every package, their arguments, and worlds of one's own."""

from pathlib import Path

import pytest

from ur.cli.computer.completing import answer_completion, make_known
from ur.cli.verbs import VERBS


@pytest.fixture(autouse=True)
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    package = tmp_path / "my_robot"
    (package / "bin").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>my_robot</name></package>")
    (package / "bin" / "ur_wander").write_text(
        '#!/bin/sh\n##Summary: Let a robot wander.\nexec ur launch my_robot m_wander.launch.xml "$@"\n'
    )
    (package / "bin" / "ur_wander").chmod(0o755)
    (package / "m_wander" / "launch").mkdir(parents=True)
    (package / "m_wander" / "launch" / "m_wander.launch.xml").write_text(
        '<launch><arg name="near" default="0.8"/></launch>'
    )
    (tmp_path / "home.yaml").touch()
    (tmp_path / "home.png").touch()
    (tmp_path / "houses").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("ur run wan", ["wander"]),
        ("ur help wan", ["wander"]),
        ("ur help lis", ["list"]),
        ("ur run wander ", ["near:="]),
        ("ur run keyboard_navigate worl", ["world:="]),
        ("ur run keyboard_navigate world:=", ["world:=maze", "world:=office", "world:=home.yaml", "world:=houses/",
                                              "world:=config/", "world:=my_robot/"]),
        ("ur run keyboard_navigate world:=./ho", ["world:=./home.yaml", "world:=./houses/"]),
        ("ur run keyboard_navigate map_file:=home", ["map_file:=home.yaml"]),
        ("ur run keyboard_navigate localisation:=", ["localisation:=amcl", "localisation:=fiducials"]),
        ("ur new wor", ["world"]),
    ],
)  # fmt: skip
def test_tab_offers(line: str, offered: list[str], workspace: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (workspace / "config").mkdir()
    assert answer_completion(["zsh", line]) == 0
    found = [row.split("\t")[1] for row in capsys.readouterr().out.splitlines()]
    assert sorted(found) == sorted(offered)


def test_kinds_of_arguments_are_those_of_the_table_of_verbs() -> None:
    known = make_known({})
    assert {name: tuple(known.kinds(name)) for name in VERBS if name != "help"} == {
        name: verb.arguments for name, verb in VERBS.items() if name != "help"
    }


def test_packages_and_arguments_are_those_of_this_moment(
    workspace: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def offer(line: str) -> list[str]:
        answer_completion(["zsh", line])
        return [row.split("\t")[1] for row in capsys.readouterr().out.splitlines()]

    monkeypatch.chdir(workspace / "houses")
    package = workspace / "my_robot"
    launch = package / "m_wander/launch/m_wander.launch.xml"
    assert offer("ur launch my_r") == ["my_robot"]
    (package / "package.xml").write_text("<package><name>my_rover</name></package>")  # as long as before
    assert offer("ur launch my_r") == ["my_rover"]
    launch.write_text('<launch><arg name="wide" default="0.8"/></launch>')
    assert offer("ur launch my_rover m_wander.launch.xml ") == ["wide:="]
    package.rename(workspace / "other")
    assert offer("ur launch my_rover m_wander.launch.xml ") == ["wide:="]
    (workspace / "added").mkdir()
    (workspace / "added/package.xml").write_text("<package><name>my_rake</name></package>")
    assert offer("ur launch my_r") == ["my_rake", "my_rover"]
    (workspace / "other/CATKIN_IGNORE").touch()
    assert offer("ur launch my_r") == ["my_rake"]
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(workspace / "houses"))
    assert offer("ur launch my_r") == []
