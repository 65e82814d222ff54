"""Links to the page, as text and as a QR code. Imports nothing of the server."""

from __future__ import annotations

import io

FIRST_PORT = 8090
"""The port of a page that runs as a service; others take the first free one from here on."""

LISTENERS = "everybody in this network can read what the page and the robot say: use a network that you trust"


def make_link(host: str, port: int, token: str) -> str:
    """The address that logs in with a token. It stands behind the `#`, so browsers do not send it."""
    return f"http://{host}:{port}/login#{token}"


def draw_code(link: str, *, colours: bool) -> str:
    """The QR code of a link, for a terminal; with `colours` black on white whatever the terminal's own colours are."""
    import segno

    drawing = io.StringIO()
    segno.make_qr(link, error="m").terminal(drawing, border=2, compact=True)
    lines = drawing.getvalue().splitlines()
    return "\n".join(f"\x1b[97;40m{line}\x1b[0m" if colours else line for line in lines)
