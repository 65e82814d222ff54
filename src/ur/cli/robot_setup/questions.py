"""Settings of `ur robot setup`: read from options and files, else asked at the terminal."""

import getpass
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from ur.cli.output import ask_twice, check_name, read_lines, taken_error
from ur.cli.robot_setup.contact import TERMINAL, SetupTerminal
from ur.cli.robots.fleet import choose_robots
from ur.request.programs import PACKAGE
from ur.request.remote.connection import robot_address
from ur.robot.base import list_bases, list_variants, load_base
from ur.robot.discovery.record import DEFAULT_USER, RobotRecord, load_records, records_folder
from ur.robot.setup.login import Task
from ur.robot.setup.robot_states import WantedRobot
from ur.robot.ssh.address import parse_address
from ur.robot.ssh.host_key import parse_fingerprint
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import user_error, user_error_about
from ur.source.section import Section, read_section

PLAIN = "plain"


def ask_task(
    host: str, name: str | None, base: str | None, variant: str | None, terminal: SetupTerminal = TERMINAL
) -> Task:
    """Return the task for one robot. Missing values are asked for; the defaults are those of its record.

    Without a terminal, a missing variant is the recorded one, else the plain one. Raises UserError if a value is
    missing, or the base or variant does not exist.
    """
    address = parse_address(host, DEFAULT_USER)
    if name is None:
        name = _ask(f"name of the robot at {address.host}", address.host.split(".")[0], terminal)
    known = {record.name: record for record in load_records(records_folder(os.environ))}
    record = known.get(name) or known.get(address.host.split(".")[0]) or RobotRecord(name, address.user, "")
    if base is None:
        base = _ask(f"base of {name} ({', '.join(list_bases(PACKAGE))})", record.base or None, terminal)
    load_base(PACKAGE, base)
    if variant is None:
        variant = _ask_variant(name, base, record.variant if record.base == base else "", terminal)
    variant = "" if variant == PLAIN else variant
    load_base(PACKAGE, base, variant)
    return Task(address, WantedRobot(name, base, variant))


def list_known_tasks() -> list[Task]:
    """Return a task for each robot that was set up from this computer, with its recorded values.

    Raises UserError if there is none.
    """
    known = {record.name: record for record in load_records(records_folder(os.environ))}
    records = [known[name] for name in choose_robots([], every=True)]
    for record in records:
        load_base(PACKAGE, record.base, record.variant)
    return [Task(robot_address(each.name), WantedRobot(each.name, each.base, each.variant)) for each in records]


def _ask_variant(name: str, base: str, known: str, terminal: SetupTerminal) -> str:
    variants = list_variants(PACKAGE, base)
    if not variants:
        return ""
    if not terminal.is_there():
        return known if known in variants else ""
    default = known if known in variants else PLAIN
    return _ask(f"variant of {name}, a {base} ({', '.join((PLAIN, *variants))})", default, terminal)


def _ask(what: str, default: str | None, terminal: SetupTerminal) -> str:
    if not terminal.is_there():
        option = what.split()[0]
        raise user_error(
            f"{what} is not given, and there is no terminal to ask on", rule="missing-answer", help=f"give --{option}"
        )
    return terminal.ask(what, default)


def read_tasks(path: Path) -> tuple[list[Task], dict[str, str]]:
    """Read the tasks in a file of robots, and the fingerprints of host keys, by robot's name. Raises UserError."""
    top = read_section(path, "a file of robots")
    items = list(top.sections("robots"))
    fingerprints = {item.text("name"): _read_fingerprint(item) for item in items if item.has("host_key")}
    tasks = [_read_task(item) for item in items]
    top.finish()
    if not tasks:
        raise user_error_about(path, "no robots, expected a list 'robots'", rule="bad-value")
    return tasks, fingerprints


def _read_fingerprint(item: Section) -> str:
    try:
        return parse_fingerprint(item.text("host_key"))
    except ValueError as problem:
        item.fail("host_key", f"host_key: {problem}")


def _read_task(item: Section) -> Task:
    address = parse_address(item.text("host"), item.text("user", DEFAULT_USER))
    robot = WantedRobot(
        item.text("name"),
        item.text("base"),
        item.text("variant", ""),
        item.boolean("master", True),
        item.boolean("programs", True),
    )
    item.finish()
    load_base(PACKAGE, robot.base, robot.variant)
    return Task(address, robot)


def check_names(tasks: Sequence[Task]) -> None:
    """Raise UserError if a name is invalid for a computer, or is taken."""
    names = [task.robot.name for task in tasks]
    for name in names:
        check_name(name)
        if names.count(name) > 1:
            raise taken_error(name)


def read_passwords(
    tasks: Sequence[Task], descriptor: int | None, *, dry_run: bool
) -> tuple[Secret | None, Secret | None]:
    """Read the present and the new password: from a descriptor, or without echo; None for an empty one."""
    if descriptor is not None:
        current, new = read_lines(descriptor, "--passwords-from", 2)
    elif sys.stdin.isatty():
        who = ", ".join(str(task.address) for task in tasks)
        current = getpass.getpass(f"present password of {who} (empty: login by key): ")
        new = "" if dry_run else ask_twice("new password (empty: keep the present one)")
    else:
        current = new = ""
    return (Secret(current) if current else None), (Secret(new) if new else None)
