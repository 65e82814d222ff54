"""A public key is one line of one type; nothing else gets into authorized_keys or known_hosts."""

import subprocess
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.robot.doctor.observe import parse_side
from ur.robot.doctor.rules.login import _ONE_KEY
from ur.robot.setup.facts import ComputerFacts, FileState
from ur.robot.setup.keys import AUTHORIZED, KEY, WantedOwnLogin, allowed_key, known_host
from ur.robot.ssh.host_key import parse_public_key
from ur.source import UserError

GOOD = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIEFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFBQUFB"
OTHER = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAIEJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJCQkJC"
BAD = [
    "",
    "\n",
    "ssh-ed25519",
    f"{GOOD} a@b\n{OTHER} evil",
    f"{GOOD} a@b\r{OTHER} evil",
    f"{GOOD} a@b\n\n",
    f"\n{GOOD}",
    f" {GOOD}",
    f'command="touch /tmp/x" {GOOD}',
    f"restrict {GOOD}",
    f"@cert-authority * {GOOD}",
    f"# {GOOD}",
    f"{GOOD} \x1b]0;t\x07",
    f"{GOOD} {'x' * 101}",
    f"{GOOD}  two blanks",
    f"{GOOD}x",
    GOOD[:-1],
    GOOD.replace("ssh-ed25519", "ssh-rsa"),
    GOOD.replace("ssh-ed25519", "SSH-ED25519"),
    "ssh-ed25519 AAAAB3NzaC1yc2EAAAADAQABAAABgQC7",
    "ssh-rsa AAAAB3NzaC1yc2EAAAADAQABAAABgQC7 a@b",
    "ecdsa-sha2-nistp256 AAAAE2VjZHNhLXNoYTItbmlzdHAyNTYAAAAI a@b",
]


@pytest.mark.parametrize("comment", ["", " ros@bob", " the key of Bob (2)", " " + "x" * 100])
def test_key_is_read_with_its_comment(comment: str) -> None:
    read = parse_public_key(f"{GOOD}{comment}\n")
    assert (read.key, str(read)) == (GOOD, f"{GOOD}{comment}")


def test_key_of_ssh_keygen_is_read(tmp_path: Path) -> None:
    command = ["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-C", "pat@laptop", "-f", str(tmp_path / "key")]
    subprocess.run(command, check=True)
    assert parse_public_key((tmp_path / "key.pub").read_text()).comment == "pat@laptop"


@pytest.mark.parametrize("text", BAD)
def test_anything_else_is_an_error_that_names_the_file(text: str) -> None:
    with pytest.raises(UserError, match=r"id_ed25519\.pub is not a public key"):
        allowed_key("login from bob", text)
    with pytest.raises(UserError, match=r"ssh_host_ed25519_key\.pub is not a public key"):
        known_host("host key of bob", "bob", text)


@given(st.text())
def test_no_text_makes_two_lines_or_options(text: str) -> None:
    try:
        line = allowed_key("x", text).line
    except UserError:
        return
    assert line.startswith("ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAI")
    assert line.isprintable()


def test_key_of_two_lines_is_no_change_that_never_lasts() -> None:
    # Such a file made the set-up append to authorized_keys again and again.
    files = {f"{KEY}.pub": FileState(f"{GOOD} a\n{OTHER} b\n"), AUTHORIZED: FileState(f"{GOOD} a\n{OTHER} b\n")}
    item = WantedOwnLogin("login to itself")
    with pytest.raises(UserError, match="is not a public key"):
        item.plan(ComputerFacts("ros", "/home/ros", "bob", "", "", frozenset(), files=files))


def test_doctor_takes_no_key_but_one() -> None:
    sample = (Path(__file__).parents[1] / "doctor/side.txt").read_text()
    before = parse_side(sample).public_key
    assert before
    assert parse_side(sample.replace(before, f'command="x" {before}')).public_key == ""
    assert parse_side(sample.replace(before, f"{before}\n{OTHER} evil")).public_key == ""


def test_key_that_the_doctor_fetches_is_one_line() -> None:
    text = f'command="x" {GOOD} evil\nssh-rsa AAAA\n{GOOD} ros@bob\n{OTHER} evil\n'
    done = subprocess.run(["sh", "-c", f"cat {_ONE_KEY}"], input=text, capture_output=True, text=True, check=True)
    assert done.stdout == f"{GOOD} ros@bob\n"
