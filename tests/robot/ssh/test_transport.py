"""The transport: addresses, what ssh's words mean, and passwords that stay unseen."""

import shutil
import subprocess
import time
from pathlib import Path

import pytest

from ur.robot.ssh import askpass
from ur.robot.ssh.address import Address, parse_address
from ur.robot.ssh.askpass import answer_password
from ur.robot.ssh.failures import expired_password, explain_failure, is_expired, lost_connection
from ur.robot.ssh.openssh import connect
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell
from ur.source import UserError

BOOTING = (  # as sshd says it on Debian 12
    "System is booting up. Unprivileged users are not permitted to log in yet. Please come back later. "
    "For technical details, see pam_nologin(8)."
)


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("robot", Address("ros", "robot.local")),
        ("pi@robot.local", Address("pi", "robot.local")),
        ("10.0.0.2", Address("ros", "10.0.0.2")),
        ("fe80::1", Address("ros", "fe80::1")),
    ],
)
def test_address_is_read(text: str, address: Address) -> None:
    assert parse_address(text, "ros") == address


@pytest.mark.parametrize("text", ["", "a b", "-oProxyCommand=x", "ros@-x", "a;b@robot", "robot/x"])
def test_address_that_could_be_something_else_is_refused(text: str) -> None:
    with pytest.raises(UserError, match="is not an address"):
        parse_address(text, "ros")


@pytest.mark.parametrize(
    ("said", "rule"),
    [
        ("ssh: Could not resolve hostname robot.local: Name or service not known", "unknown-host"),
        ("ssh: connect to host robot.local port 22: Connection timed out", "no-answer"),
        ("ssh: connect to host robot.local port 22: Connection refused", "no-ssh"),
        ("@ WARNING: REMOTE HOST IDENTIFICATION HAS CHANGED! @\nHost key verification failed.", "changed-host-key"),
        ("No ED25519 host key is known for robot.local\nHost key verification failed.", "unknown-host-key"),
        ("ros@robot.local: Permission denied (publickey,password).", "refused"),
        ("kex_exchange_identification: read: Connection reset by peer", "no-login"),
        (f"{BOOTING}\n\nConnection closed by 10.0.0.2 port 22\r\n", "not-started"),
    ],
)
def test_failed_login_is_explained(said: str, rule: str) -> None:
    diagnostic = explain_failure(Address("ros", "robot.local"), said).diagnostics[0]
    assert diagnostic.rule == rule
    assert diagnostic.help
    assert "robot.local" in diagnostic.message


def test_computer_that_boots_is_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "ssh"
    program.write_text(
        f"#!/bin/sh\ncase $* in *ControlMaster=yes*) ;; *) exit 0;; esac\n"
        f'if [ ! -e "$0.tried" ]; then : >"$0.tried"; echo "{BOOTING}" >&2; exit 255; fi\n'
        "echo; echo 'ubiquity: logged in'; exec cat >/dev/null\n"
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    with connect(Address("ros", "robot.local")) as shell:
        assert shell.destination == "ros@robot.local"
    assert (tmp_path / "ssh.tried").exists()


@pytest.mark.parametrize("said", ["", "kex_exchange_identification: Connection closed by remote host\r\n"])
def test_shared_connection_that_ended_is_said_to_have_closed(said: str) -> None:
    diagnostic = lost_connection("ros@robot.local", said).diagnostics[0]
    assert diagnostic.message == "ros@robot.local: the connection has ended: it closed"
    assert diagnostic.help


def test_expired_password_is_recognised_and_the_way_out_is_told() -> None:
    said = "WARNING: Your password has expired.\nPassword change required but no TTY available.\n"
    assert is_expired(said)
    assert not is_expired("sudo: a password is required")
    diagnostic = expired_password(Address("ubuntu", "robot.local")).diagnostics[0]
    assert diagnostic.help
    assert "ssh ubuntu@robot.local" in diagnostic.help


def test_secret_shows_itself_to_nobody_who_does_not_ask() -> None:
    secret = Secret("hunter2")
    assert "hunter2" not in f"{secret} {secret!r} {[secret]}"
    assert secret.reveal() == "hunter2"


def ask(environment: dict[str, str], prompt: str) -> str:
    done = subprocess.run(
        [environment["SSH_ASKPASS"], prompt], env=environment, capture_output=True, text=True, check=False
    )
    return done.stdout


def test_password_is_given_once_and_only_for_a_password_question(tmp_path: Path) -> None:
    with answer_password(tmp_path, "hunter2") as environment:
        assert "hunter2" not in "".join(environment.values())
        assert "hunter2" not in "".join(path.read_text() for path in tmp_path.iterdir() if path.is_file())
        assert ask(environment, "Are you sure you want to continue connecting (yes/no)? ") == ""
        assert ask(environment, "ros@robot.local's password: ") == "hunter2\n"
        assert ask(environment, "ros@robot.local's password: ") == ""
    assert list(tmp_path.iterdir()) == []


def test_command_that_does_not_end_is_ended_with_all_it_started(tmp_path: Path) -> None:
    note = tmp_path / "pid"
    for patience in (0.5, 5.0, 60.0):  # long enough for the shell to start, however slow this computer is
        with pytest.raises(UserError, match="no answer within"):
            LocalShell().run(f"sleep 600 & echo $! >{note}; wait", timeout=patience)
        if note.exists() and note.read_text().endswith("\n"):
            break
    deadline = time.monotonic() + 60  # killed is not gone yet
    while runs(int(note.read_text())):
        assert time.monotonic() < deadline, "still there"
        time.sleep(0.01)


def test_command_that_answers_without_end_is_ended() -> None:
    for script in ("yes", "yes >&2"):
        with pytest.raises(UserError, match="and no end"):
            LocalShell(most=1 << 20).run(script)


def test_command_gets_its_input_and_both_outputs_come_back_whole() -> None:
    text = "é\r\n" * 200_000
    done = LocalShell().run("tee /dev/stderr; printf '\\377' >&2; exit 3", stdin=text)
    assert (done.code, done.out) == (3, "é\n" * 200_000)
    assert done.err.endswith("\udcff")
    assert LocalShell().run("exit 0", stdin=text).code == 0  # it does not want to know


def runs(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state not in ("Z", "X")


def test_password_is_answered_from_a_clone_below_a_path_with_a_quote(tmp_path: Path) -> None:
    clone = tmp_path / 'it\'s $HOME "here"'
    clone.mkdir()
    shutil.copy(askpass.__file__, clone / "askpass.py")
    with answer_password(tmp_path, "hunter2", str(clone / "askpass.py")) as environment:
        words = [environment["SSH_ASKPASS"], "pat@bob's password: "]
        done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
    assert (done.stdout, done.stderr) == ("hunter2\n", "")
