"""`ur convert`: a file on standard output, a package in a folder, and a folder for `ros2 launch`."""

from pathlib import Path

import pytest

from ur.cli.main import main

TALKER = """<launch>
  <node pkg="demo" type="talk" name="talker">
    <rosparam file="$(find demo)/params/talk.yaml"/>
  </node>
</launch>
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "demo"
    (folder / "launch").mkdir(parents=True)
    (folder / "params").mkdir()
    (folder / "bin").mkdir()
    (folder / "package.xml").write_text("<package>\n  <name>demo</name>\n</package>\n")
    (folder / "launch" / "talker.launch").write_text(TALKER)
    (folder / "params" / "talk.yaml").write_text("rate: 2\n")
    (folder / "bin" / "talk").write_text("#!/bin/sh\n")
    (folder / "bin" / "talk").chmod(0o755)
    monkeypatch.chdir(tmp_path)
    return folder


def test_file_is_printed(package: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "demo/launch/talker.launch"]) == 0
    shown = capsys.readouterr()
    assert '<param from="$(find-pkg-share demo)/params/talk.yaml"/>' in shown.out
    assert "demo/params/talk.yaml" in shown.err
    assert (package / "params" / "talk.yaml").read_text() == "rate: 2\n"


@pytest.mark.usefixtures("package")
def test_package_is_written_as_it_lies_and_again(tmp_path: Path) -> None:
    for _ in range(2):
        assert main(["convert", "demo", "--output", "out"]) == 0
    assert "exec=" in (tmp_path / "out" / "launch" / "talker.launch").read_text()
    assert "ros__parameters" in (tmp_path / "out" / "params" / "talk.yaml").read_text()
    assert not (tmp_path / "out" / "bin").exists()


def test_prefix_has_the_package_and_its_programs(package: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for _ in range(2):
        assert main(["convert", "demo", "--prefix", "pre"]) == 0
    assert "AMENT_PREFIX_PATH" in capsys.readouterr().err
    prefix = package.parent / "pre"
    assert (prefix / "share/ament_index/resource_index/packages/demo").is_file()
    assert "exec=" in (prefix / "share/demo/launch/talker.launch").read_text()
    assert not (prefix / "share/demo/launch/talker.launch").is_symlink()
    assert (prefix / "lib/demo/talk").samefile(package / "bin" / "talk")
    assert (package / "launch" / "talker.launch").read_text() == TALKER


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["demo", "--output", "demo"], "holds other files"),
        (["demo/launch", "--output", "a", "--prefix", "b"], "expected one of them"),
        (["demo/params"], "no launch file in it"),
    ],
)
@pytest.mark.usefixtures("package")
def test_wrong_use_is_refused(words: list[str], expected: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", *words]) == 2
    assert expected in capsys.readouterr().err


def test_what_is_lost_is_printed(package: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (package / "launch" / "b.launch").write_text('<launch><test pkg="demo" type="t" test-name="a"/></launch>')
    assert main(["convert", "demo"]) == 2
    assert "expected --output or --prefix" in capsys.readouterr().err
    assert main(["convert", "demo", "--output", "out"]) == 1
    assert "<test> has no counterpart" in capsys.readouterr().err


PYTHON = """from launch import LaunchDescription
from launch.actions import ExecuteProcess, OpaqueFunction
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([Node(package="demo", executable="talk"){more}])
"""


@pytest.fixture
def python_package(package: Path) -> Path:
    (package / "launch" / "talker.launch").unlink()
    (package / "launch" / "talker.launch.py").write_text(PYTHON.format(more=""))
    (package / "launch" / "other.launch.py").write_text(PYTHON.format(more=", OpaqueFunction(function=print)"))
    return package


@pytest.mark.usefixtures("python_package")
def test_python_file_is_printed_in_either_language(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "demo/launch/talker.launch.py"]) == 0
    assert capsys.readouterr().out.endswith('<launch>\n  <node pkg="demo" exec="talk"/>\n</launch>\n')
    assert main(["convert", "demo/launch/talker.launch.py", "--to", "yaml"]) == 0
    assert capsys.readouterr().out == "launch:\n- node:\n    pkg: demo\n    exec: talk\n"


@pytest.mark.usefixtures("python_package")
def test_python_file_that_cannot_be_converted_is_written_on_demand(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "demo/launch/other.launch.py"]) == 2
    shown = capsys.readouterr()
    assert "other.launch.py:7:72: warning: OpaqueFunction cannot be converted" in shown.err
    assert not shown.out
    assert main(["convert", "demo/launch/other.launch.py", "--anyway"]) == 1
    assert 'exec="talk"' in capsys.readouterr().out


def test_python_package_is_written_without_what_differs(python_package: Path) -> None:
    assert main(["convert", "demo", "--output", "out"]) == 1
    assert [file.name for file in (python_package.parent / "out" / "launch").iterdir()] == ["talker.launch.xml"]
