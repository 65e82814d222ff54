"""`ur shell`: what reaches the robot, and what is said when nothing does. With a stand-in for ssh."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from ur.cli.robots.shell import run_in_front, run_ssh
from ur.request.remote.connection import robot_address
from ur.robot.ssh.address import Address
from ur.robot.ssh.shell import run_process
from ur.source import UserError

BOB = Address("ros", "bob.local")
# Writes its last word down; says what it is told to into the log that -E names, and ends as it is told.
SSH = """#!/bin/bash
for last; do :; done
printf '%s' "$last" >"$PLACE/last"
printf '%s\\n' "$@" >"$PLACE/words"
while [ "$1" != -E ]; do shift; done
printf "$SAYS" >"$2"
exit "$ENDS"
"""

# Waits for what ends it, without a moment in which a signal could get lost.
WAITS = """#!{python}
import signal, sys
ends = {{signal.SIGINT, signal.SIGTERM, signal.SIGHUP}}
signal.pthread_sigmask(signal.SIG_BLOCK, ends)
print("ready", flush=True)
signal.sigwait(ends)
print("ended", flush=True)
sys.exit({code})
"""

HOSTILE = r"print('\x1b[1mbold\x1b[0m \xe9\x1b]0;title\x07\x1b[2J\x1b[5A\rnext\tend'); raise SystemExit('\x1b[1A')"


@pytest.fixture
def ssh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "ssh").write_text(SSH)
    (tmp_path / "ssh").chmod(0o755)
    for name, value in {"PATH": f"{tmp_path}:{os.defpath}", "PLACE": str(tmp_path), "SAYS": "", "ENDS": "0"}.items():
        monkeypatch.setenv(name, value)
    return tmp_path


@pytest.mark.parametrize(
    ("words", "arrives"),
    [(["ls | wc -l"], "ls | wc -l"), (["grep", "a b", "$HOME"], "grep 'a b' '$HOME'"), ([], "ros@bob.local")],
)
def test_one_word_is_a_line_and_several_arrive_as_they_are(ssh: Path, words: list[str], arrives: str) -> None:
    assert run_ssh(BOB, [], words) == 0
    assert (ssh / "last").read_text() == arrives
    assert "StrictHostKeyChecking=yes" in (ssh / "words").read_text()


@pytest.mark.parametrize("code", [0, 3, 255])
def test_exit_code_is_that_of_the_command(ssh: Path, monkeypatch: pytest.MonkeyPatch, code: int) -> None:
    del ssh
    monkeypatch.setenv("ENDS", str(code))
    assert run_ssh(BOB, [], ["true"]) == code


def test_failed_connection_is_explained(ssh: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    del ssh
    monkeypatch.setenv("ENDS", "255")
    monkeypatch.setenv("SAYS", "ssh: Could not resolve hostname bob.local: Name or service not known\n")
    with pytest.raises(UserError, match="no computer answers to this name"):
        run_ssh(BOB, [], [])


def test_closing_words_of_ssh_are_left_out(
    ssh: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    del ssh
    monkeypatch.setenv("SAYS", "Connection to bob.local closed.\nX11 forwarding request failed\n")
    run_ssh(BOB, [], [])
    assert capfd.readouterr().err == "X11 forwarding request failed\n"


def test_interrupt_is_for_ssh_and_not_for_us(ssh: Path) -> None:
    (ssh / "ssh").write_text(WAITS.format(python=sys.executable, code=7))
    program = "from ur.cli.robots.shell import run_ssh; from ur.robot.ssh.openssh import Address; import sys; "
    program += "sys.exit(run_ssh(Address('ros', 'bob.local'), [], ['x']))"
    with subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, start_new_session=True, text=True
    ) as process:
        assert process.stdout
        assert process.stdout.readline() == "ready\n"
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        assert process.wait(60) == 7


def test_missing_ssh_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(UserError, match="ssh is not installed"):
        run_ssh(BOB, [], [])


def test_robot_is_the_selected_one_unless_it_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    with pytest.raises(UserError, match="no robot given"):
        robot_address(None)
    (tmp_path / "ubiquity_launches").mkdir()
    (tmp_path / "ubiquity_launches/selection").write_text("eve\n")
    assert robot_address(None) == Address("ros", "eve.local")
    assert robot_address("pat@bob") == Address("pat", "bob.local")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_what_ends_us_ends_ssh(ssh: Path, number: signal.Signals) -> None:
    (ssh / "ssh").write_text(WAITS.format(python=sys.executable, code=9))
    program = "from ur.cli.robots.shell import run_ssh; from ur.robot.ssh.openssh import Address; import sys; "
    program += "sys.exit(run_ssh(Address('ros', 'bob.local'), [], ['x']))"
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        assert process.stdout.readline() == "ready\n"
        process.send_signal(number)
        assert process.stdout.readline() == "ended\n"
        assert process.wait(60) == 9


def test_output_of_a_robot_that_is_text_cannot_move_the_cursor(capfd: pytest.CaptureFixture[str]) -> None:
    assert run_in_front([sys.executable, "-c", HOSTILE], escaped=True) == 1
    assert capfd.readouterr().out == "\x1b[1mbold\x1b[0m é\\x1b]0;title\\x07\\x1b[2J\\x1b[5A\\rnext\tend\n\\x1b[1A\n"


def test_program_is_said_to_be_missing_also_where_a_folder_of_path_cannot_be_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sshfs").touch()  # not executable: as a folder that cannot be read, for a user who is root
    monkeypatch.setenv("PATH", str(tmp_path))
    for start in (run_in_front, lambda words: run_process(words, timeout=60.0, what="mounting a folder")):
        with pytest.raises(UserError) as caught:
            start(["sshfs"])
        assert "sshfs is not installed here" in caught.value.diagnostics[0].message
        assert caught.value.diagnostics[0].help == "run: ur setup"
