"""`ur robot setup`: freshly flashed robots become ready ones."""

from __future__ import annotations

import getpass
import os
import signal
import socket
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import click

from ur.cli.environment import PACKAGE, REPOSITORY
from ur.cli.robot_network import network
from ur.cli.robot_rename import rename
from ur.cli.robot_wifi import wifi
from ur.robot.base import list_bases, load_base
from ur.robot.record import DEFAULT_USER
from ur.robot.repository import read_repository
from ur.robot.setup.robot import Task, open_robot, prepare_viewer, preview, set_up
from ur.robot.setup.there import Robot, Viewer, is_robot_name
from ur.robot.setup.verify import Check, verify
from ur.robot.ssh.openssh import parse_address
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell
from ur.source.diagnostic import UserError, error
from ur.source.render import render_human
from ur.source.section import Section, read_section

MASTER_SECONDS = 60.0


@click.group("robot", invoke_without_command=True)
@click.pass_context
def command(context: click.Context) -> None:
    """Set robots up and change them, over the network."""
    if context.invoked_subcommand is None:
        from ur.cli.help import show_help

        show_help(["robot"])


@command.command("setup")
@click.argument("hosts", nargs=-1, metavar="[HOST | USER@HOST] ...")
@click.option("--name", help="Its new name; it will answer to NAME.local. With one HOST only.")
@click.option("--base", help="What base it is.")
@click.option("--variant", default=None, help="Which variant of the base.")
@click.option(
    "--from", "file", type=click.Path(dir_okay=False), help="A file that names robots and what they shall be."
)
@click.option(
    "--passwords-from",
    type=int,
    metavar="FD",
    help="Read the present password and the new one, a line each, from this file descriptor.",
)
@click.option(
    "--master/--no-master",
    default=True,
    help="Keep a ROS master up from the robot's boot on, or leave that as it is. [default: --master]",
)
@click.option("--dry-run", is_flag=True, help="Show what would be changed on the robots, and change nothing there.")
@click.option("--new-host-key", is_flag=True, help="It was flashed again: accept its new host key.")
def setup(
    hosts: tuple[str, ...],
    name: str | None,
    base: str | None,
    variant: str | None,
    file: str | None,
    passwords_from: int | None,
    master: bool,
    dry_run: bool,
    new_host_key: bool,
) -> int:
    """Bring freshly flashed robots to ready: name, keys, packages, ROS, time, announcement.

    Asks for what it needs to know. Looks first and changes only what is missing; interrupted anywhere, a second run
    finishes. At the end it looks from both ends and prints what it saw.

    FILE is YAML: `robots:`, a list of mappings with `host`, `name`, `base` and, if wanted, `user`, `variant` and
    `master: false`.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    if file and (hosts or name or base):
        raise click.UsageError("--from FILE names the robots: expected no HOST, --name or --base beside it")
    if not file and not hosts:
        raise click.UsageError("expected HOST, for instance ros@robot.local")
    if name and len(hosts) > 1:
        raise click.UsageError("--name is for one HOST, expected --from FILE for several")
    tasks = _read_tasks(Path(file)) if file else [_ask_task(host, name, base, variant) for host in hosts]
    _check_names(tasks)
    current, new = _passwords(tasks, passwords_from, dry_run=dry_run)
    library = read_repository(REPOSITORY)
    tasks = [
        replace(
            task,
            robot=replace(task.robot, master=task.robot.master and master),
            library=library,
            current=current,
            new=new,
            new_host_key=new_host_key,
        )
        for task in tasks
    ]
    here = LocalShell()
    viewer = prepare_viewer(here, getpass.getuser())
    if dry_run:
        return _for_each(tasks, lambda task: _preview(task, viewer))
    return _for_each(tasks, lambda task: _set_up(task, here, viewer))


def _set_up(task: Task, here: LocalShell, viewer: Viewer) -> int:
    say = _reporter(task)
    count = set_up(task, here, viewer, say)
    # Looked at through the new name, by key, with strict host keys: as it will be used.
    with open_robot(replace(task, address=task.later, new_host_key=False), say) as there:
        checks = verify(task, here, there, viewer, wait_for_master)
    _print_checks(task, checks)
    bad = sum(not check.good for check in checks)
    if bad:
        say(f"{bad} of {len(checks)} points are not as they should be; 'ur doctor {task.robot.name}' says more")
        return 1
    say(
        "nothing to do: it is ready"
        if not count
        else f"ready after {count} changes; select it: ur use {task.robot.name}"
    )
    return 0


def wait_for_master(host: str) -> bool:
    """Whether the ROS master of a robot answers here, which it may do only a while after the boot."""
    from ur.cli.master import list_node_names

    end = time.monotonic() + MASTER_SECONDS
    while time.monotonic() < end:
        if list_node_names(host, 2.0) is not None:
            return True
        time.sleep(0.2)
    return False


def _preview(task: Task, viewer: Viewer) -> int:
    from ur.cli.setup import show_changes

    with open_robot(task, _reporter(task)) as shell:
        changes = preview(task, shell, viewer)
    click.echo(f"{task.robot.name} ({task.address}): " + ("" if changes else "nothing to do"))
    show_changes(changes)
    return 0


def _for_each(tasks: Sequence[Task], work: Callable[[Task], int]) -> int:
    """Do all at once; a robot that fails does not stop the others. The worst exit code."""

    def guarded(task: Task) -> int:
        try:
            return work(task)
        except UserError as problem:
            sys.stderr.write(render_human(problem.diagnostics, colour=sys.stderr.isatty()))
            return 2

    if len(tasks) == 1:
        return guarded(tasks[0])
    pool = ThreadPoolExecutor(len(tasks))
    try:
        return max(pool.map(guarded, tasks))
    except KeyboardInterrupt:
        # The others wait for their robots, maybe for long. What they have started ends with this process.
        sys.stderr.write("interrupted; the same command goes on where it stopped\n")
        sys.stderr.flush()
        os._exit(130)
    finally:
        pool.shutdown()


def _reporter(task: Task) -> Callable[[str], None]:
    def say(text: str) -> None:
        sys.stdout.write(f"{task.robot.name}: {text}\n")
        sys.stdout.flush()

    return say


def _print_checks(task: Task, checks: Sequence[Check]) -> None:
    from rich.console import Console
    from rich.table import Table

    table = Table(title=task.robot.name, title_justify="left")
    for column in ("", "point", "seen from", "what"):
        table.add_column(column)
    for check in checks:
        table.add_row("[green]ok[/]" if check.good else "[red]NO[/]", check.title, check.place, check.seen)
    Console(soft_wrap=not sys.stdout.isatty()).print(table)


def _ask_task(host: str, name: str | None, base: str | None, variant: str | None) -> Task:
    address = parse_address(host, DEFAULT_USER)
    if name is None:
        name = _ask(f"name of the robot at {address.host}", address.host.split(".")[0])
    if base is None:
        base = _ask(f"base of {name} ({', '.join(list_bases(PACKAGE))})", None)
    load_base(PACKAGE, base, variant or "")
    return Task(address, Robot(name, base, variant or ""))


def _ask(what: str, default: str | None) -> str:
    if not sys.stdin.isatty():
        option = what.split()[0]
        raise UserError(
            error(
                f"{what} is not given, and there is no terminal to ask on",
                rule="missing-answer",
                help=f"give --{option}",
            )
        )
    answer: str = click.prompt(what, default=default)
    return answer


def _read_tasks(path: Path) -> list[Task]:
    top = read_section(path, "a file of robots")
    tasks = [_read_task(item) for item in top.sections("robots")]
    top.finish()
    if not tasks:
        raise UserError(error(f"{path}: no robots, expected a list 'robots'", rule="bad-value"))
    return tasks


def _read_task(item: Section) -> Task:
    address = parse_address(item.text("host"), item.text("user", DEFAULT_USER))
    robot = Robot(item.text("name"), item.text("base"), item.text("variant", ""), item.boolean("master", True))
    item.finish()
    load_base(PACKAGE, robot.base, robot.variant)
    return Task(address, robot)


def _check_names(tasks: Sequence[Task]) -> None:
    names = [task.robot.name for task in tasks]
    for name in names:
        if not is_robot_name(name):
            raise UserError(
                error(
                    f"{name!r} is not the name of a computer, expected up to 63 lower case letters, digits and -",
                    rule="bad-name",
                )
            )
        if names.count(name) > 1 or name in (socket.gethostname().split(".")[0], "localhost", "sim"):
            raise UserError(
                error(f"name {name!r} is taken, expected a name of its own for each computer", rule="taken-name")
            )


def _passwords(tasks: Sequence[Task], descriptor: int | None, *, dry_run: bool) -> tuple[Secret | None, Secret | None]:
    """The present and the new password: from a descriptor, or asked without an echo; None for an empty one."""
    if descriptor is not None:
        try:
            with os.fdopen(descriptor, encoding="utf-8") as stream:
                lines = [*stream.read().split("\n"), "", ""]
        except (OSError, UnicodeDecodeError) as problem:
            raise UserError(
                error(f"--passwords-from {descriptor}: cannot be read: {problem}", rule="bad-descriptor")
            ) from None
        current, new = lines[:2]
    elif sys.stdin.isatty():
        who = ", ".join(str(task.address) for task in tasks)
        current = getpass.getpass(f"present password of {who} (empty: login by key): ")
        new = "" if dry_run else _ask_new()
    else:
        current = new = ""
    return (Secret(current) if current else None), (Secret(new) if new else None)


def _ask_new() -> str:
    while True:
        new = getpass.getpass("new password (empty: keep the present one): ")
        if new == "" or getpass.getpass("the same again: ") == new:
            return new
        click.echo("the two differ; once more")


for _change in (rename, wifi, network):
    command.add_command(_change)
