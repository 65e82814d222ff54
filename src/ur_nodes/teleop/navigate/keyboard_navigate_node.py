"""The node keyboard_navigate: a map on a terminal, commands from a pipe."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import rospkg

from ur.source.ansi import is_plain
from ur.source.run_users import FOLDER_VARIABLE, list_users
from ur_nodes.client.model import Snapshot
from ur_nodes.client.waypoints import WaypointStore, name_of_map, waypoint_path
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.run import BROKEN_PIPE_EXIT_CODE, drop_output
from ur_nodes.teleop.navigate.batch import BatchContext, InterruptedBatchError, run_batch, wait_until_ready
from ur_nodes.teleop.navigate.batch_text import Limits
from ur_nodes.teleop.navigate.line_reader import LineReader
from ur_nodes.teleop.navigator.map_saving_node import MapSaving, call_save, save_map
from ur_nodes.teleop.navigator.navigation_topics_node import Names
from ur_nodes.teleop.navigator.ros_navigator_node import RosNavigator
from ur_nodes.teleop.terminal.foreground_node import run_in_foreground

_NAME = "keyboard_navigate"
_SAVE_AGAIN = 2.0  # s until the name of a map that could not be saved is asked for again

StoreFor = Callable[[Snapshot], WaypointStore | None]


def main() -> int:
    """Run until `q`, Ctrl-C, the end of the pipe, or shutdown. Returns the exit code."""
    return run_in_foreground(_NAME, _run)


def _run(ended: threading.Event) -> int:
    parameters = Parameters()
    names = Names(
        map_frame=parameters.text("global_frame", "map"),
        base_frame=parameters.text("base_frame", "base_footprint"),
        plan_topic=parameters.text("plan_topic", "move_base/NavfnROS/plan"),
        mux=parameters.text("mux", "cmd_vel_mux"),
    )
    limits = Limits(
        start=parameters.number("start_timeout", 60.0, minimum=0.0),
        goal=parameters.number("goal_timeout", 600.0, minimum=0.0),
    )
    map_name = parameters.text("map_name", "")
    file = parameters.text("waypoints_file", "")
    service = parameters.text("save_service", "")
    navigator = RosNavigator(names)
    try:
        return _navigate(navigator, map_name, file, service, limits, ended)
    finally:
        navigator.close()


def _navigate(
    navigator: RosNavigator, map_name: str, file: str, service: str, limits: Limits, ended: threading.Event
) -> int:
    grown = _NameOfGrowingMap(service, ended) if service and not map_name and not file else None

    def store_for(snapshot: Snapshot) -> WaypointStore | None:
        assert snapshot.grid is not None, "asked for once the map is there"
        if file:
            return WaypointStore(Path(file).expanduser())
        name = map_name or (grown.name if grown else name_of_map(snapshot.grid))
        return WaypointStore(waypoint_path(name, os.environ)) if name else None

    saving = MapSaving(lambda: call_save(service), hint="save: save the map") if service else None
    on_terminal = sys.stdin.isatty() and sys.stdout.isatty()
    if on_terminal and not is_plain(os.environ):
        return _run_screen(navigator, store_for, map_name, ended, saving)
    save = (lambda: call_save(service)) if service else None
    return _run_batch(navigator, store_for, limits, ended, attended=on_terminal, save=save)


class _NameOfGrowingMap:
    """The name that the mapping node stores its map under: '' until it has stored it once. Its content has none."""

    def __init__(self, service: str, ended: threading.Event) -> None:
        self.name = ""
        self._service = service
        self._ended = ended
        threading.Thread(target=self._ask, name="map name", daemon=True).start()

    def _ask(self) -> None:
        while not self.name and not self._ended.is_set():
            self.name, _ = save_map(self._service)
            if not self.name:
                self._ended.wait(_SAVE_AGAIN)


def _run_screen(
    navigator: RosNavigator, store_for: StoreFor, map_name: str, ended: threading.Event, saving: MapSaving | None = None
) -> int:
    from ur.screen.query import ask_background, is_light, typed_text  # a pipe needs no Textual
    from ur_nodes.teleop.navigate.app import NavigateApp
    from ur_nodes.teleop.terminal.textual_screen import own_screen

    answer = ask_background(0, 1)
    light = is_light(os.environ, answer)
    folder = os.environ.get(FOLDER_VARIABLE, "")
    log = Path(rospkg.get_log_dir()) / f"{_NAME}-stderr.log"
    with own_screen(log) as driver:
        app = NavigateApp(
            navigator,
            store_for,
            title=Path(map_name).stem,
            light=light,
            driver_class=driver,
            saving=saving,
            typed=typed_text(answer),
            list_users=lambda: list_users(folder) if folder else (),
        )

        async def run() -> None:
            ending = asyncio.create_task(_end_with(app.exit, ended))
            try:
                await app.run_async()
            finally:
                ending.cancel()

        try:
            asyncio.run(run())
        finally:
            silence = app.cancel_own_goal()
    if silence:
        _write_err(f"warning: {_NAME}: the goal may not be cancelled: {silence}")
        _write_err("  help: the robot stops and holds a goal when nothing arrives from this computer for 3 s")
    if app.problem is not None:
        raise app.problem
    return app.return_code or 0


async def _end_with(end: Callable[[], None], ended: threading.Event) -> None:
    while not ended.is_set():
        await asyncio.sleep(0.1)
    end()


def _run_batch(
    navigator: RosNavigator,
    store_for: StoreFor,
    limits: Limits,
    ended: threading.Event,
    *,
    attended: bool = False,
    save: Callable[[], str] | None = None,
) -> int:
    """Run commands line by line; `attended`: a person types them on a terminal that cannot draw."""
    lines = LineReader(0, ended)
    urgent = lines.take_urgent if attended else None
    output = _Output(ended)
    around = BatchContext(output.write, _write_err, time.monotonic, ended.wait, urgent, save)
    if attended:
        around.out(f"{_NAME}: one command a line; ? lists them, s stops, e is the emergency stop, q quits")
    try:
        try:
            missing = wait_until_ready(navigator, limits, around)
        except InterruptedBatchError:
            return 128 + signal.SIGINT  # there was no goal yet
        if missing is not None:
            around.err(f"error: {_NAME}: still waiting for {missing} after {limits.start:g} s")
            around.err("  help: 'ur run keyboard_navigate' starts all of it; parameter ~start_timeout sets the limit")
            return 2
        while (store := store_for(navigator.snapshot())) is None:
            if ended.wait(0.1):
                return 128 + signal.SIGINT
        code = run_batch(lines, navigator, store, limits, around)
        return BROKEN_PIPE_EXIT_CODE if output.lost else code
    except InterruptedBatchError as interrupt:
        if output.lost:
            return BROKEN_PIPE_EXIT_CODE
        around.err(f"error: {_NAME}: interrupted{f', {interrupt}' if str(interrupt) else ''}")
        return 1
    finally:
        ended.wait(0.1)  # let the last message leave before the connections close


class _Output:
    """Standard output; when nobody reads it any more, the batch is to end, and with it a goal that is driven to."""

    def __init__(self, ended: threading.Event) -> None:
        self._ended = ended
        self.lost = False

    def write(self, line: str) -> None:
        try:
            sys.stdout.write(line + "\n")
            sys.stdout.flush()
        except BrokenPipeError:
            self.lost = True
            drop_output()
            self._ended.set()


def _write_err(line: str) -> None:
    sys.stderr.write(line + "\n")


if __name__ == "__main__":
    sys.exit(main())
