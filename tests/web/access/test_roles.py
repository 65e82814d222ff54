from __future__ import annotations

import pytest

from ur.web.access.roles import (
    SESSION_LIFE,
    TOKEN_LIFE,
    Ledger,
    Role,
    add_token,
    add_viewer,
    end_session,
    find_session,
    find_viewer,
    note_use,
    read_sessions,
    use_token,
    write_sessions,
)


def log_in(role: Role = Role.DRIVE, now: float = 0.0) -> tuple[Ledger, str]:
    ledger, token = add_token(Ledger(), role, now)
    ledger, secret = use_token(ledger, token, "a phone", now)
    assert secret is not None
    return ledger, secret


def test_link_is_good_for_one_login() -> None:
    ledger, token = add_token(Ledger(), Role.LOOK, 0.0)
    ledger, secret = use_token(ledger, token, "a phone", 1.0)
    assert secret is not None
    found = find_session(ledger, secret, 1.0)
    assert found is not None
    assert (found[1].role, found[1].name) == (Role.LOOK, "a phone")
    assert use_token(ledger, token, "a thief", 2.0) == (ledger, None)


def test_link_and_session_end_in_time_and_use_prolongs_a_session() -> None:
    ledger, token = add_token(Ledger(), Role.DRIVE, 0.0)
    assert use_token(ledger, token, "", TOKEN_LIFE + 1.0)[1] is None
    ledger, secret = log_in()
    assert find_session(ledger, secret, SESSION_LIFE + 1.0) is None
    used = note_use(ledger, secret, 86400.0)
    assert find_session(used, secret, SESSION_LIFE + 1.0) is not None
    assert note_use(used, secret, 86401.0) is used


@pytest.mark.parametrize("secret", [None, "", "x", "é" * 20, "a" * 10000, 7, ["a"]])
def test_what_is_no_secret_opens_nothing(secret: object) -> None:
    ledger, _ = log_in()
    assert find_session(ledger, secret, 0.0) is None
    assert use_token(ledger, secret, "", 0.0)[1] is None


def test_neither_ledger_nor_file_holds_a_secret_and_sessions_outlive_the_server() -> None:
    ledger, secret = log_in()
    text = write_sessions(ledger)
    assert secret not in text
    assert secret not in repr(ledger)
    assert find_session(read_sessions(text), secret, 1.0) == find_session(ledger, secret, 1.0)
    assert find_session(end_session(ledger, secret), secret, 1.0) is None


@pytest.mark.parametrize("text", ["", "[]", "{", '{"k": 3}', '{"k": {"role": "root", "until": 1e12}}', "[" * 9999])
def test_damaged_files_hold_no_sessions(text: str) -> None:
    assert read_sessions(text).sessions == {}


def test_names_of_sessions_are_one_line() -> None:
    ledger, token = add_token(Ledger(), Role.DRIVE, 0.0)
    ledger, secret = use_token(ledger, token, "a\x1b[31m\nphone" + "x" * 100, 0.0)
    found = find_session(ledger, secret, 0.0)
    assert found is not None
    assert found[1].name.isprintable()
    assert len(found[1].name) <= 40


def test_viewer_link_is_good_again_and_again_and_is_no_session() -> None:
    ledger, secret = add_viewer(Ledger(), Role.LOOK, "Foxglove")
    found = find_viewer(ledger, secret)
    assert found is not None
    assert (found[1].role, found[1].name) == (Role.LOOK, "Foxglove")
    assert find_viewer(ledger, secret) == found
    assert find_session(ledger, secret, 0.0) is None
    assert use_token(ledger, secret, "x", 0.0)[1] is None
    for wrong in ("", "x", None, 3, secret + "x"):
        assert find_viewer(ledger, wrong) is None
    assert find_viewer(read_sessions(write_sessions(ledger)), secret) is None  # it ends with the server


def test_logins_leave_viewer_links_alone() -> None:
    ledger, secret = add_viewer(Ledger(), Role.DRIVE, "Foxglove")
    ledger, token = add_token(ledger, Role.DRIVE, 0.0)
    ledger, session = use_token(ledger, token, "a phone", 0.0)
    assert find_viewer(end_session(ledger, session), secret) is not None
