"""The report of `ur doctor`: findings with their commands, the route to a robot, tables; as text or as JSON."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field

import click

from ur.cli.output import plain_text
from ur.robot.doctor.findings import ComputerPair, Finding
from ur.robot.doctor.route import RouteStep
from ur.robot.doctor.side import Side
from ur.robot.doctor.summary import compare_packages, describe_ros2, summarize
from ur.source.printable import printable, printable_lines
from ur.source.render import shows_colour

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


def print_alone(side: Side, ros1: str) -> None:
    """Print the inspected computer, and its ROS; `ros1` describes its ROS 1."""
    click.echo(f"a simulated robot is selected: this computer alone ({side.name})")
    click.echo(ros1)
    for line in describe_ros2(side.ros2):
        click.echo(printable(line))


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


def print_seen(pair: ComputerPair) -> None:
    """Print all inspected properties of both computers side by side."""
    from rich.console import Console
    from rich.table import Table

    console = Console(soft_wrap=not sys.stdout.isatty())
    titles = (("", pair.local.name, pair.remote.name), ("package", pair.local.name, pair.remote.name))
    for title, rows in zip(titles, (summarize(pair), compare_packages(pair)), strict=True):
        table = Table()
        for column in title:
            table.add_column(plain_text(column), overflow="fold")
        for row in rows:
            table.add_row(*map(plain_text, row))
        if rows:
            console.print(table)


def _style(text: str, colour: str) -> str:
    return click.style(text, fg=colour, bold=True) if shows_colour(sys.stdout) else text
