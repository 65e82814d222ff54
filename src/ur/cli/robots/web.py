"""`ur web`: one page that shows and drives a robot."""

from __future__ import annotations

import asyncio
import os

import click

from ur.request.environment import apply_selection, current_selection
from ur.request.requirements.python_packages import need_all
from ur.robot.selection import parse_selection
from ur.source.diagnostic import UserError, error


@click.command("web")
@click.argument("robot", required=False)
@click.option("--port", type=click.IntRange(1, 65535), help="The port; the first free one from 8090 on unless given.")
@click.option("--phone", is_flag=True, help="Let other devices in the network open the page, and print a QR code.")
@click.option("--look", is_flag=True, help="Make a link that may look and stop the robot, but not drive.")
@click.option("--no-browser", is_flag=True, help="Open no browser on this computer.")
@click.option("--foxglove", is_flag=True, help="Print an address for Foxglove and Lichtblick, too.")
@click.option(
    "--foxglove-origin",
    "origins",
    multiple=True,
    metavar="ORIGIN",
    help="As --foxglove; viewers of this site may connect, too, such as https://viewer.example; may be repeated.",
)
@click.option("--service", is_flag=True, hidden=True)
@click.option("--prepare", is_flag=True, hidden=True)
def command(
    robot: str | None,
    port: int | None,
    phone: bool,
    look: bool,
    no_browser: bool,
    foxglove: bool,
    origins: tuple[str, ...],
    service: bool,
    prepare: bool,
) -> int:
    """Show and drive a robot in a browser.

    Serves a page on this computer only, or with --phone in the network, and prints a link to it that is good for one
    login. The page shows the robot whose program runs, for example `ur run keyboard_navigate`, and waits for it where
    none does.
    """
    selection = parse_selection(robot) if robot else current_selection(os.environ)
    viewers = [_read_origin(each) for each in origins]
    need_all(["aiohttp", "segno"], "web.lock", "what the page needs (2 MB to download)")
    if prepare:  # for `ur boot install web`, which then has a service run with --service
        return 0
    foxglove = foxglove or bool(viewers)
    if foxglove:
        need_all(["foxglove"], "foxglove.lock", "what Foxglove and Lichtblick need (20 MB to download)")
    from ur.web.access.roles import Role
    from ur.web.server.serve import Options, serve

    apply_selection(selection)
    name = "simulated robot" if selection.simulated else selection.robot
    if service:
        name = os.uname().nodename.split(".")[0]
    role = Role.LOOK if look else Role.DRIVE
    options = Options(name, port or 0, role, not no_browser, phone, service, foxglove, tuple(viewers))
    asyncio.run(serve(options, click.echo))
    return 0


def _read_origin(text: str) -> str:
    from ur.web.access.origin import read_origin

    origin = read_origin(text)
    if origin is None:
        message = f"invalid --foxglove-origin {text!r}, expected the origin of a page, without a path"
        help_ = "for example --foxglove-origin https://viewer.example"
        raise UserError(error(message, rule="bad-value", help=help_, subject=text))
    return origin
