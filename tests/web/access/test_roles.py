import pytest

from ur.web.access.roles import (
    DAY,
    SESSION_LIFE,
    TOKEN_LIFE,
    Ledger,
    LoginDevice,
    Role,
    add_token,
    add_viewer,
    choose_name,
    end_sessions,
    find_session,
    find_viewer,
    list_sessions,
    name_session,
    note_use,
    read_sessions,
    use_token,
    write_sessions,
)


def log_in(role: Role = Role.DRIVE, now: float = 0.0) -> tuple[Ledger, str]:
    ledger, token = add_token(Ledger(), role, now)
    ledger, secret = use_token(ledger, token, LoginDevice("a phone"), now)
    assert secret is not None
    return ledger, secret


def test_link_is_good_for_one_login() -> None:
    ledger, token = add_token(Ledger(), Role.LOOK, 0.0)
    ledger, secret = use_token(ledger, token, LoginDevice("a phone"), 1.0)
    assert secret is not None
    found = find_session(ledger, secret, 1.0)
    assert found is not None
    assert (found[1].role, found[1].name) == (Role.LOOK, "a phone")
    assert use_token(ledger, token, LoginDevice("a thief"), 2.0) == (ledger, None)


def test_link_and_session_end_in_time_and_use_does_not_prolong_a_session() -> None:
    ledger, token = add_token(Ledger(), Role.DRIVE, 0.0)
    assert use_token(ledger, token, LoginDevice(""), TOKEN_LIFE + 1.0)[1] is None
    ledger, secret = log_in()
    used = note_use(ledger, secret, SESSION_LIFE - 1.0)
    assert find_session(used, secret, SESSION_LIFE - 1.0) is not None
    assert find_session(used, secret, SESSION_LIFE + 1.0) is None
    assert list_sessions(used, SESSION_LIFE + 1.0) == {}
    ledger, token = add_token(Ledger(), Role.DRIVE, 0.0)
    ledger, short = use_token(ledger, token, LoginDevice("", life=DAY), 0.0)
    assert find_session(ledger, short, DAY - 1.0) is not None
    assert find_session(ledger, short, DAY + 1.0) is None


def test_session_knows_address_and_times_of_its_use() -> None:
    ledger, token = add_token(Ledger(), Role.DRIVE, 100.0)
    ledger, secret = use_token(ledger, token, LoginDevice("Linux", "192.168.1.7"), 100.0)
    assert secret is not None
    assert note_use(ledger, secret, 110.0) is ledger
    ledger = note_use(ledger, secret, 5000.0)
    ((number, grant),) = list_sessions(read_sessions(write_sessions(ledger)), 5000.0).items()
    assert (grant.name, grant.address, grant.first, grant.last) == ("Linux", "192.168.1.7", 100.0, 5000.0)
    assert list_sessions(end_sessions(ledger, [number]), 5000.0) == {}
    assert list_sessions(end_sessions(ledger, ["x"]), 5000.0) == {number: grant}


def test_each_session_has_a_name_of_its_own() -> None:
    ledger = Ledger()
    for _ in range(3):
        ledger, token = add_token(ledger, Role.DRIVE, 0.0)
        ledger, _ = use_token(ledger, token, LoginDevice("Linux"), 0.0)
    sessions = list_sessions(ledger, 0.0)
    assert [each.name for each in sessions.values()] == ["Linux", "Linux 2", "Linux 3"]
    ledger = name_session(ledger, list(sessions)[2], "linux")
    assert [each.name for each in list_sessions(ledger, 0.0).values()] == ["Linux", "Linux 2", "linux 3"]
    assert choose_name("x" * 99, ["x" * 40]) == "x" * 35 + " 2"
    assert choose_name("\x1b\n", []) == "a browser"


@pytest.mark.parametrize("secret", [None, "", "x", "é" * 20, "a" * 10000, 7, ["a"]])
def test_what_is_no_secret_opens_nothing(secret: object) -> None:
    ledger, _ = log_in()
    assert find_session(ledger, secret, 0.0) is None
    assert use_token(ledger, secret, LoginDevice(""), 0.0)[1] is None


def test_neither_ledger_nor_file_holds_a_secret_and_sessions_outlive_the_server() -> None:
    ledger, secret = log_in()
    text = write_sessions(ledger)
    assert secret not in text
    assert secret not in repr(ledger)
    assert find_session(read_sessions(text), secret, 1.0) == find_session(ledger, secret, 1.0)
    assert find_session(end_sessions(ledger, list_sessions(ledger, 1.0)), secret, 1.0) is None


@pytest.mark.parametrize("text", ["", "[]", "{", '{"k": 3}', '{"k": {"role": "root", "until": 1e12}}', "[" * 9999])
def test_damaged_files_hold_no_sessions(text: str) -> None:
    assert read_sessions(text).sessions == {}


def test_names_of_sessions_are_one_line() -> None:
    ledger, token = add_token(Ledger(), Role.DRIVE, 0.0)
    ledger, secret = use_token(ledger, token, LoginDevice("a\x1b[31m\nphone" + "x" * 100), 0.0)
    found = find_session(ledger, secret, 0.0)
    assert found is not None
    assert found[1].name.isprintable()
    assert len(found[1].name) <= 40


def test_viewer_link_is_good_again_and_again_and_is_no_session() -> None:
    ledger, secret = add_viewer(Ledger(), Role.LOOK)
    found = find_viewer(ledger, secret)
    assert found is not None
    assert (found[1].role, found[1].name) == (Role.LOOK, "Foxglove")
    assert find_viewer(ledger, secret) == found
    assert find_session(ledger, secret, 0.0) is None
    assert use_token(ledger, secret, LoginDevice("x"), 0.0)[1] is None
    for wrong in ("", "x", None, 3, secret + "x"):
        assert find_viewer(ledger, wrong) is None
    assert find_viewer(read_sessions(write_sessions(ledger)), secret) is None  # it ends with the server


def test_logins_leave_viewer_links_alone() -> None:
    ledger, secret = add_viewer(Ledger(), Role.DRIVE)
    ledger, token = add_token(ledger, Role.DRIVE, 0.0)
    ledger, _ = use_token(ledger, token, LoginDevice("a phone"), 0.0)
    assert find_viewer(end_sessions(ledger, list_sessions(ledger, 1.0)), secret) is not None
