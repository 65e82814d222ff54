"""No command reports that there is nothing in launch files that it has not read."""

from pathlib import Path

import pytest

from ur.cli.main import main

MANIFEST = '<package><name>my_robot</name><depend condition="$ROS_VERSION == 2">rclcpp</depend></package>'
READ = ("format --check", "get --missing")
UNREAD = "2 Python launch files of ROS 2 and 1 YAML launch file of ROS 2 were not read"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "my_robot"
    folder.mkdir()
    for name in ("drive.launch.py", "map_launch.py", "view.launch.yaml", "README.md"):
        (folder / name).write_text("def generate_launch_description(): ...\n")
    monkeypatch.chdir(folder)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    return folder


@pytest.mark.parametrize("words", READ)
def test_folder_with_launch_files_of_ros2_alone_is_not_called_fine(
    words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words.split()) == 2
    assert UNREAD in "".join(capsys.readouterr())


@pytest.mark.parametrize("words", ["format --check", "check --package"])
def test_launch_files_that_were_not_read_are_counted_beside_others(
    folder: Path, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "package.xml").write_text(MANIFEST)
    (folder / "a.launch").write_text("<launch>\n</launch>\n")
    main(words.split())
    assert UNREAD in "".join(capsys.readouterr())


def test_manifest_is_read_and_what_was_not_is_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "package.xml").write_text(MANIFEST)
    assert main(["get", "--missing"]) == 0
    assert capsys.readouterr().out == f"note: {UNREAD}\nnothing is missing of what was read\n"
