from pathlib import Path

import pytest

from ur.robot.sync.sync import check_paths, lock_sync, workspace_path
from ur.source.diagnostic import UserError


def test_paths_are_relative_to_the_current_folder_where_it_is_in_the_workspace(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "src/mine").mkdir(parents=True)
    (tmp_path / "link").symlink_to("src")
    monkeypatch.chdir(tmp_path)
    assert workspace_path("mine", tmp_path / "src") == "mine"
    assert workspace_path(str(tmp_path / "link/mine"), tmp_path / "link") == "mine"
    monkeypatch.chdir(tmp_path / "src/mine")
    assert workspace_path("a.launch", tmp_path / "src") == "mine/a.launch"
    assert workspace_path("..", tmp_path / "src") == ""
    with pytest.raises(UserError, match="is not in"):
        workspace_path("../..", tmp_path / "src")


def test_path_that_neither_side_has_is_refused() -> None:
    check_paths({"a": "a", ".": ""}, ["a/package.xml"], Path("src"), "bob")
    with pytest.raises(UserError, match="nothing of this name"):
        check_paths({"b": "b"}, ["a/package.xml"], Path("src"), "bob")


def test_second_sync_with_the_same_robot_is_refused(tmp_path: Path) -> None:
    with (
        lock_sync(tmp_path / "state/bob.json"),
        pytest.raises(UserError, match="another sync"),
        lock_sync(tmp_path / "state/bob.json"),
    ):
        pass
    with lock_sync(tmp_path / "state/bob.json"):
        pass
