"""Ways to be told that a robot cannot be set up."""

from __future__ import annotations

import pytest

from ur.robot.setup.robot import explain_sudo
from ur.robot.ssh.openssh import Address


@pytest.mark.parametrize(
    ("said", "given", "message", "help"),
    [
        ("sudo: a password is required", False, "sudo wants a password", "expected the password of ros"),
        ("sudo: 1 incorrect password attempt", True, "sudo refuses this password", "expected the password of ros"),
        ("ros is not in the sudoers file.", True, "ros may not use sudo", "usermod"),
        ("Sorry, user ros may not run sudo on bob.", False, "ros may not use sudo", "usermod"),
        ("sh: 1: sudo: not found", False, "sudo is not installed", "apt-get install sudo"),
    ],
)
def test_refusal_of_sudo_is_explained(said: str, given: bool, message: str, help: str) -> None:
    diagnostic = explain_sudo(Address("ros", "robot.local"), said, given=given).diagnostics[0]
    assert message in diagnostic.message
    assert help in (diagnostic.help or "")
