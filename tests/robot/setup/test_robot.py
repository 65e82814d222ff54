"""Ways to be told that a robot cannot be set up; its clock."""

import pytest

from ur.robot.setup.login import explain_sudo
from ur.robot.setup.robot import set_clock
from ur.robot.ssh.address import Address
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import ShellResult


@pytest.mark.parametrize(
    ("said", "given", "message", "help"),
    [
        ("sudo: a password is required", False, "sudo requires a password", "expected the password of ros"),
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


class ClockShell:
    """A computer that knows what time it is."""

    destination = "ros@robot.local"

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.ran: list[tuple[str, bool]] = []

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> ShellResult:  # noqa: ARG002 - of the protocol
        self.ran.append((script, root))
        return ShellResult(0, f"{self.seconds:.0f}\n", "")


@pytest.mark.parametrize(
    ("there", "words"), [(1e9, "11574 days behind"), (2e9 + 500, "500 s ahead"), (2e9 + 60, ""), (2e9 - 60, "")]
)
def test_clock_that_is_far_off_is_set_and_no_other(there: float, words: str) -> None:
    shell, said = ClockShell(there), list[str]()
    set_clock(shell, lambda: 2e9, said.append)
    assert said == ([f"clock, which is {words}"] if words else [])
    assert shell.ran[1:] == ([("date -u -s @2000000000", True)] if words else [])
