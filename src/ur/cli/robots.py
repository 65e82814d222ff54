"""`ur robots`: who is on the network."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import click

from ur.cli.on_demand import need
from ur.robot.discovery import Browser, Row, list_robots
from ur.robot.record import load_records, records_folder

if TYPE_CHECKING:
    from rich.table import Table

MASTER_PORT = 11311
Nodes = Callable[[Row], str]


@click.command("robots")
@click.option("--watch", is_flag=True, help="Go on looking until Ctrl-C.")
@click.option("--seconds", type=click.FloatRange(min=0.1), default=2.0, show_default=True, help="How long to look.")
def command(watch: bool, seconds: float) -> int:
    """List the robots on the network, and those known but away.

    Robots announce themselves once `ur robot setup` has set them up. `runs` says how many nodes the robot's ROS master
    knows.
    """
    need("zeroconf", "robot.lock")
    records = load_records(records_folder(os.environ))
    changed = threading.Event()
    with Browser(changed.set) as browser:
        if watch:
            _watch(lambda: list_robots(browser.sightings, records), changed)
            return 0
        time.sleep(seconds)  # how long the user wants to listen
        rows = list_robots(browser.sightings, records)
    if not rows:
        sys.stdout.write("no robot announces itself here; set one up: ur robot setup HOST\n")
        return 1
    _print(rows)
    return 1 if any(row.problem for row in rows) else 0


def _print(rows: Sequence[Row]) -> None:
    from rich.console import Console

    Console(soft_wrap=not sys.stdout.isatty()).print(_table(rows))
    for row in rows:
        if row.problem:
            sys.stdout.write(f"warning: {row.problem}\n  help: {row.help}\n")
    sys.stdout.flush()


def _watch(rows: Callable[[], Sequence[Row]], changed: threading.Event) -> None:
    from rich.live import Live

    with Live(_table(rows()), auto_refresh=False) as live:
        while True:
            changed.wait(5.0)
            changed.clear()
            live.update(_table(rows()), refresh=True)


def _table(rows: Sequence[Row]) -> Table:
    from rich.table import Table

    table = Table()
    for column in ("robot", "address", "base", "variant", "runs"):
        table.add_column(column)
    for row in rows:
        where = ", ".join(address for address in row.addresses if ":" not in address) or ", ".join(row.addresses)
        name = f"[red]{row.name} (!)[/]" if row.problem else row.name
        table.add_row(name, where or "[dim]away[/]", row.base, row.variant, count_nodes(row))
    return table


def count_nodes(row: Row) -> str:
    """What the robot's master says: how many nodes there are; empty when no master answers."""
    from ur.run.xml_rpc import Refused, Unanswered, call_method

    for address in row.addresses:
        if ":" not in address:
            try:
                _, _, state = call_method((address, MASTER_PORT), "getSystemState", ["/ur"], 1.0)
            except (Refused, Unanswered, OSError, ValueError, TypeError):
                continue
            names = {node for group in state for _, nodes in group for node in nodes}
            return f"{len(names)} nodes"
    return ""
