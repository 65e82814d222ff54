"""Links to the page, as text and as a QR code. Imports nothing of the server."""

import io
import socket

from ur.source.diagnostic import UserError, error

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
            help_ = "connect to a network, or leave out --phone"
            raise UserError(error(message, rule="no-network", help=help_)) from None
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
