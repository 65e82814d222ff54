"""Links to the page: as text, as a QR code, and in private files for a page that runs as a service."""

import io
import math
import os
import re
import secrets
import shlex
import socket
import time
from contextlib import suppress
from pathlib import Path

from ur.source.diagnostic import user_error
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


FIRST_PORT = 8090
"""The port of a page that runs as a service; others take the first free one from here on."""

LISTENERS = "every computer in this network can read the data of the page and the robot: use a network that you trust"


def make_link(host: str, port: int, token: str) -> str:
    """Return the address that logs in with a token, which follows the `#`, so that browsers do not send it."""
    return link_to(f"{host}:{port}", token)


def link_to(address: str, token: str) -> str:
    """Return the same for an address of the form HOST:PORT."""
    return f"http://{address}/login#{token}"


def find_address() -> str:
    """Return this computer's address in the network. Raises UserError without a network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing: the route determines the address
        except OSError:
            message = "this computer is in no network, expected one that the phone is in, too"
            raise user_error(message, rule="no-network", help="connect to a network, or leave out --phone") from None
        return str(probe.getsockname()[0])


def draw_code(link: str, *, colours: bool) -> str:
    """Return the QR code of a link for a terminal; with `colours`, black on white in a terminal of any colours."""
    import segno

    drawing = io.StringIO()
    segno.make_qr(link, error="m").terminal(drawing, border=2, compact=True)
    lines = drawing.getvalue().splitlines()
    return "\n".join(f"\x1b[97;40m{line}\x1b[0m" if colours else line for line in lines)


def draw_picture(link: str) -> str:
    """Return the QR code of a link as SVG, black on white."""
    import segno

    drawing = io.BytesIO()
    form = {"xmldecl": False, "nl": False, "border": 4, "scale": 8, "dark": "#000", "light": "#fff"}
    segno.make_qr(link, error="m").save(drawing, kind="svg", **form)
    return drawing.getvalue().decode()
