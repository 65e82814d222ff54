"""Hashes that are written to an image in place of passwords."""

import hashlib
import re

from ur.robot.image.volume import run_tool
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, error

_SALT = re.compile(r"\$6\$([./A-Za-z0-9]{1,16})\$[./A-Za-z0-9]{86}")


def hash_password(password: Secret, salt: str = "") -> str:
    """Return the SHA-512 crypt(3) hash of a login password, with a random salt unless one is given.

    Raises UserError.
    """
    words = ["openssl", "passwd", "-6", "-stdin", *(["-salt", salt] if salt else [])]
    done = run_tool(words, password.reveal().encode() + b"\n")
    hashed = done.stdout.decode().strip()
    if done.returncode or not _SALT.fullmatch(hashed):
        raise UserError(error("openssl made no hash of the password", rule="bad-password", help="choose another one"))
    return hashed


def is_hash_of(hashed: str, password: Secret) -> bool:
    """Return whether a hash, made by `hash_password`, is that of this password."""
    found = _SALT.fullmatch(hashed)
    return found is not None and hash_password(password, found[1]) == hashed


def derive_network_key(password: Secret, network: str) -> str:
    """Return the 64 hexadecimal digits of the WPA2 key for a network's password; 64 such digits are returned unchanged.

    The formula: IEEE 802.11i-2004, annex H.4 (PBKDF2 with HMAC-SHA1, 4096 rounds); wpa_passphrase computes the same.
    Raises UserError for an invalid password.
    """
    text = password.reveal()
    if re.fullmatch(r"[0-9A-Fa-f]{64}", text):
        return text.lower()
    if not 8 <= len(text) <= 63 or not all(" " <= letter <= "~" for letter in text):
        raise UserError(
            error(
                f"that cannot be the password of {network}, expected 8 to 63 letters, digits and signs of ASCII",
                rule="bad-password",
                subject=network,
            )
        )
    return hashlib.pbkdf2_hmac("sha1", text.encode(), network.encode(), 4096, 32).hex()
