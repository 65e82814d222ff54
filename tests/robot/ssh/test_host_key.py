"""Host keys: looked at without offering anything, shown as ssh-keygen shows them, and insisted on."""

import subprocess
from pathlib import Path

import pytest

from ur.robot.ssh.address import Address
from ur.robot.ssh.host_key import HostKey, check_known, parse_fingerprint
from ur.robot.ssh.openssh import host_key_options


def make_key(path: Path) -> HostKey:
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", str(path)], check=True)
    return HostKey(" ".join(path.with_suffix(".pub").read_text().split()[:2]))


def test_fingerprint_is_that_of_ssh_keygen(tmp_path: Path) -> None:
    key = make_key(tmp_path / "key")
    words = ["ssh-keygen", "-lf", str(tmp_path / "key.pub")]
    said = subprocess.run(words, check=True, capture_output=True, text=True).stdout
    assert key.fingerprint == said.split()[1]
    assert parse_fingerprint(f" {key.fingerprint}=\n") == key.fingerprint


@pytest.mark.parametrize("text", ["", "SHA256:short", "MD5:aa:bb", f"SHA256:{'a' * 42}!", f"sha256:{'a' * 43}"])
def test_other_text_is_no_fingerprint(text: str) -> None:
    with pytest.raises(ValueError, match="expected SHA256: and 43 characters"):
        parse_fingerprint(text)


@pytest.mark.parametrize(
    ("said", "code", "state"),
    [
        ("", 0, "known"),
        ("ros@robot.local: Permission denied (publickey,password).", 255, "known"),
        ("No ED25519 host key is known for robot.local\nHost key verification failed.", 255, "unknown-host-key"),
        ("@ REMOTE HOST IDENTIFICATION HAS CHANGED! @\nHost key verification failed.", 255, "changed-host-key"),
        ("ssh: Could not resolve hostname robot.local: Name or service not known", 255, "unknown-host"),
    ],
)
def test_host_key_is_compared_before_anything_is_offered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, said: str, code: int, state: str
) -> None:
    program = tmp_path / "ssh"
    program.write_text(f'#!/bin/sh\necho "$@" >{tmp_path}/words\necho "{said}" >&2\nexit {code}\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    assert check_known(Address("ros", "robot.local")) == state
    words = (tmp_path / "words").read_text()
    for setting in ("StrictHostKeyChecking=yes", "PreferredAuthentications=none", "PubkeyAuthentication=no"):
        assert setting in words
    assert words.endswith("-- ros@robot.local true\n")


def test_no_login_takes_a_host_key_that_nobody_has_confirmed(tmp_path: Path) -> None:
    for known_hosts in (None, tmp_path / "known_hosts"):
        assert "StrictHostKeyChecking=yes" in host_key_options(known_hosts)
