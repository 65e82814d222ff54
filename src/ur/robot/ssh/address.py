"""The address of a login: user and host."""

import re
from dataclasses import dataclass

from ur.source.diagnostic import user_error

_USER = re.compile(r"[a-z_][a-z0-9_-]{0,31}")
_HOST = re.compile(r"[A-Za-z0-9]([A-Za-z0-9.:-]*[A-Za-z0-9])?")


@dataclass(frozen=True, slots=True)
class Address:
    """The user to log in as, and the computer."""

    user: str
    host: str

    def __str__(self) -> str:
        return f"{self.user}@{self.host}"


def parse_address(text: str, default_user: str) -> Address:
    """Read [USER@]HOST; a HOST without a dot is the zeroconf name HOST.local. Raises UserError."""
    user, at, host = text.rpartition("@")
    user = user if at else default_user
    if not _USER.fullmatch(user) or not _HOST.fullmatch(host):
        raise user_error(
            f"{text!r} is not an address, expected HOST or USER@HOST, for instance ros@robot.local",
            rule="bad-address",
            subject=text,
        )
    return Address(user, host if "." in host or ":" in host else f"{host}.local")
