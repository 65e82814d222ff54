"""Asking a robot for its clock and its services: as it answers, and when it does not."""

import threading
import time
from pathlib import Path

import pytest

from ur.robot.discovery.ask import ask_robot, best_offset, explain_refusal, parse_services

LISTED = """\
ubiquity-drive.service  loaded activating auto-restart ROS on this robot: drive
ubiquity-master.service loaded active     running      ROS on this robot: master
ubiquity-gone.service   not-found inactive dead        ubiquity-gone.service
"""


@pytest.fixture
def ssh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A program in place of ssh, which runs the last word."""
    program = tmp_path / "ssh"
    program.write_text('#!/bin/bash\nsystemctl() { :; }; eval "${@: -1}"\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    return program


def test_services_are_read_from_the_list_of_systemctl() -> None:
    assert parse_services(LISTED.splitlines()) == (("drive", "starting"), ("master", "active"))


def test_quickest_answer_tells_the_offset() -> None:
    readings = [(0.0, 9.0, 4.0), (5.0, 10.01, 5.02), (6.0, 12.0, 8.0)]
    assert best_offset(readings) == pytest.approx(4.99)
    assert best_offset([]) is None


def test_clock_that_differs_is_told_by_how_much(ssh: Path) -> None:
    assert ssh.exists()
    answer = ask_robot("ros@10.0.0.2", ["bob"], 60.0, lambda: time.time() - 100.0, threading.Event())
    assert answer.services == ()
    assert answer.offset is not None
    assert 40.0 <= answer.offset <= 100.0


@pytest.mark.parametrize("script", ["exit 255", "echo end", "echo end; read x; echo no number"])
def test_robot_that_breaks_off_has_said_nothing_of_its_clock(ssh: Path, script: str) -> None:
    ssh.write_text(f"#!/bin/bash\n{script}\n")
    assert ask_robot("ros@10.0.0.2", ["bob"], 60.0, time.time, threading.Event()).offset is None


def test_robot_that_says_nothing_is_not_waited_for_once_it_is_over(ssh: Path) -> None:
    ssh.write_text("#!/bin/bash\nexec sleep 1000\n")
    over = threading.Event()
    over.set()
    assert ask_robot("ros@10.0.0.2", ["bob"], 1000.0, time.time, over).services is None


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        ("No ED25519 host key is known for eve.local\nHost key verification failed.\n", "host key unknown"),
        ("@    WARNING: REMOTE HOST IDENTIFICATION HAS CHANGED!     @\n", "another host key"),
        ("ros@10.0.0.2: Permission denied (publickey).\n", "key refused"),
        ("", "no answer in 5 s"),
    ],
)
def test_robot_that_does_not_answer_has_a_reason(said: str, reason: str) -> None:
    assert explain_refusal(said, 5.0) == reason


def test_robot_is_asked_by_each_name_under_which_its_key_may_be_known(ssh: Path) -> None:
    words = 'case "$*" in *HostKeyAlias=bob.local*) ;; *) echo Host key verification failed. >&2; exit 255;; esac'
    ssh.write_text(f"#!/bin/bash\n{words}\n{ssh.read_text().splitlines()[1]}\n")
    answer = ask_robot("ros@10.0.0.2", ["eve", "bob", "x"], 60.0, time.time, threading.Event())
    assert (answer.known_as, answer.refused, answer.services) == ("bob", "", ())
    answer = ask_robot("ros@10.0.0.2", ["eve", "x"], 60.0, time.time, threading.Event())
    assert (answer.known_as, answer.refused, answer.services) == ("", "host key unknown", None)
