"""Public keys as computers report them: one line, one type, one comment; any other text is refused."""

import re
from dataclasses import dataclass

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
