import subprocess
import sys
from pathlib import Path

import pytest

from ur.source.run_users import PAGE, describe_users, forget_user, list_users, note_user


def test_users_of_a_run_are_listed_until_they_leave(tmp_path: Path) -> None:
    assert list_users(str(tmp_path)) == []
    note_user(str(tmp_path), PAGE)
    note_user(str(tmp_path), "m_wander.5767")
    note_user(str(tmp_path), "m_wander.5767")
    assert list_users(str(tmp_path)) == ["m_wander.5767", PAGE]
    forget_user(str(tmp_path), PAGE)
    assert list_users(str(tmp_path)) == ["m_wander.5767"]


def test_user_whose_process_has_ended_is_none(tmp_path: Path) -> None:
    note = f"from ur.source.run_users import note_user; note_user({str(tmp_path)!r}, 'm_wander.1')"
    subprocess.run([sys.executable, "-c", note], check=True)
    assert len(list((tmp_path / "users").iterdir())) == 1
    assert list_users(str(tmp_path)) == []


def test_user_is_listed_among_many_that_have_ended(tmp_path: Path) -> None:
    note_user(str(tmp_path), "m_wander.1")
    for number in range(150):
        (tmp_path / "users" / f"keyboard_drive.{number}").write_text(f"{number} 0 keyboard_drive.{number}")
    assert list_users(str(tmp_path)) == ["m_wander.1"]


@pytest.mark.parametrize("text", ["", "1", "x y z", "1 None a", "\x00", "9" * 500])
def test_file_that_is_no_user_is_ignored(tmp_path: Path, text: str) -> None:
    (tmp_path / "users").mkdir()
    (tmp_path / "users" / "odd").write_text(text)
    assert list_users(str(tmp_path)) == []


def test_run_that_has_ended_has_no_users(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="gone"):
        note_user(str(tmp_path / "gone"), PAGE)
    forget_user(str(tmp_path / "gone"), PAGE)
    assert list_users(str(tmp_path / "gone")) == []


def test_users_are_named_in_a_clause() -> None:
    assert describe_users([]) == ""
    assert describe_users(["m_wander.5767"]) == "m_wander.5767 uses this robot"
    assert describe_users(["m_wander.5767", PAGE]) == "m_wander.5767 and a page use this robot"
