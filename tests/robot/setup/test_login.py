"""Which passwords a robot gets, and when: the new one only after the present one, at the first contact."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from ur.robot.setup.login import Task, _enter_sudo, _explain_refusal, _list_tries
from ur.robot.setup.robot_states import WantedRobot
from ur.robot.ssh.address import Address
from ur.robot.ssh.failures import explain_failure
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import ShellResult
from ur.source.diagnostic import UserError

OLD, NEW = Secret("old"), Secret("new")
MET = Task(Address("ros", "robot.local"), WantedRobot("robot", "magni"), OLD, NEW, first_contact=True)
KNOWN = replace(MET, first_contact=False)


class LoginShell:
    """A robot that lets this computer in, with sudo that takes some passwords, and everything that it was sent."""

    address = MET.address
    sudo_reported = "sudo: 1 incorrect password attempt"

    def __init__(self, *, takes: Sequence[Secret | None], accepted: Sequence[Secret] = ()) -> None:
        self.takes, self.accepted = takes, frozenset(accepted)
        self.sent: list[Secret] = []
        self.allowed: Sequence[Secret] = ()

    def find_sudo(self, candidates: Sequence[Secret]) -> bool:
        if None in self.takes:
            return True
        for one in candidates:
            self.sent.append(one)
            if one in self.takes:
                self.accepted |= {one}
                return True
        return False

    def run(self, _: str, *, root: bool, stdin: Secret) -> ShellResult:
        assert root
        password = Secret(stdin.reveal().split("\n")[1])
        self.sent.append(password)
        return ShellResult(0 if password in self.takes else 1, "", "")

    def allow(self, candidates: Sequence[Secret]) -> None:
        self.allowed = candidates


def enter(task: Task, shell: Any) -> None:
    _enter_sudo(task, shell)


def test_new_password_is_no_way_in_at_the_first_contact() -> None:
    assert [one.password for one in _list_tries(MET, Path("pinned"))] == [None, OLD]
    assert [one.password for one in _list_tries(KNOWN, None)] == [None, OLD, NEW]


def test_host_that_refuses_the_present_password_for_sudo_does_not_get_the_new_one() -> None:
    shell = LoginShell(takes=[NEW])
    with pytest.raises(UserError, match="sudo refuses this password"):
        enter(MET, shell)
    assert shell.sent == [OLD]
    # A robot that this computer knows may have got it in a run that was interrupted.
    known = LoginShell(takes=[NEW])
    enter(KNOWN, known)
    assert known.sent == [OLD, NEW]


def test_host_that_asks_for_no_password_is_asked_about_the_present_one_first() -> None:
    shell = LoginShell(takes=[None])
    with pytest.raises(UserError, match="is not sent the new one"):
        enter(MET, shell)
    assert shell.sent == [OLD]
    assert shell.allowed == ()
    honest = LoginShell(takes=[None, OLD])
    enter(MET, honest)
    assert honest.allowed == [OLD, NEW]


def test_password_that_was_accepted_allows_the_new_one() -> None:
    shell = LoginShell(takes=[OLD])
    enter(MET, shell)
    assert (shell.sent, shell.allowed) == ([OLD], [OLD, NEW])


def test_other_robot_that_has_the_later_name_is_not_logged_in_to() -> None:
    def find(_: str) -> set[str]:
        return {"a key"}

    task = replace(MET, robot=WantedRobot("bob", "magni"))
    assert {one.address.host for one in _list_tries(task, Path("pinned"), find)} == {"robot.local"}
    assert {one.address.host for one in _list_tries(task, None, find)} == {"robot.local", "bob.local"}


def test_refusal_names_that_the_new_password_was_held_back() -> None:
    refused = explain_failure(MET.address, "ros@robot.local: Permission denied (password).")
    assert "the new password was not sent" in _explain_refusal(MET, refused).diagnostics[0].message
    assert _explain_refusal(KNOWN, refused) is refused
