"""`keyboard_navigate` on a terminal that can draw, where nothing else writes."""

import asyncio
import contextlib
import os
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TextIO

from textual.drivers.linux_driver import LinuxDriver

from ur.source.run_users import FOLDER_VARIABLE, list_users
from ur.tui.screen.query import ask_background, is_light, typed_text
from ur_nodes.client.saving import MapSaving, Saving
from ur_nodes.client.snapshot import NavigationClient
from ur_nodes.run import log_folder
from ur_nodes.teleop.navigate.app import NavigateApp
from ur_nodes.teleop.navigate.command_line import StoreChoice


@contextlib.contextmanager
def own_screen(log: Path) -> Iterator[type[LinuxDriver]]:
    """Make a Textual driver that draws on standard output's terminal, while file descriptor 2 is written to `log`.

    Errors that Python, C++ or a library prints would otherwise land in the picture.
    """
    screen = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    errors = os.dup(2)
    sys.stderr.flush()
    try:
        log.parent.mkdir(parents=True, exist_ok=True)
        sink = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
    except OSError:
        sink = os.open(os.devnull, os.O_WRONLY)
    os.dup2(sink, 2)
    os.close(sink)
    try:
        yield _driver_on(screen)
    finally:
        sys.stderr.flush()
        os.dup2(errors, 2)
        os.close(errors)
        with contextlib.suppress(OSError):
            screen.close()


def _driver_on(screen: TextIO) -> type[LinuxDriver]:
    class ScreenDriver(LinuxDriver):
        def __init__(self, *args: Any, **options: Any) -> None:
            super().__init__(*args, **options)
            self._file = screen  # type: ignore[assignment]  # Textual's own is sys.__stderr__, a TextIO too

    return ScreenDriver


def run_screen(
    name: str,
    navigator: NavigationClient,
    stores: StoreChoice,
    recording: Saving,
    saving: MapSaving | None,
    ended: threading.Event,
) -> int:
    """Show the map and run commands until `q`, Ctrl-C or `ended`; a goal that was sent is then cancelled.

    Returns the exit code. Raises the UserError that ended the screen.
    """
    answer = ask_background(0, 1)
    folder = os.environ.get(FOLDER_VARIABLE, "")
    with own_screen(log_folder() / f"{name}-stderr.log") as driver:
        app = NavigateApp(
            navigator,
            stores.store_for,
            title=stores.title,
            light=is_light(os.environ, answer),
            driver_class=driver,
            recording=recording,
            saving=saving,
            typed=typed_text(answer),
            list_users=lambda: list_users(folder) if folder else (),
        )
        try:
            asyncio.run(_run(app, ended))
        finally:
            silence = app.cancel_own_goal()
    if silence:
        sys.stderr.write(f"warning: {name}: the goal may not be cancelled: {silence}\n")
        sys.stderr.write("  help: the robot stops and holds a goal when nothing arrives from this computer for 2.5 s\n")
    if app.problem is not None:
        raise app.problem
    if saving and not ended.is_set():
        sys.stdout.write(f"{saving.save_last(ended)}\n")
    return app.return_code or 0


async def _run(app: NavigateApp, ended: threading.Event) -> None:
    ending = asyncio.create_task(_end_with(app.exit, ended))
    try:
        await app.run_async()
    finally:
        ending.cancel()


async def _end_with(end: Callable[[], None], ended: threading.Event) -> None:
    while not ended.is_set():
        await asyncio.sleep(0.1)
    end()
