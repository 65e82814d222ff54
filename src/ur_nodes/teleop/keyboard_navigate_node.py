"""Send a robot to places: on a terminal with a map, from a pipe with commands."""

from __future__ import annotations

import asyncio
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import rospkg

from ur_nodes.rosio.parameters import Parameters
from ur_nodes.teleop.batch import InterruptedBatchError, Limits, Surroundings, run_batch, wait_until_ready
from ur_nodes.teleop.foreground_node import run_in_foreground
from ur_nodes.teleop.navigator import Snapshot
from ur_nodes.teleop.ros_navigator_node import Names, RosNavigator
from ur_nodes.teleop.waypoints import WaypointStore, name_of_map, waypoint_path

_NAME = "keyboard_navigate"

StoreFor = Callable[[Snapshot], WaypointStore]


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
    navigator = RosNavigator(names)

    def store_for(snapshot: Snapshot) -> WaypointStore:
        assert snapshot.grid is not None, "asked for once the map is there"
        path = Path(file).expanduser() if file else waypoint_path(map_name or name_of_map(snapshot.grid), os.environ)
        return WaypointStore(path)

    if sys.stdin.isatty() and sys.stdout.isatty():
        return _run_screen(navigator, store_for, map_name, ended)
    return _run_batch(navigator, store_for, limits, ended)


def _run_screen(navigator: RosNavigator, store_for: StoreFor, map_name: str, ended: threading.Event) -> int:
    from ur_nodes.teleop.app import NavigateApp  # a pipe needs no Textual
    from ur_nodes.teleop.screen import ask_background, is_light, own_screen

    light = is_light(os.environ, lambda: ask_background(0, 1))
    log = Path(rospkg.get_log_dir()) / f"{_NAME}-stderr.log"
    with own_screen(log) as driver:
        app = NavigateApp(navigator, store_for, title=Path(map_name).stem, light=light, driver_class=driver)

        async def run() -> None:
            ending = asyncio.create_task(_end_with(app.exit, ended))
            try:
                await app.run_async()
            finally:
                ending.cancel()

        asyncio.run(run())
        app.stop_what_was_sent()
    return app.return_code or 0


async def _end_with(end: Callable[[], None], ended: threading.Event) -> None:
    while not ended.is_set():
        await asyncio.sleep(0.1)
    end()


def _run_batch(navigator: RosNavigator, store_for: StoreFor, limits: Limits, ended: threading.Event) -> int:
    around = Surroundings(out=_write_out, err=_write_err, clock=time.monotonic, sleep=ended.wait)
    try:
        try:
            missing = wait_until_ready(navigator, limits, around)
        except InterruptedBatchError:
            return 128 + signal.SIGINT  # there was no goal yet
        if missing is not None:
            around.err(f"error: {_NAME}: still waiting for {missing} after {limits.start:g} s")
            around.err("  help: 'ur run keyboard_navigate' starts all of it; parameter ~start_timeout sets the limit")
            return 2
        return run_batch(read_lines(0, ended), navigator, store_for(navigator.snapshot()), limits, around)
    except InterruptedBatchError:
        around.err(f"error: {_NAME}: interrupted, the goal was cancelled")
        return 1
    finally:
        ended.wait(0.1)  # let the last message leave before the connections close


def read_lines(source: int, ended: threading.Event) -> Iterator[str]:
    """Lines of a file descriptor as they come, until its end or until `ended` is set."""
    rest = b""
    while not ended.is_set():
        if not select.select([source], [], [], 0.2)[0]:
            continue
        data = os.read(source, 4096)
        if not data:
            break
        *lines, rest = (rest + data).split(b"\n")
        for line in lines:
            yield line.decode(errors="replace")
    if rest and not ended.is_set():
        yield rest.decode(errors="replace")


def _write_out(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


def _write_err(line: str) -> None:
    sys.stderr.write(line + "\n")


if __name__ == "__main__":
    sys.exit(main())
