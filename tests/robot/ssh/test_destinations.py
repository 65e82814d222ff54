"""No destination of ssh can be taken for an option, whoever named it."""

import re
from pathlib import Path

import pytest

from ur.robot.ssh.address import Address, parse_address
from ur.robot.ssh.openssh import SshShell
from ur.source import UserError

SOURCE = Path(__file__).parents[3] / "src"


def test_shared_connection_ends_its_options() -> None:
    words = SshShell(Address("-oProxyCommand=x", "bob.local"), ["-T"])._words("true", root=False)
    assert words[words.index("-oProxyCommand=x@bob.local") - 1] == "--"


def test_scripts_end_the_options_of_ssh() -> None:
    for path in SOURCE.rglob("*.py"):
        for line in path.read_text().splitlines():
            if re.search(r"ssh-keyscan .*\{|f\"ssh \{", line):
                assert " -- " in line, line


@pytest.mark.parametrize(
    "text", ["-oProxyCommand=x", "-l", "a@-oX", "-oX@bob", "bob;x", "a b", "$(x)", "", "@", "a@b@-c"]
)
def test_address_that_is_an_option_is_refused(text: str) -> None:
    with pytest.raises(UserError):
        parse_address(text, "ros")
