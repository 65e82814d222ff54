"""`ur devices`: devices connected to this computer or a robot, their permissions, and the programs that use them."""

import json
import os
import socket
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import asdict

import click

from ur.cli.output import plain_text, write_exactly
from ur.devices.known import Device, DeviceSnapshot, Expected, describe_device, find_known
from ur.devices.needs import Need, examine, list_problems, write_rules
from ur.request.programs import PACKAGE
from ur.request.remote.connection import connect_robot, robot_address
from ur.robot.base import load_base
from ur.robot.devices import expected_devices, inspect_devices
from ur.robot.discovery.record import load_records, records_folder
from ur.robot.robot_file import load_robot_file
from ur.robot.ssh.shell import LocalShell, Shell
from ur.source.printable import printable
from ur.source.progress_line import show_progress


@click.command("devices")
@click.option("--robot", metavar="ROBOT", help="The robot to inspect: a name, HOST or USER@HOST. [default: here]")
@click.option("--base", metavar="BASE", help="Compare with what this base needs. [default: the robot's]")
@click.option("--variant", default="", help="The variant of BASE.")
@click.option(
    "--rules", is_flag=True, help="Print udev rules with the stable names that BASE needs, and inspect nothing."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def command(robot: str | None, base: str | None, variant: str, rules: bool, as_json: bool) -> int:
    """List the devices of this computer or a robot.

    They are lidars, motor boards, cameras, joysticks. Each line has the probable model by the USB id, the name that is
    the same at every port and after every boot, whether you may open the device, and which program has it open. On a
    robot, or with --base, the missing devices of the base are listed as well. The exit code is 1 when an expected
    device cannot be used.
    """
    expected = _find_expected(robot, base, variant)
    if rules:
        write_exactly(write_rules(expected))
        return 0
    with ExitStack() as stack:
        shell: Shell = LocalShell()
        name = socket.gethostname().split(".")[0]
        if robot is not None:
            address = robot_address(robot)
            shell, name = stack.enter_context(connect_robot(address)), address.host.removesuffix(".local")
        with show_progress(f"looking at the devices of {name}"):
            snapshot = inspect_devices(shell)
    needs = examine(snapshot, expected)
    if as_json:
        _print_json(snapshot, needs)
    else:
        _print_table(name, snapshot)
        for need in needs:
            if need.state == "ready":
                click.echo(printable(f"ok: {need.message}"))
            else:
                click.echo(printable(f"{need.state}: {need.message}"))
                click.echo(printable(f"  help: {need.help}"))
        reported = {need.device.path for need in needs if need.device}
        for state, device, help in list_problems(snapshot):
            if device.path not in reported:
                click.echo(printable(f"{state}: {device.path}"))
                click.echo(printable(f"  help: {help}"))
    return 1 if any(need.state != "ready" for need in needs) else 0


def _find_expected(robot: str | None, base: str | None, variant: str) -> tuple[Expected, ...]:
    """Return the expected devices of the given base, else of the robot's recorded one, else of this computer's."""
    if base is None and robot is None:
        file = load_robot_file()
        base, variant = (file.base, file.variant) if file else ("", "")
    elif base is None and robot is not None:
        name = robot.rpartition("@")[2].removesuffix(".local")
        record = next((each for each in load_records(records_folder(os.environ)) if each.name == name), None)
        base, variant = (record.base, record.variant) if record else ("", "")
    return expected_devices(load_base(PACKAGE, base, variant)) if base else ()


def _print_table(name: str, snapshot: DeviceSnapshot) -> None:
    from rich.console import Console
    from rich.table import Table

    devices = [each for each in snapshot.devices if each.kind != "usb" or find_known(each)]
    if not devices:
        where = ", which is a container: it shows only what its host passes on" if snapshot.container else ""
        click.echo(f"no devices are plugged into {printable(name)}{where}")
        return
    table = Table()
    for column in ("device", "what it is", "stable name", "you may open it", "in use by"):
        table.add_column(column, overflow="fold")
    unknown = "nobody" if snapshot.complete else f"nobody ({snapshot.user})"
    for each in devices:
        holders = ", ".join(f"{holder.program} ({holder.pid})" for holder in each.holders)
        may = plain_text("yes") if each.allowed else plain_text(f"no: group {each.group}", "red")
        table.add_row(*map(plain_text, (each.path, _with_id(each), each.stable)), may, plain_text(holders or unknown))
    Console(soft_wrap=not sys.stdout.isatty()).print(table)


def _with_id(device: Device) -> str:
    what = describe_device(device)
    number = f", {device.serial}" if device.serial else ""
    return f"{what} [{device.usb}{number}]" if device.usb else what


def _print_json(snapshot: DeviceSnapshot, needs: Sequence[Need]) -> None:
    devices = [
        {
            **asdict(each),
            "what": describe_device(each),
            "stable": each.stable,
            "mode": None if each.mode is None else f"{each.mode:o}",
        }
        for each in snapshot.devices
    ]
    expected = [
        {
            "part": need.expected.part,
            "path": need.expected.path,
            "state": need.state,
            "message": need.message,
            "help": need.help,
            "device": need.device.path if need.device else None,
        }
        for need in needs
    ]
    whole = {"devices": devices, "expected": expected, "all_users": snapshot.complete, "container": snapshot.container}
    click.echo(json.dumps(whole, indent=2))
