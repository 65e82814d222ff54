import os
import stat
import subprocess
import time
from pathlib import Path

import pytest

from ur.web.access.roles import TOKEN_LIFE, Role
from ur.web.server.links import LinkFiles, admit_script, make_token


def admit(home: Path, token: str, role: Role) -> Path:
    """Run the script as a user with this home; return the folder of the server's state."""
    environment = {"PATH": os.environ["PATH"], "HOME": str(home)}
    subprocess.run(["sh", "-c", admit_script(token, role)], env=environment, check=True)
    return home / ".local/state/ubiquity_launches/web"


@pytest.mark.parametrize("role", [Role.LOOK, Role.DRIVE])
def test_link_that_the_script_admits_is_good_for_one_login(tmp_path: Path, role: Role) -> None:
    token = make_token()
    links = LinkFiles(admit(tmp_path, token, role))
    assert links.use(make_token()) is None
    assert links.use(token) is role
    assert links.use(token) is None


def test_link_ends_in_time_and_leaves_nothing(tmp_path: Path) -> None:
    token = make_token()
    state = admit(tmp_path, token, Role.DRIVE)
    assert LinkFiles(state).use(token, time.time() + TOKEN_LIFE + 10.0) is None
    assert list((state / "links").iterdir()) == []


def test_neither_script_nor_file_holds_the_token_and_nobody_else_reads_it(tmp_path: Path) -> None:
    token = make_token()
    state = admit(tmp_path, token, Role.LOOK)
    (file,) = (state / "links").iterdir()
    assert token not in admit_script(token, Role.LOOK) + str(file) + file.read_text()
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert stat.S_IMODE(file.parent.stat().st_mode) == 0o700


@pytest.mark.parametrize("token", [None, 7, "", "../sessions-8090.json", "x" * 1000, "é"])
def test_what_is_no_token_uses_no_link_up(tmp_path: Path, token: object) -> None:
    good = make_token()
    links = LinkFiles(admit(tmp_path, good, Role.LOOK))
    assert links.use(token) is None
    assert links.use(good) is Role.LOOK


def test_damaged_file_grants_nothing(tmp_path: Path) -> None:
    token = make_token()
    state = admit(tmp_path, token, Role.DRIVE)
    (file,) = (state / "links").iterdir()
    file.write_bytes(b"root\xff")
    assert LinkFiles(state).use(token) is None


def test_server_without_links_needs_no_folder(tmp_path: Path) -> None:
    assert LinkFiles(tmp_path / "nothing").use(make_token()) is None
