"""`ur run FILE.py`: the script gets the environment of the selection, and runs in place of `ur`."""

from pathlib import Path

import pytest

from ur.cli.launch.run import is_script, run_script
from ur.cli.main import main
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError
from ur.source.project import launch_library


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_STATE_HOME"):
        monkeypatch.setenv(name, str(tmp_path / name))
    monkeypatch.setenv("UR_SELECTION", "")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_script_that_was_written_runs_as_a_node_with_its_own_arguments(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_VERSION", "1")
    assert main(["new", "script", "look", "--summary", 'Look "around".']) == 0
    text = (folder / "look.py").read_text(encoding="utf-8")
    assert text.startswith('"""Look \'around\'."""\n')
    compile(text, "look.py", "exec")
    assert is_script("look.py")
    assert not is_script("look")
    applied: list[Selection] = []
    runs: list[list[str]] = []
    run_script("look.py", ["--fast", "x:=1"], apply=applied.append, execute=lambda _, words: runs.append(words))
    assert len(applied) == 1
    assert runs == [[str(launch_library() / "lib" / "node"), str(folder / "look.py"), "--fast", "x:=1"]]


def test_script_without_any_ros_says_what_is_missing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_VERSION", "0")
    (folder / "look.py").touch()
    with pytest.raises(UserError, match="nodes run without ROS"):
        run_script("look.py", [], apply=lambda _: None)
