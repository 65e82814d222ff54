"""`ur doctor`: problems between this computer and a robot."""

from __future__ import annotations

import getpass
import json
import os
import socket
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, nullcontext
from dataclasses import asdict, dataclass, field
from pathlib import Path

import click

from ur.cli.output import plain_text
from ur.cli.robots.fleet import ALL, ask_passwords, choose_robots, is_fleet, print_json_of_each, run_for_each
from ur.devices.known import Expected
from ur.recordings.black_boxes import notify_black_boxes
from ur.request.environment import choose_ros, current_selection
from ur.request.programs import PACKAGE
from ur.request.remote.connection import connect_robot, list_nodes, robot_address
from ur.robot.base import load_base
from ur.robot.devices import expected_devices
from ur.robot.discovery.record import RobotRecord, load_records, records_folder
from ur.robot.discovery.seen import SeenRobot, load_seen, note_seen, seen_path
from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand
from ur.robot.doctor.inspect import inspect_computer, inspect_pair, inspect_until_fixed, list_safe, read_name, run_fix
from ur.robot.doctor.route import RouteStep, explain_route, inspect_route, list_steps
from ur.robot.doctor.rules import diagnose, diagnose_alone
from ur.robot.doctor.side import Side
from ur.robot.doctor.summary import describe_ros2, summarize
from ur.robot.ssh.address import Address
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import LocalShell, Shell
from ur.source.diagnostic import UserError
from ur.source.printable import printable, printable_lines
from ur.source.progress_line import show_progress
from ur.source.render import shows_colour
from ur.system.debian_root import describe_system, find_root

Apply = Callable[[Sequence[tuple[str, FixCommand]]], list[Finding]]
PAUSE = 2.0


@click.command("doctor")
@click.argument("robots", nargs=-1, metavar="[ROBOT ...]")
@ALL
@click.option("--fix", is_flag=True, help="Run the commands that are safe, then check again.")
@click.option("--verbose", "-v", is_flag=True, help="Show every result.")
@click.option("--json", "as_json", is_flag=True, help="Print the findings and their commands as JSON.")
@click.option(
    "--password-from",
    type=int,
    metavar="FD",
    help="Read the robot's password from this file descriptor, if it refuses your key.",
)
@click.option("--wireless", is_flag=True, help="Measure only the connection: signal of both, latency, loss.")
@click.option("--watch", is_flag=True, help="With --wireless: measure until Ctrl-C, and print a line each second.")
@click.option(
    "--seconds",
    type=click.IntRange(1, 86400),
    help="With --wireless: how long to measure. [default: 5; --watch: no end]",
)
@click.option(
    "--log",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="FILE",
    help="With --wireless: write a line each second to a new CSV file.",
)
def command(
    robots: tuple[str, ...],
    every: bool,
    fix: bool,
    verbose: bool,
    as_json: bool,
    password_from: int | None,
    wireless: bool,
    watch: bool,
    seconds: int | None,
    log: Path | None,
) -> int:
    """Find problems of this computer, of a robot and of their connection.

    Inspects both computers; each finding has a fix, as a command where possible. Without ROBOT, the selected one is
    inspected, or this computer alone if a simulated one is selected. Requirements of real robots are then left out,
    unless one was set up from here. The exit code is 0 without a problem, 1 with one, 2 when a robot could not be
    reached.

    With --wireless, carry this computer or the robot around to find the places where the connection is bad. Without an
    answer, 'no answer' is printed and the measurement continues; the exit code is 1 without any.
    """
    if wireless:
        if len(robots) > 1 or every or fix or verbose or as_json:
            raise click.UsageError("--wireless measures one robot, and has no --all, --fix, --verbose or --json")
        from ur.cli.computer.wireless import measure_wireless

        return measure_wireless(robots[0] if robots else None, watch, seconds, log)
    if watch or seconds or log:
        raise click.UsageError("--watch, --seconds and --log require --wireless")
    chosen = choose_robots(robots, every=every)
    if is_fleet(chosen, every=every):
        return _examine_each(chosen, fix=fix, verbose=verbose, as_json=as_json, password_from=password_from)
    robot = chosen[0] if chosen else None
    local = LocalShell(terminal=sys.stdin.isatty())
    if robot is None and current_selection(os.environ).simulated:
        return _examine_alone(local, fix=fix, as_json=as_json)
    address = robot_address(robot)
    with ExitStack() as stack:
        try:
            remote, password, refused = enter_robot(stack, address, password_from)
        except UserError as problem:
            return _explain_route(local, address, problem, as_json=as_json)
        return _examine(local, remote, password, refused, fix=fix, verbose=verbose, as_json=as_json)


def _examine_each(robots: Sequence[str], *, fix: bool, verbose: bool, as_json: bool, password_from: int | None) -> int:
    passwords = ask_passwords(robots, password_from, root=fix)
    options = [name for name, given in (("--fix", fix), ("--verbose", verbose), ("--json", as_json)) if given]

    def make_argv(robot: str) -> list[str]:
        return ["doctor", robot, *options, *(["--password-from", "0"] if passwords[robot] else [])]

    if as_json:
        return print_json_of_each("doctor", robots, make_argv, passwords)
    return run_for_each("doctor", robots, make_argv, passwords=passwords, show="all" if verbose else "failed")


def _examine(
    local: LocalShell,
    remote: SshShell,
    password: Secret | None,
    refused: bool,
    *,
    fix: bool,
    verbose: bool,
    as_json: bool,
) -> int:
    pair = _inspect(local, remote, refused)
    report = DoctorReport({"local": pair.local.name, "remote": pair.remote.name}, diagnose(pair))
    note_seen(seen_path(os.environ), _seen(pair))
    hint = f"ur doctor {pair.remote.name} --fix"
    if not as_json:
        if verbose:
            # Print all inspected properties of both computers side by side
            from rich.console import Console
            from rich.table import Table

            table = Table()
            for column in ("", pair.local.name, pair.remote.name):
                table.add_column(plain_text(column), overflow="fold")
            for row in summarize(pair):
                table.add_row(*map(plain_text, row))
            Console(soft_wrap=not sys.stdout.isatty()).print(table)
        print_report(report, fixable="" if fix else hint)

    def apply(commands: Sequence[tuple[str, FixCommand]]) -> list[Finding]:
        if any(each.where == "remote" and each.root for _, each in commands):
            find_sudo(remote, password)
        _apply(commands, local, remote, report, quiet=as_json)
        inspect = lambda: diagnose(_inspect(local, remote, refused=False))  # noqa: E731 - a name for a line
        return inspect_until_fixed(report.findings, inspect, _wait)

    return _conclude(report, apply if fix else None, as_json=as_json)


def _examine_alone(local: LocalShell, *, fix: bool, as_json: bool) -> int:
    side = _inspect_alone(local)
    simulation = not load_records(records_folder(os.environ))
    report = DoctorReport({"local": side.name, "remote": ""}, diagnose_alone(side, simulation=simulation))
    if simulation:
        known = {finding.rule for finding in report.findings}
        report.for_robot = [finding for finding in diagnose_alone(side) if finding.rule not in known]
    if not as_json:
        # Print the inspected computer, and its ROS; `ros1` describes its ROS 1
        ros1 = describe_system(find_root(os.environ), choose_ros(current_selection(os.environ), os.environ))
        click.echo(f"a simulated robot is selected: this computer alone ({side.name})")
        click.echo(ros1)
        for line in describe_ros2(side.ros2):
            click.echo(printable(line))
        print_report(report, fixable="" if fix else "ur doctor --fix")

    def apply(commands: Sequence[tuple[str, FixCommand]]) -> list[Finding]:
        _apply(commands, local, local, report, quiet=as_json)
        return diagnose_alone(_inspect_alone(local), simulation=simulation)

    return _conclude(report, apply if fix else None, as_json=as_json)


def _conclude(report: DoctorReport, apply: Apply | None, *, as_json: bool) -> int:
    """Run the safe commands, print the remaining findings, and return the exit code.

    `apply` runs commands, each with its rule, and returns the findings after them; None changes nothing.
    """
    if report.findings:
        notify_black_boxes(os.environ, f"ur doctor: {report.findings[0].message}")
    commands = list_safe(report.findings)
    if apply and commands:
        report.findings = apply(commands)
        if not as_json:
            click.echo("after the fixes:")
            print_report(report)
    if as_json:
        print_json(report)
    return 1 if report.findings else 0


def _explain_route(local: LocalShell, address: Address, problem: UserError, *, as_json: bool) -> int:
    """Report the step of the route to a robot that fails, and the findings about this computer."""
    found = problem.diagnostics[0]
    if found.rule in ("missing-program", "bad-address"):
        raise problem
    with show_progress(f"finding out which step towards {short_name(address)} fails"):
        route = inspect_route(local, address, found.rule, found.reason or found.message)
    seen = load_seen(seen_path(os.environ)).get(short_name(address))
    side = _inspect_alone(local)
    findings = [*diagnose_alone(side), explain_route(address, route, seen, _record(short_name(address)), time.time())]
    report = DoctorReport({"local": side.name, "remote": short_name(address)}, findings, list_steps(address, route))
    if as_json:
        print_json(report)
    else:
        click.echo(f"{address} could not be reached:")
        print_report(report)
    return 2


def _inspect(local: LocalShell, remote: SshShell, refused: bool) -> ComputerPair:
    selection = current_selection(os.environ)
    record = _record(read_name(remote))
    with show_progress(f"examining this computer and {short_name(remote.address)}"):
        return inspect_pair(
            local,
            remote,
            list_nodes(remote.address.host),
            key_refused=refused,
            known=record is not None,
            robot_login=record is None or record.robot_login is not False,
            selected="" if selection.simulated else selection.robot,
            expected=_expected(record),
        )


def _inspect_alone(local: LocalShell) -> Side:
    with show_progress("examining this computer"):
        return inspect_computer(local)


def _apply(
    commands: Sequence[tuple[str, FixCommand]], local: Shell, remote: Shell, report: DoctorReport, *, quiet: bool
) -> None:
    lock = seen_path(os.environ).with_name("doctor.lock")
    for rule, each in commands:
        # On this computer sudo may ask for a password on the terminal.
        asks = each.root and each.where == "local"
        with nullcontext() if asks else show_progress(f"running {each.line}"):
            result = run_fix(each, local, remote, lock)
        report.fixed.append((rule, result))
        if not quiet:
            click.echo(f"  {rule}: {result}")


def _wait() -> None:
    with show_progress("waiting for the fixes to take effect"):
        time.sleep(PAUSE)


def _seen(pair: ComputerPair) -> list[SeenRobot]:
    addresses = sorted(pair.local.resolves & set(pair.remote.addresses))
    return [SeenRobot(pair.remote.name, addresses[0], time.time())] if addresses else []


def _expected(record: RobotRecord | None) -> tuple[Expected, ...]:
    """Return the devices that the robot's base needs, if this computer has a description of the base."""
    try:
        return expected_devices(load_base(PACKAGE, record.base, record.variant)) if record and record.base else ()
    except UserError:
        return ()


def _record(name: str) -> RobotRecord | None:
    return next((record for record in load_records(records_folder(os.environ)) if record.name == name), None)


def enter_robot(stack: ExitStack, address: Address, password_from: int | None) -> tuple[SshShell, Secret | None, bool]:
    """Log in: by key, by password, or, if the name cannot be resolved, at the robot's last known address.

    Returns the shell, the password if one was needed, and whether the key was refused. Raises UserError.
    """
    try:
        return _log_in(stack, address, password_from, ())
    except UserError as problem:
        seen = load_seen(seen_path(os.environ)).get(short_name(address))
        if not seen or problem.diagnostics[0].rule not in ("unknown-host", "no-answer"):
            raise
        first = problem
    try:
        same = ("-o", f"HostKeyAlias={address.host}", "-o", "CheckHostIP=no")
        return _log_in(stack, Address(address.user, seen.address), password_from, same)
    except UserError:
        raise first from None


def _log_in(
    stack: ExitStack, address: Address, password_from: int | None, options: Sequence[str]
) -> tuple[SshShell, Secret | None, bool]:
    try:
        return stack.enter_context(connect_robot(address, options=options)), None, False
    except UserError as problem:
        password = _password(address, password_from) if problem.diagnostics[0].rule == "refused" else None
        if password is None:
            raise
        shell = stack.enter_context(connect_robot(address, password=password, options=options))
        return shell, password, True


def _password(address: Address, descriptor: int | None) -> Secret | None:
    """Return the password for a robot that refuses the key: from the terminal, or a descriptor; None without either."""
    if descriptor is not None:
        with os.fdopen(descriptor, encoding="utf-8") as stream:
            text = stream.readline().rstrip("\n")
    elif sys.stdin.isatty():
        text = getpass.getpass(f"{address} refuses our key; its password (empty: none): ")
    else:
        text = ""
    return Secret(text) if text else None


def find_sudo(remote: SshShell, password: Secret | None) -> None:
    """Find out how to become root on the robot: with the password of the login, or one that the user enters."""
    if not remote.find_sudo([password] if password else []) and sys.stdin.isatty():
        remote.find_sudo([Secret(getpass.getpass(f"password of {remote.destination}: "))])


def short_name(address: Address) -> str:
    """Return the name of a computer without its domain."""
    name = address.host.removesuffix(".local")
    return socket.gethostname().split(".")[0] if name == "localhost" else name


MARKS = {True: ("ok", "green"), False: ("NO", "red"), None: ("-", "bright_black")}


@dataclass(slots=True)
class DoctorReport:
    """The result of one run of the doctor.

    `names`: the names of the two computers, as printed before a command. `for_robot` are findings that matter only
    after the first real robot is set up from this computer.
    """

    names: Mapping[str, str]
    findings: Sequence[Finding] = ()
    steps: Sequence[RouteStep] = ()
    fixed: list[tuple[str, str]] = field(default_factory=list)
    for_robot: Sequence[Finding] = ()


def print_report(report: DoctorReport, *, fixable: str = "") -> None:
    """Print the steps of the route, if the robot was not reached, and each finding with its fix.

    `fixable` is the advice for findings that `--fix` handles.
    """
    for step in report.steps:
        mark, colour = MARKS[step.good]
        text = f"{step.title}: {step.seen}" if step.seen else step.title
        click.echo(f"  {_style(f'{mark:2}', colour)} {printable(text)}")
    for finding in report.findings:
        click.echo(f"{_style('problem', 'red')}: {printable(finding.message)} [{finding.rule}]")
        if finding.help:
            click.echo(f"  {_style('help', 'green')}: {printable(finding.help)}")
        for command in finding.commands:
            who = f"on {report.names[command.where]}{' (--fix)' if command.safe else ''}"
            click.echo(f"  {_style(printable(who), 'green')}: {printable_lines(command.typed)}")
    fixable_count = sum(finding.fixable for finding in report.findings)
    if not report.findings:
        click.echo("all is well")
    elif fixable_count and fixable:
        click.echo(f"{fixable_count} of {len(report.findings)} can be fixed by: {fixable}")
    if report.for_robot:
        click.echo("before you set up a real robot, run: ur setup")
        for finding in report.for_robot:
            click.echo(f"  {printable(finding.message)}")


def print_json(report: DoctorReport) -> None:
    """Print the report as JSON."""
    findings, for_robot = (
        [
            {
                "rule": finding.rule,
                "message": finding.message,
                "help": finding.help,
                "commands": [
                    {"on": report.names[each.where], "where": each.where, "command": each.typed, "fix": each.safe}
                    for each in finding.commands
                ],
            }
            for finding in found
        ]
        for found in (report.findings, report.for_robot)
    )
    fixed = [{"rule": rule, "result": result} for rule, result in report.fixed]
    whole = {
        "findings": findings,
        "for_robot": for_robot,
        "steps": [asdict(step) for step in report.steps],
        "fixed": fixed,
    }
    click.echo(json.dumps(whole, indent=2))


def _style(text: str, colour: str) -> str:
    return click.style(text, fg=colour, bold=True) if shows_colour(sys.stdout) else text
