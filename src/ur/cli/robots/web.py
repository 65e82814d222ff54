"""`ur web`: one page that shows and drives a robot."""

import os
import sys

import click

from ur.request.environment import CHOSEN, apply_selection, current_selection, watch_selection
from ur.request.requirements.python_packages import need_all
from ur.robot.selection import Selection, parse_selection
from ur.source.diagnostic import user_error


@click.command("web")
@click.argument("robot", required=False)
@click.option("--port", type=click.IntRange(1, 65535), help="The port; the first free one from 8090 on unless given.")
@click.option("--phone", is_flag=True, help="Let other devices in the network open the page, and print a QR code.")
@click.option("--look", is_flag=True, help="Make a link that allows watching and stopping the robot, but not driving.")
@click.option("--no-browser", is_flag=True, help="Open no browser on this computer.")
@click.option("--foxglove", is_flag=True, help="Print an address for Foxglove and Lichtblick, too.")
@click.option(
    "--foxglove-origin",
    "origins",
    multiple=True,
    metavar="ORIGIN",
    help="As --foxglove; viewers of this site may connect, too, such as https://viewer.example; may be repeated.",
)
@click.option(
    "--days",
    type=click.FloatRange(0.01, 3650),
    default=30.0,
    show_default=True,
    help="Days until a login expires, also if it is used.",
)
@click.option("--service", is_flag=True, hidden=True)
@click.option("--prepare", is_flag=True, hidden=True)
@click.option("--prepare-3d", is_flag=True, hidden=True)
def command(
    robot: str | None,
    port: int | None,
    phone: bool,
    look: bool,
    no_browser: bool,
    foxglove: bool,
    origins: tuple[str, ...],
    days: float,
    service: bool,
    prepare: bool,
    prepare_3d: bool,
) -> int:
    """Show and drive a robot in a browser.

    Serves a page on this computer only, or with --phone in the network, and prints a link to it that is valid for one
    login. The page shows the robot of the program that runs, for example `ur run keyboard_navigate`, and waits for one
    if none runs.
    """
    if prepare_3d:  # for the page, when its 3D view is first opened
        need_all(["jupyter_threejs_sage"], "three.lock", "what the 3D view needs (1 MB to download)")
        return 0
    stored = current_selection(os.environ)
    selection = _choose(robot, stored)
    if not (service or prepare or selection.simulated):
        from ur.cli.robots.shell import is_over_ssh, serve_there  # 8 MB

        if is_over_ssh(selection):
            return serve_there(selection, port, [*(["--look"] if look else []), "--days", str(days)])
    viewers = [_read_origin(each) for each in origins]
    need_all(["aiohttp", "segno"], "web.lock", "what the page needs (2 MB to download)")
    if prepare:  # for `ur boot install web`, which then runs a service with --service
        return 0
    foxglove = foxglove or bool(viewers)
    if foxglove:
        need_all(["foxglove"], "foxglove.lock", "what Foxglove and Lichtblick need (20 MB to download)")
    sys.modules.setdefault("ssl", None)  # type: ignore[arg-type]  # 4 MB that asyncio and aiohttp do without
    import asyncio

    from ur.web.access.roles import Role
    from ur.web.server.serve import ServerOptions, serve

    apply_selection(selection)
    if robot:  # programs that the page starts are for this robot, whichever is selected
        os.environ[CHOSEN] = str(selection)
    name = "simulated robot" if selection.simulated else selection.robot
    if service:
        name = os.uname().nodename.split(".")[0]
    role = Role.LOOK if look else Role.DRIVE
    options = ServerOptions(
        name, port or 0, role, not no_browser, phone, service, foxglove, tuple(viewers), days,
        moved=watch_selection(dict(os.environ)),
    )  # fmt: skip
    asyncio.run(serve(options, click.echo))
    return 0


def _choose(robot: str | None, stored: Selection) -> Selection:
    """Return the named robot, else the selected one. Raises UserError for an invalid name or an unknown base."""
    if not robot or (chosen := parse_selection(robot)) == stored:
        return stored
    from ur.cli.robots.use import check_base, check_robot

    note = "" if chosen.simulated else check_robot(chosen, away=False)
    check_base(chosen)
    click.echo(note, nl=False, err=True)
    return chosen


def _read_origin(text: str) -> str:
    from ur.web.access.origin import read_origin

    origin = read_origin(text)
    if origin is None:
        message = f"invalid --foxglove-origin {text!r}, expected the origin of a page, without a path"
        help_ = "for example --foxglove-origin https://viewer.example"
        raise user_error(message, rule="bad-value", help=help_, subject=text)
    return origin
