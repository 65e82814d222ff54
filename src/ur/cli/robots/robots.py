"""`ur robots`: robots on the network."""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections.abc import Callable, Collection, Sequence
from typing import TYPE_CHECKING

import click

from ur.cli.output import plain_text
from ur.cli.robots.fleet import read_names
from ur.request.remote.robot_poller import STARTING_PERIOD, RobotPoller
from ur.request.requirements.python_packages import need_all
from ur.robot.discovery.announcements import Announcement, Browser
from ur.robot.discovery.listing import RobotAnswer, RobotRow, choose_rows, list_robots
from ur.robot.discovery.record import load_records, records_folder
from ur.robot.discovery.seen import SeenRobot, load_seen, note_seen, seen_path
from ur.source.printable import printable
from ur.source.progress_line import show_progress

if TYPE_CHECKING:
    from rich.console import RenderableType

SETTLE_SECONDS = 6.0  # the longest wait for starting robots, beyond the requested time
Look = Callable[[], list[RobotRow]]


@click.command("robots")
@click.argument("names", nargs=-1, metavar="[ROBOT ...]")
@click.option(
    "--seconds", type=click.FloatRange(min=0.1), default=2.0, show_default=True, help="How long to listen, in s."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
@click.option("--access-points", is_flag=True, help="Print the passwords of their own access points, no more.")
def command(names: tuple[str, ...], seconds: float, as_json: bool, access_points: bool) -> int:
    """List the robots on the network, and those known but away.

    Robots announce themselves once `ur robot setup` has set them up. `runs` lists what runs at the robot's ROS master
    and what it starts at boot; `clock` is the offset of its clock from ours, or why that is unknown. The command waits
    some seconds longer than `--seconds` for a robot that is starting. The exit code is 1 when no robot answers, one of
    the ROBOTs is away, or a robot has a problem with its name.
    """
    wanted = read_names(names)
    if access_points:
        known_points = [one for one in load_records(records_folder(os.environ)) if not wanted or one.name in wanted]
        lines = [f"WiFi {one.name}: password {one.access_point}" for one in known_points if one.access_point]
        click.echo("\n".join(lines) or "none is known here; on the robot: sudo cat /etc/ubiquity/access-point")
        return 0 if lines else 1
    need_all(["zeroconf"], "robot.lock", "what finding robots needs (2 MB to download)")
    changed = threading.Event()
    names_here = [record.name for record in load_records(records_folder(os.environ))]
    memory = load_seen(seen_path(os.environ))

    def former(address: str) -> list[str]:
        return [name for name in names_here if name in memory and memory[name].address == address]

    known = {*names_here, *memory, *wanted}
    with Browser(changed.set, known) as browser, RobotPoller(browser, seconds, changed.set, former, known) as asked:

        def look() -> list[RobotRow]:
            asked.ask(browser.sightings)
            remembered = load_seen(seen_path(os.environ))
            records = load_records(records_folder(os.environ))
            return choose_rows(list_robots(browser.sightings, records, asked.answers, remembered), wanted)

        def settled() -> bool:
            return asked.is_settled(_among(browser.sightings, wanted))

        def complete() -> bool:
            there = {one.name for one in browser.sightings} | {one.host for one in browser.sightings}
            return bool(wanted) and there.issuperset(wanted) and settled()

        try:
            with show_progress("listening for robots"):
                rows = _listen(look, changed, seconds, settled, complete)
        finally:
            here = [one for one in browser.sightings if asked.answers.get(one.host, RobotAnswer()).answers]
            note_seen(seen_path(os.environ), [SeenRobot(one.name, one.address, time.time()) for one in here])
        _show(rows, as_json)
        _print_left_out(*browser.left_out)
    found = all(row.address for row in rows) if wanted else any(row.address for row in rows)
    return 1 if any(row.problem for row in rows) or not found else 0


def _among(sightings: Sequence[Announcement], wanted: Collection[str]) -> list[Announcement]:
    return [one for one in sightings if not wanted or one.name in wanted or one.host in wanted]


def _show(rows: Sequence[RobotRow], as_json: bool) -> None:
    if as_json:
        click.echo(json.dumps([_as_dict(row) for row in rows], indent=2))
    elif rows:
        _print(rows)
    else:
        click.echo("no robot announces itself here; set one up: ur robot setup HOST")
    sys.stdout.flush()


def _print_left_out(misshapen: int, too_many: int) -> None:
    if misshapen:
        click.echo(f"note: {misshapen} announcements that no robot of ours makes were ignored", err=True)
    if too_many:
        click.echo(f"note: {too_many} announcements of unknown robots are not listed: there are too many", err=True)


def _listen(
    look: Look, changed: threading.Event, seconds: float, settled: Callable[[], bool], complete: Callable[[], bool]
) -> list[RobotRow]:
    """Return the robots after `seconds` of listening, and after the visible ones have answered.

    A robot is queried as soon as it announces itself. The function returns early when the list is `complete`.
    """
    end = time.monotonic() + seconds
    last = end + SETTLE_SECONDS
    rows = look()
    while ((now := time.monotonic()) < end or (now < last and not settled())) and not complete():
        changed.wait(end - now if now < end else STARTING_PERIOD)
        changed.clear()
        rows = look()
    return rows


def _print(rows: Sequence[RobotRow]) -> None:
    from rich.console import Console

    Console(soft_wrap=not sys.stdout.isatty()).print(_picture(rows))
    sys.stdout.flush()


def _picture(rows: Sequence[RobotRow]) -> RenderableType:
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table()
    has_ros2 = any(row.ros for row in rows)  # the usual columns fit into 80 characters
    titles = ("robot", "address", "base", "variant", *(["ROS"] if has_ros2 else []), "runs", "clock", "version", "seen")
    for title in titles:
        table.add_column(title, overflow="fold")
    now = time.time()
    for row in rows:
        name = plain_text(f"{row.name} (!)", "red") if row.problem else plain_text(row.name)
        ros = [row.ros_name] if has_ros2 else []
        cells = (row.address, row.base, row.variant, *ros, row.runs, row.clock, row.version, row.when(now))
        table.add_row(name, *map(plain_text, cells), style="" if row.address else "dim")
    problems = [
        Text(f"warning: {printable(row.problem)}\n  help: {printable(row.help)}", "yellow")
        for row in rows
        if row.problem
    ]
    return Group(table, *problems)


def _as_dict(row: RobotRow) -> dict[str, object]:
    keys = ("name", "address", "base", "variant", "ros", "version", "problem", "help")
    plain = {key: getattr(row, key) for key in keys}
    reported = {
        "nodes": row.answer.nodes,
        "services": None if row.answer.services is None else dict(row.answer.services),
        "clock_offset": row.answer.offset,
        "refused": row.answer.refused,
        "seen": {"address": row.seen.address, "time": row.seen.time} if row.seen else None,
    }
    return {**plain, **reported}
