"""`ur web`: one page that shows and drives a robot."""

from __future__ import annotations

import asyncio
import os

import click

from ur.request.environment import apply_selection, current_selection
from ur.request.requirements.python_packages import need_all
from ur.robot.selection import parse_selection


@click.command("web")
@click.argument("robot", required=False)
@click.option("--port", type=click.IntRange(1, 65535), help="The port; the first free one from 8090 on unless given.")
@click.option("--phone", is_flag=True, help="Let other devices in the network open the page, and print a QR code.")
@click.option("--look", is_flag=True, help="Make a link that may look and stop the robot, but not drive.")
@click.option("--no-browser", is_flag=True, help="Open no browser on this computer.")
def command(robot: str | None, port: int | None, phone: bool, look: bool, no_browser: bool) -> int:
    """Show and drive a robot in a browser.

    Serves a page on this computer only, or with --phone in the network, and prints a link to it that is good for one
    login. The page shows the robot whose program runs, for example `ur run keyboard_navigate`, and waits for it where
    none does.
    """
    selection = parse_selection(robot) if robot else current_selection(os.environ)
    need_all(["aiohttp", "segno"], "web.lock", "what the page needs (2 MB to download)")
    from ur.web.access.roles import Role
    from ur.web.server.serve import Options, serve

    apply_selection(selection)
    name = "simulated robot" if selection.simulated else selection.robot
    options = Options(name, port or 0, Role.LOOK if look else Role.DRIVE, not no_browser, phone)
    asyncio.run(serve(options, click.echo))
    return 0
