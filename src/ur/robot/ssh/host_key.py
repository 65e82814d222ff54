"""Host keys and public keys: offered keys, fingerprints, and known_hosts files that accept only one key."""

import base64
import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

from ur.robot.ssh.address import Address
from ur.robot.ssh.failures import explain_failure
from ur.robot.ssh.guard import private_folder
from ur.robot.ssh.openssh import CONNECT_SECONDS
from ur.robot.ssh.shell import ShellResult, run_process
from ur.source.diagnostic import user_error_about

# RFC 8709: "ssh-ed25519" and 32 bytes, each after its length; the first 19 bytes are the same for all keys.
PATTERN = "ssh-ed25519 AAAAC3NzaC1lZDI1NTE5AAAAI[A-P][A-Za-z0-9+/]{42}"
_KEY = re.compile(rf"({PATTERN})(?: ([!-~](?:[ -~]{{0,98}}[!-~])?))?")


@dataclass(frozen=True, slots=True)
class PublicKey:
    """A key: its type and its base64 text in one string, and the comment of its owner."""

    key: str
    comment: str

    def __str__(self) -> str:
        return f"{self.key} {self.comment}".rstrip()


def parse_public_key(text: str) -> PublicKey:
    """Read the text of a public key file. Raises ValueError unless it is a single ed25519 key without options.

    The line becomes part of authorized_keys or known_hosts: a second line would let another user log in.
    """
    found = _KEY.fullmatch(text.removesuffix("\n"))
    if found is None:
        raise ValueError("expected one line 'ssh-ed25519 KEY COMMENT', the comment of at most 100 plain characters")
    return PublicKey(found.group(1), found.group(2) or "")


_FINGERPRINT = re.compile(r"SHA256:[A-Za-z0-9+/]{43}")


@dataclass(frozen=True, slots=True)
class HostKey:
    """A computer's public host key: `key` is "ssh-ed25519 AAAA...", without a comment."""

    key: str

    @property
    def fingerprint(self) -> str:
        """The fingerprint, as ssh-keygen -l prints it."""
        digest = hashlib.sha256(base64.b64decode(self.key.split()[1])).digest()
        return f"SHA256:{base64.b64encode(digest).decode().rstrip('=')}"


def parse_fingerprint(text: str) -> str:
    """Read a fingerprint as ssh-keygen -l prints it. Raises ValueError."""
    found = text.strip().rstrip("=")
    if not _FINGERPRINT.fullmatch(found):
        raise ValueError(f"{text!r} is not the fingerprint of a host key, expected SHA256: and 43 characters")
    return found


def pin_host_key(folder: Path, host_key: HostKey) -> Path:
    """Write a known_hosts file with only this key, for any name; `folder` is private."""
    path = folder / "known_hosts"
    path.write_text(f"* {host_key.key}\n")
    return path


def find_known_keys(host: str) -> frozenset[HostKey]:
    """Return the host keys that this user's known_hosts has for a name."""
    done = run_process(["ssh-keygen", "-F", host], timeout=20, what="a known host key")
    rows = (line.split() for line in done.out.splitlines() if not line.startswith(("#", "@")))
    return frozenset(HostKey(f"{row[1]} {row[2]}") for row in rows if len(row) >= 3 and row[1] == "ssh-ed25519")


def check_known(address: Address) -> str:
    """Compare a computer's host key with the known one, without a login.

    Returns `known`, `unknown-host-key`, `changed-host-key`, or, where no host key was offered, the rule of the failure
    (see `explain_failure`). No secret and no public key is sent.
    """
    done = _probe_host_key(address, ["StrictHostKeyChecking=yes"])
    if done.code == 0:
        return "known"
    rule = explain_failure(address, done.err).diagnostics[0].rule
    return "known" if rule == "refused" else rule


def fetch_host_key(address: Address) -> HostKey:
    """Ask a computer for its host key, which is not trusted yet. No secret and no public key is sent.

    Raises UserError if it offers no key of type ed25519, or does not answer.
    """
    with private_folder() as folder:
        offered = folder / "offered"
        files = [f"UserKnownHostsFile={offered}", "GlobalKnownHostsFile=/dev/null", "HashKnownHosts=no"]
        # The file is private and removed at the end of this call: its content is only read.
        done = _probe_host_key(address, [*files, "StrictHostKeyChecking=accept-new", "HostKeyAlgorithms=ssh-ed25519"])
        text = offered.read_text(errors="replace") if offered.exists() else ""
    with_names = text.splitlines()[:1]
    try:
        return HostKey(parse_public_key(" ".join(with_names[0].split()[1:3])).key)
    except (IndexError, ValueError):
        if done.code == 0 or "no matching host key type" in done.err or "Permission denied" in done.err:
            raise user_error_about(
                str(address),
                "it offers no host key of type ed25519",
                rule="no-host-key",
                help="at that computer: sudo ssh-keygen -A; sudo systemctl restart ssh",
            ) from None
        raise explain_failure(address, done.err) from None


def _probe_host_key(address: Address, settings: list[str]) -> ShellResult:
    """Connect up to the exchange of the host key. The login is tried with method `none`, which sends no credentials."""
    none = ["BatchMode=yes", "PreferredAuthentications=none", "PubkeyAuthentication=no", "PasswordAuthentication=no"]
    none += ["KbdInteractiveAuthentication=no", "GSSAPIAuthentication=no", "HostbasedAuthentication=no"]
    quiet = ["ForwardAgent=no", "ForwardX11=no", "ClearAllForwardings=yes", "PermitLocalCommand=no", "ControlPath=none"]
    quiet += ["UpdateHostKeys=no", "LogLevel=ERROR", f"ConnectTimeout={CONNECT_SECONDS}"]
    options = [word for setting in (*settings, *none, *quiet) for word in ("-o", setting)]
    return run_process(
        ["ssh", "-T", *options, "--", str(address), "true"],
        timeout=CONNECT_SECONDS * 3,
        what=f"the host key of {address}",
    )
