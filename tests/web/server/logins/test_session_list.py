"""Logins as `ur web --sessions` lists and ends them, in files as a server leaves them."""

import time
from pathlib import Path

import pytest

from ur.source.diagnostic import UserError
from ur.web.access.roles import DAY, Ledger, LoginDevice, Role, find_session, open_session
from ur.web.server.logins.session_file import SessionFile
from ur.web.server.logins.session_list import draw_logins, end_logins, find_logins

NOW = time.mktime((2026, 11, 23, 12, 0, 0, 0, 0, -1))


def store(folder: Path, port: int, *devices: LoginDevice) -> list[str]:
    """A file of a server, and the secrets of its sessions."""
    ledger, secrets = Ledger(), []
    for device in devices:
        ledger, secret = open_session(ledger, Role.DRIVE, device, NOW)
        secrets.append(secret)
    file = SessionFile(folder / f"sessions-{port}.json")
    file.load()
    file.store(ledger)
    return secrets


def test_logins_of_all_servers_are_in_one_table(tmp_path: Path) -> None:
    assert draw_logins(find_logins(tmp_path / "nothing", NOW)) == ["no device is logged in"]
    store(tmp_path, 8090, LoginDevice("Linux", "192.168.1.7", DAY), LoginDevice("iPhone", "192.168.1.9", DAY))
    store(tmp_path, 8091, LoginDevice("Linux", "127.0.0.1", 30 * DAY))
    (tmp_path / "sessions-x.json").write_text("{}")
    lines = draw_logins(find_logins(tmp_path, NOW))
    assert sorted(line.split()[:4] for line in lines[1:]) == [
        ["Linux", "drive", "127.0.0.1", "8091"],
        ["Linux", "drive", "192.168.1.7", "8090"],
        ["iPhone", "drive", "192.168.1.9", "8090"],
    ]
    assert any(line.endswith("2026-11-23 12:00  2026-11-23 12:00  2026-11-24 12:00") for line in lines)
    assert len(find_logins(tmp_path, NOW + 2 * DAY)) == 1


def test_login_is_ended_by_its_name_and_others_stay(tmp_path: Path) -> None:
    first, second = store(tmp_path, 8090, LoginDevice("Linux"), LoginDevice("iPhone"))
    assert end_logins(find_logins(tmp_path, NOW), "linux") == 1
    ledger = SessionFile(tmp_path / "sessions-8090.json").load()
    assert find_session(ledger, first, NOW) is None
    assert find_session(ledger, second, NOW) is not None
    with pytest.raises(UserError) as problem:
        end_logins(find_logins(tmp_path, NOW), "iPhon")
    assert "did you mean 'iPhone'" in str(problem.value.diagnostics[0].help)
    assert end_logins(find_logins(tmp_path, NOW), "all") == 1
    assert find_logins(tmp_path, NOW) == []
    assert end_logins([], "all") == 0


@pytest.mark.parametrize("text", ["", "{", "\xff", '{"x": 3}'])
def test_damaged_files_list_no_logins(tmp_path: Path, text: str) -> None:
    (tmp_path / "sessions-8090.json").write_text(text, encoding="latin-1")
    assert find_logins(tmp_path, NOW) == []


def test_server_keeps_what_it_has_opened_while_another_process_ended_one(tmp_path: Path) -> None:
    path = tmp_path / "sessions-8090.json"
    store(tmp_path, 8090, LoginDevice("Linux"), LoginDevice("iPhone"))
    server = SessionFile(path)
    ledger = server.load()
    assert list(server.list_ended()) == []
    assert end_logins(find_logins(tmp_path, NOW), "iPhone") == 1
    ledger, secret = open_session(ledger, Role.LOOK, LoginDevice("Mac"), NOW)
    left = server.store(ledger)
    assert sorted(each.name for each in left.sessions.values()) == ["Linux", "Mac"]
    assert find_session(SessionFile(path).load(), secret, NOW) is not None
    assert path.stat().st_mode & 0o777 == 0o600
    path.unlink()
    assert len(server.list_ended()) == 2
