import os
from pathlib import Path

import pytest

from ur.source.user_folders import runtime_folder, user_folder


@pytest.mark.parametrize(
    ("environment", "folder"),
    [
        ({"HOME": "/home/me"}, "/home/me/.local/state"),
        ({"HOME": "/home/me", "XDG_STATE_HOME": "/state"}, "/state"),
        ({"HOME": "/home/me", "XDG_STATE_HOME": ""}, "/home/me/.local/state"),
        ({"HOME": "/home/me", "XDG_STATE_HOME": "state"}, "/home/me/.local/state"),
    ],
)
def test_state_folder_is_the_absolute_one_that_is_named_or_the_default(
    environment: dict[str, str], folder: str
) -> None:
    assert user_folder("XDG_STATE_HOME", environment) == folder


def test_each_variable_has_its_own_default() -> None:
    environment = {"HOME": "/home/me", "XDG_STATE_HOME": "/state"}
    assert user_folder("XDG_CONFIG_HOME", environment) == "/home/me/.config"
    assert user_folder("XDG_STATE_HOME", environment) == "/state"


def test_empty_home_is_the_one_of_the_account(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", "/home/account")
    assert user_folder("XDG_CONFIG_HOME", {"HOME": ""}) == "/home/account/.config"


def test_system_units_and_logins_have_the_same_runtime_folder(tmp_path: Path) -> None:
    unit = {"HOME": "/home/me"}
    login = {**unit, "XDG_RUNTIME_DIR": f"{tmp_path}/{os.getuid()}"}
    assert runtime_folder(unit, str(tmp_path)) == "/home/me/.local/state"
    (tmp_path / str(os.getuid())).mkdir()
    assert runtime_folder(unit, str(tmp_path)) == runtime_folder(login, str(tmp_path)) == f"{tmp_path}/{os.getuid()}"
