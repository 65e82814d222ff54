"""A password that has to be changed at the first login: which question gets which password."""

from pathlib import Path

import pytest

from ur.robot.ssh.address import Address
from ur.robot.ssh.expired import renew_password
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError

ASK = 'ask() { printf "%s" "$1"; read -r x; echo "$1$x" >>"$0.log"; echo; }\n'
DONE = 'echo "passwd: password updated successfully"\n'


def renew(folder: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> str:
    """All that was answered to a computer that runs this in place of passwd."""
    program = folder / "ssh"
    program.write_text(f"#!/bin/bash\n{ASK}{script}")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")
    try:
        renew_password(Address("ros", "robot.local"), Secret("old-one"), Secret("new-one"), [])
    finally:
        log = (folder / "ssh.log").read_text() if (folder / "ssh.log").exists() else ""
    return log


def test_present_password_is_given_once_and_the_new_one_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script = 'ask "Current password: "; ask "New password: "; ask "Retype new password: "\n' + DONE
    log = renew(tmp_path, monkeypatch, script)
    assert log == "Current password: old-one\nNew password: new-one\nRetype new password: new-one\n"


@pytest.mark.parametrize(
    "script",
    [
        'ask "Current password: "; ask "Current password: "; ask "Password: "\n',
        'ask "New password: "; ask "Retype new password: "\n',
        "exec yes $'\\e]0;x'\n",
    ],
)
def test_computer_that_refuses_the_present_one_does_not_learn_the_new_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str
) -> None:
    with pytest.raises(UserError):
        renew(tmp_path, monkeypatch, script)
    log = tmp_path / "ssh.log"
    assert "new-one" not in (log.read_text() if log.exists() else "")
