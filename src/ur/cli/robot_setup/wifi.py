"""`ur robot wifi`: a robot's wireless networks, changed without losing it."""

from __future__ import annotations

import getpass
import sys
from functools import partial
from typing import TYPE_CHECKING

import click

from ur.cli.answers import read_lines
from ur.cli.changing import DRY_RUN, WAIT, print_line
from ur.cli.robot_setup.network import change_network, print_table

if TYPE_CHECKING:
    from ur.robot.commit_confirm.guarded import GuardedChange
    from ur.robot.commit_confirm.network_facts import NetworkDevice, Networks
    from ur.robot.ssh.openssh import SshShell


@click.command("wifi")
@click.argument("robot", required=False)
@click.option("--ssid", metavar="NAME", help="Join this network. Its password is asked for.")
@click.option("--hidden", is_flag=True, help="The network does not announce its name.")
@click.option("--band", type=click.Choice(["2.4", "5"]), help="Use this band only (GHz).")
@click.option("--forget", metavar="NAME", help="Forget this network.")
@click.option(
    "--passwords-from",
    type=int,
    metavar="FD",
    help="Read the network's password and the robot's, a line each, from this file descriptor.",
)
@WAIT
@DRY_RUN
def wifi(
    robot: str | None,
    ssid: str | None,
    hidden: bool,
    band: str | None,
    forget: str | None,
    passwords_from: int | None,
    wait: int,
    dry_run: bool,
) -> int:
    """Show a robot's wireless networks; join or forget one, and revert if the robot cannot be reached.

    The robot joins the network and waits for this computer to reach it there: join the same network meanwhile. If that
    does not happen, it returns to its previous network. Networks that it knew before are kept, for places where the new
    one is out of range. Needs NetworkManager on the robot.
    """
    if ssid is not None and forget is not None:
        raise click.UsageError("--ssid and --forget cannot be used together")
    if (hidden or band) and ssid is None:
        raise click.UsageError("--hidden and --band require --ssid NAME")
    network_password, own_password = read_lines(passwords_from, "--passwords-from", 2)

    def plan(shell: SshShell, networks: Networks) -> GuardedChange | None:
        from ur.robot.commit_confirm.choice import choose_network, find_known, refuse_wireless
        from ur.robot.commit_confirm.network import check_managed, plan_forget, plan_join

        device = networks.wireless
        if device is None:
            refuse_wireless(shell.destination, networks)
        check_managed(networks, shell.destination, device)
        assert device is not None
        if ssid is not None:
            wanted = choose_network(
                networks, ssid, network_password, partial(_ask_password, ssid), hidden=hidden, band=band or ""
            )
            print_line(f"while the robot waits, this computer has to be in {ssid}, or in a network that leads there")
            return plan_join(networks, wanted, device)
        if forget is not None:
            return plan_forget(networks, find_known(networks, forget))
        _show(networks, device)
        return None

    return change_network(robot, own_password, plan, wait, dry_run=dry_run, scan=True)


def _ask_password(ssid: str, known: bool) -> str:
    if not sys.stdin.isatty():
        return ""
    return getpass.getpass(f"password of {ssid}{' (empty: the one that the robot knows)' if known else ''}: ")


def _show(networks: Networks, device: NetworkDevice) -> None:
    """Print the network that the robot uses, and those in range."""
    profile = networks.profile(device.profile)
    using = f"uses {profile.ssid or profile.name}" if profile else f"uses no network ({device.state})"
    print_line(f"{device.name} {using}{''.join(f', {address}' for address in device.addresses if ':' not in address)}")
    known = {each.ssid for each in networks.profiles if each.ssid}
    print_table(
        ("network", "signal", "band", "security", ""),
        [
            (
                each.ssid,
                f"{each.signal} %",
                ", ".join(each.bands),
                each.security or "open",
                "used" if each.used else "known" if each.ssid in known else "",
            )
            for each in networks.seen
        ],
    )
    away = sorted(known - {each.ssid for each in networks.seen})
    if away:
        print_line(f"known, and not in reach: {', '.join(away)}")
