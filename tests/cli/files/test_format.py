"""`ur format` as it is typed."""

import io
from pathlib import Path
from types import SimpleNamespace

import pytest

from ur.cli.main import main

UGLY = '<launch>\n<param value="1" name="a"/>\n</launch>\n'
FINE = '<launch>\n  <param name="a" value="1"/>\n</launch>\n'


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.launch").write_text(UGLY)
    (tmp_path / "b.launch").write_text(FINE)
    return tmp_path


def test_format_rewrites_a_file_in_another_layout(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "a.launch").chmod(0o640)
    assert main(["format"]) == 0
    told = capsys.readouterr()
    assert told.out == "formatted a.launch\n"
    assert told.err == "2 launch files: 1 changed\n"
    assert (folder / "a.launch").read_text() == FINE
    assert (folder / "a.launch").stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in folder.iterdir()) == ["a.launch", "b.launch"]


@pytest.mark.parametrize("option", ["--check", "--diff"])
def test_check_and_diff_change_nothing_and_say_so(
    folder: Path, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["format", option, "a.launch"]) == 1
    told = capsys.readouterr().out
    assert "would format a.launch" in told or '+  <param name="a" value="1"/>' in told
    assert (folder / "a.launch").read_text() == UGLY
    assert main(["format", option, "b.launch"]) == 0


def test_broken_file_is_named_and_the_others_are_formatted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "broken.launch").write_text("<launch>\n  <group>\n</launch>\n")
    assert main(["format"]) == 1
    told = capsys.readouterr()
    assert "broken.launch:3:1: error: not well-formed XML" in told.err
    assert "3 launch files: 1 changed, 1 left alone because of errors" in told.err
    assert (folder / "a.launch").read_text() == FINE


@pytest.mark.usefixtures("folder")
def test_standard_input_is_formatted_to_standard_output(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.stdin", SimpleNamespace(buffer=io.BytesIO(UGLY.encode())))
    assert main(["format", "-"]) == 0
    assert capsys.readouterr().out == FINE


def test_link_stays_a_link(folder: Path) -> None:
    (folder / "real").mkdir()
    (folder / "real" / "c.launch").write_text(UGLY)
    (folder / "c.launch").symlink_to("real/c.launch")
    assert main(["format", "c.launch"]) == 0
    assert (folder / "c.launch").is_symlink()
    assert (folder / "real" / "c.launch").read_text() == FINE


def test_folder_without_launch_files_is_not_called_formatted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a.launch", "b.launch"):
        (folder / name).rename(folder / f"{name}.py")
    assert main(["format", "--check"]) == 2
    message = "nothing was formatted: no launch file is there; 2 Python launch files of ROS 2 were not read\n"
    assert capsys.readouterr().err == message
