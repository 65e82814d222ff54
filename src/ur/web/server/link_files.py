"""Links to a page that runs as a service: other commands make them, and a private file admits each.

The file has the hash of the link's token as its name, and a role as its content. The token itself is never in a file or
on a command line.
"""

import math
import os
import re
import secrets
import shlex
import time
from contextlib import suppress
from pathlib import Path

from ur.web.access.roles import TOKEN_LIFE, Role, hash_secret

_FOLDER = "links"
_NAME = re.compile(r"[0-9a-f]{64}", re.ASCII)
_LONGEST_TOKEN = 128
_CLEAR_EVERY = 60.0  # s: a login attempt does not scan the folder more often
_ADMIT = """\
umask 077
folder="${{XDG_STATE_HOME:-$HOME/.local/state}}/ubiquity_launches/web/{folder}"
mkdir -p "$folder" && printf '%s\\n' {role} >"$folder/new-$$" && mv -f "$folder/new-$$" "$folder/{name}"
"""


def make_token() -> str:
    """Return a new token for a link."""
    return secrets.token_urlsafe(18)


def admit_script(token: str, role: Role) -> str:
    """Return the shell script that admits a token at the server of its user, for one login within an hour."""
    script = _ADMIT.format(folder=_FOLDER, role=role.value, name=hash_secret(token))
    return f"bash -lc {shlex.quote(script)}"  # a login shell: the server has its variables, too


class LinkFiles:
    """The links in a folder, each valid for one login within `TOKEN_LIFE` of its creation by this computer's clock."""

    def __init__(self, state: Path) -> None:
        """Open the links below `state`, the folder of sessions and log."""
        self._folder = state / _FOLDER
        self._cleared = -math.inf

    def use(self, token: object, now: float | None = None) -> Role | None:
        """Use a link up: return its role; None if it is unknown, used, or too old.

        `now` is in seconds since 1970, by default the present time.
        """
        now = time.time() if now is None else now
        if abs(now - self._cleared) > _CLEAR_EVERY:
            self._cleared = now
            self._clear(now)
        if not isinstance(token, str) or not 0 < len(token) <= _LONGEST_TOKEN or not token.isascii():
            return None
        path = self._folder / hash_secret(token)
        try:
            with path.open(encoding="ascii") as file:
                text = file.read(16).strip()
                made = os.fstat(file.fileno()).st_mtime
            path.unlink()  # the process that removes the file has used the link, which is valid once
        except (OSError, UnicodeDecodeError):
            return None
        if now - made > TOKEN_LIFE:
            return None
        return Role(text) if text in (Role.LOOK.value, Role.DRIVE.value) else None

    def _clear(self, now: float) -> None:
        with suppress(OSError):
            for path in self._folder.iterdir():
                if now - path.stat().st_mtime > TOKEN_LIFE or not _NAME.fullmatch(path.name):
                    path.unlink()
