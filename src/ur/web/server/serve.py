"""Start and end of the server: its port, its links, its log, and the browser on this computer."""

from __future__ import annotations

import asyncio
import html
import logging
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from aiohttp import web

from ur.source.ansi import allows_colour
from ur.source.diagnostic import UserError, error
from ur.source.printable import printable
from ur.source.replace import PRIVATE, replace_file
from ur.source.user_folders import user_folder
from ur.web.access.origin import make_origins
from ur.web.access.roles import Role
from ur.web.server.application import Application
from ur.web.server.gate import VIEWER_PATH, Gate
from ur.web.server.link_files import LinkFiles
from ur.web.server.links import FIRST_PORT, LISTENERS, draw_code, make_link
from ur.web.server.robot_end import robot_environment
from ur.web.server.static_files import load_files

LAST_PORT = 8099
_LONGEST_LOG = 1 << 20  # bytes
_END_LIMIT = 3.0  # s


@dataclass(frozen=True, slots=True)
class Options:
    """`robot`: its name for people. `port`: 0 for the first free one of 8090 to 8099. `role`: of the first link.

    `phone`: other computers of the network reach the page, too. `service`: they do, and links are made by
    `ur boot link`: none is printed, since what a service prints is kept in a log. `foxglove`: print an address for
    viewers; `origins`: of viewers besides the known ones.
    """

    robot: str
    port: int = 0
    role: Role = Role.DRIVE
    browser: bool = True
    phone: bool = False
    service: bool = False
    foxglove: bool = False
    origins: tuple[str, ...] = ()


def state_folder() -> Path:
    """The folder of sessions and log."""
    return Path(user_folder("XDG_STATE_HOME", os.environ), "ubiquity_launches", "web")


async def serve(
    options: Options, report: Callable[[str], None], until: Callable[[], Awaitable[object]] | None = None
) -> None:
    """Serve until SIGINT, SIGTERM or SIGHUP, or until what `until` makes is done. `report` prints lines for the user.

    Raises UserError: no port is free, or a page for phones is wanted and there is no network.
    """
    address = find_address() if options.phone else "localhost"
    network = options.phone or options.service
    folder = state_folder()
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    log = _Log(folder / "web.log")
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        loop.add_signal_handler(number, ended.set)
    logging.getLogger("aiohttp").addHandler(logging.NullHandler())
    logging.getLogger("aiohttp").propagate = False
    port = options.port or (FIRST_PORT if options.service else _free_port())
    origins = make_origins(_own_names() if network else (), port)
    links = LinkFiles(folder) if options.service else None
    gate = Gate(origins, folder / f"sessions-{port}.json", log, links, options.origins)
    application = Application(gate, load_files(), robot_environment(), options.robot, log)
    runner = web.AppRunner(application.build(), access_log=None, handle_signals=False, shutdown_timeout=_END_LIMIT)
    await runner.setup()
    opened: Path | None = None
    try:
        try:
            await web.TCPSite(runner, "0.0.0.0" if network else "localhost", port).start()  # noqa: S104 - asked for
        except OSError as problem:
            raise _taken(port, problem) from None
        if options.service:
            report(f"serves the page on port {port}; a link to it: ur boot link")
        else:
            link = make_link(address, port, gate.invite(options.role))
            if options.phone:
                report(draw_code(link, colours=sys.stdout.isatty() and allows_colour(os.environ)))
            report(f"open {link}")
            report("the link is good for one login within an hour; Ctrl-C ends the server")
            if options.foxglove:
                viewers = f"ws://{address}:{port}{VIEWER_PATH}?token={gate.invite_viewer(options.role)}"
                report(f"Foxglove and Lichtblick: open a connection (Foxglove WebSocket) to {viewers}")
                report("this address is good until the server ends; whoever has it sees what the robot sees")
            if options.phone:
                report(LISTENERS)
            elif options.browser and _has_browser():
                opened = _open(folder / f"open-{os.getpid()}.html", link)
        await _wait_first(ended.wait, *((until,) if until is not None else ()))
    finally:
        if opened is not None:
            opened.unlink(missing_ok=True)
        await runner.cleanup()


async def _wait_first(*waits: Callable[[], Awaitable[object]]) -> None:
    """Wait until one of these is done."""
    tasks = [asyncio.ensure_future(each()) for each in waits]
    await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


class _Log:
    """A file of lines with the time; when it is long, the older half goes to another file."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def __call__(self, line: str) -> None:
        with suppress(OSError):
            if self._path.exists() and self._path.stat().st_size > _LONGEST_LOG:
                self._path.replace(self._path.with_suffix(".log.1"))
            descriptor = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, PRIVATE)
            with os.fdopen(descriptor, "a", encoding="utf-8") as file:
                file.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')} {printable(line)[:500]}\n")


def find_address() -> str:
    """The address that others of the network know this computer by. Raises UserError: there is no network."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing: the route names the address
        except OSError:
            message = "this computer is in no network, expected one that the phone is in, too"
            help_ = "connect to a network, or leave out --phone"
            raise UserError(error(message, rule="no-network", help=help_)) from None
        return str(probe.getsockname()[0])


def _own_names() -> tuple[str, ...]:
    name = socket.gethostname().split(".")[0]
    return name, f"{name}.local"


def _free_port() -> int:
    for port in range(FIRST_PORT, LAST_PORT + 1):
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            with suppress(OSError):
                probe.bind(("127.0.0.1", port))
                return port
    message = f"ports {FIRST_PORT} to {LAST_PORT} are in use, expected a free one"
    raise UserError(error(message, rule="no-port", help="choose one with --port"))


def _taken(port: int, problem: OSError) -> UserError:
    reason = (problem.strerror or str(problem)).lower()
    return UserError(
        error(f"port {port}: {reason}", rule="no-port", help="choose another one with --port", subject=f"port {port}")
    )


def _has_browser() -> bool:
    return sys.stdout.isatty() and bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _open(path: Path, link: str) -> Path:
    """Have the desktop open a private file that leads to the link: a command line would show the token to all."""
    page = f'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0;url={html.escape(link)}">\n'
    replace_file(path, page, mode=PRIVATE)
    with suppress(OSError):
        subprocess.Popen(
            ["xdg-open", str(path)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
    return path
