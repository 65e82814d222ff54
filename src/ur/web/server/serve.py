"""Start and end of the server: its port, links and log, and the browser on this computer."""

import asyncio
import errno
import html
import os
import queue
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AsyncExitStack, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from ur.source.ansi import allows_colour
from ur.source.diagnostic import user_error
from ur.source.printable import printable
from ur.source.replace import PRIVATE, replace_file
from ur.source.user_folders import user_folder
from ur.web.access.origin import make_origins
from ur.web.access.roles import DAY, SESSION_LIFE, Role
from ur.web.server.application import Application
from ur.web.server.connections.http_server import open_server
from ur.web.server.connections.listener import listen
from ur.web.server.links import FIRST_PORT, LISTENERS, LinkFiles, draw_code, find_address, make_link
from ur.web.server.logins.gate import VIEWER_PATH, LoginGate
from ur.web.server.logins.sessions import discard_line
from ur.web.server.robot_process import robot_environment
from ur.web.server.static_files import load_files

_PAUSE = 0.5  # s between checks of a terminal that belongs to another program


@contextmanager
def call_on_enter(act: Callable[[], object]) -> Iterator[bool]:
    """Call `act` for each press of Enter while the context lasts; yield whether a terminal is available.

    In the background the terminal belongs to the shell: nothing is read then, which would stop this process.
    """
    if not sys.stdin or sys.stdin.closed or not sys.stdin.isatty():
        yield False
        return
    loop, descriptor = asyncio.get_running_loop(), sys.stdin.fileno()
    waiting: list[asyncio.TimerHandle] = []

    def read() -> None:
        if _is_in_background(descriptor):
            loop.remove_reader(descriptor)
            waiting[:] = [loop.call_later(_PAUSE, loop.add_reader, descriptor, read)]
            return
        data = b""
        with suppress(OSError):
            data = os.read(descriptor, 1024)
        if data:
            act()
        else:  # the terminal has closed
            loop.remove_reader(descriptor)

    loop.add_reader(descriptor, read)
    try:
        yield True
    finally:
        loop.remove_reader(descriptor)
        for each in waiting:
            each.cancel()


def _is_in_background(descriptor: int) -> bool:
    try:
        return os.tcgetpgrp(descriptor) != os.getpgrp()
    except OSError:  # not the controlling terminal of this process
        return False


_PORTS = range(FIRST_PORT, 8100)
_LONGEST_LOG = 1 << 20  # bytes
_MOST_LINES = 1000  # lines that wait for the disk
_LOG_LIMIT = 5.0  # s for the last lines


@dataclass(frozen=True, slots=True)
class ServerOptions:
    """Options of the server.

    `robot`: its display name. `port`: 0 for the first free one of 8090 to 8099. `role`: of the first link. `phone`:
    other computers of the network reach the page, too. `service`: they do, and links are made by `ur boot link`: none
    is printed, since the output of a service is stored in a log. `foxglove`: print an address for viewers; `origins`:
    additional origins of viewers. `days`: validity of a login. `moved` returns the selection if that is of other nodes
    now, else "".
    """

    robot: str
    port: int = 0
    role: Role = Role.DRIVE
    browser: bool = True
    phone: bool = False
    service: bool = False
    foxglove: bool = False
    origins: tuple[str, ...] = ()
    days: float = SESSION_LIFE / DAY
    moved: Callable[[], str] = str


async def serve(options: ServerOptions, report: Callable[[str], None]) -> None:
    """Serve until SIGINT, SIGTERM or SIGHUP.

    `report` prints lines for the user. Raises UserError if no port is free, or `phone` is set without a network.
    """
    address = find_address() if options.phone else "localhost"
    network = options.phone or options.service
    folder = Path(user_folder("XDG_STATE_HOME", os.environ), "ubiquity_launches", "web")
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    log = _Log(folder / "web.log")
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        loop.add_signal_handler(number, ended.set)
    host = "0.0.0.0" if network else "localhost"  # noqa: S104 - asked for
    port, listening = open_port(host, _choose_ports(options))
    origins = make_origins(_own_names() if network else (), port)
    links = LinkFiles(folder) if options.service else None
    path, life = folder / f"sessions-{port}.json", options.days * DAY
    gate = LoginGate(origins, path, log, links, options.origins, discard_line if options.service else report, life)
    application = Application(gate, load_files(), robot_environment(), options.robot, log, moved=options.moved)
    async with AsyncExitStack() as stack:
        stack.callback(log.close)
        await stack.enter_async_context(open_server(application.build(), gate, listening, log))
        if options.service:
            report(f"serves the page on port {port}; a link to it: ur boot link")
        else:
            print_link = partial(_print_link, options, gate, address, port, report)
            link = print_link()
            enter = "Enter prints another one, " if stack.enter_context(call_on_enter(print_link)) else ""
            report(f"the link is good for one login within an hour; {enter}Ctrl-C ends the server")
            if options.foxglove:
                viewers = f"ws://{address}:{port}{VIEWER_PATH}?token={gate.sessions.invite_viewer(options.role)}"
                report(f"Foxglove and Lichtblick: open a connection (Foxglove WebSocket) to {viewers}")
                report("this address is good until the server ends; everyone with it sees the robot's data")
            if options.phone:
                report(LISTENERS)
            elif options.browser and _has_browser():
                opened = _open(folder / f"open-{os.getpid()}.html", link)
                stack.callback(opened.unlink, missing_ok=True)
        await ended.wait()


def _print_link(options: ServerOptions, gate: LoginGate, address: str, port: int, report: Callable[[str], None]) -> str:
    """Print a link for one more login, and return it."""
    link = make_link(address, port, gate.invite(options.role))
    if options.phone:
        report(draw_code(link, colours=sys.stdout.isatty() and allows_colour(os.environ)))
    report(f"open {link}")
    return link


class _Log:
    """A log file of lines with the time; when it is long, the older half is moved to another file.

    A thread writes it: a slow disk delays no request.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name="log", daemon=True)
        self._thread.start()

    def __call__(self, line: str) -> None:
        if self._lines.qsize() < _MOST_LINES:
            self._lines.put(f"{time.strftime('%Y-%m-%d %H:%M:%S')} {printable(line)[:500]}\n")

    def close(self) -> None:
        """Write the remaining lines."""
        self._lines.put(None)
        self._thread.join(_LOG_LIMIT)

    def _run(self) -> None:
        while (line := self._lines.get()) is not None:
            with suppress(OSError):
                if self._path.exists() and self._path.stat().st_size > _LONGEST_LOG:
                    self._path.replace(self._path.with_suffix(".log.1"))
                descriptor = os.open(self._path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, PRIVATE)
                with os.fdopen(descriptor, "a", encoding="utf-8") as file:
                    file.write(line)


def _own_names() -> tuple[str, ...]:
    name = socket.gethostname().split(".")[0]
    return name, f"{name}.local"


def _choose_ports(options: ServerOptions) -> range:
    """Return the ports to try, in this order."""
    if options.port or options.service:
        port = options.port or FIRST_PORT
        return range(port, port + 1)
    return _PORTS


def open_port(host: str, ports: range) -> tuple[int, list[socket.socket]]:
    """Listen on the first free port, and return it with its sockets. Raises UserError if there is none.

    It stays open: servers that start in the same moment get different ports.
    """
    for port in ports:
        found = _listen(host, port)
        if not isinstance(found, OSError):
            return port, found
        if found.errno != errno.EADDRINUSE or len(ports) == 1:
            message, subject = f"port {port}: {(found.strerror or str(found)).lower()}", f"port {port}"
            raise user_error(message, rule="no-port", help="choose another one with --port", subject=subject)
    message = f"ports {ports[0]} to {ports[-1]} are in use, expected a free one"
    raise user_error(message, rule="no-port", help="choose one with --port")


def _listen(host: str, port: int) -> list[socket.socket] | OSError:
    try:
        return listen(host, port)
    except OSError as problem:
        return problem


def _has_browser() -> bool:
    return sys.stdout.isatty() and bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def _open(path: Path, link: str) -> Path:
    """Open the link in the desktop's browser by a private file: a command line would expose the token."""
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
