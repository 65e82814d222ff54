"""`ur robot network`: a robot's network devices and their addresses, changed without losing the robot."""

from __future__ import annotations

import getpass
import sys
from functools import partial
from typing import TYPE_CHECKING

import click

from ur.cli.changing import DRY_RUN, PASSWORD_FROM, WAIT, become_root, begin, finish, print_line, show_plan
from ur.cli.output import plain_text, read_lines
from ur.source.diagnostic import user_error_about

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ur.robot.commit_confirm.guarded import GuardedChange
    from ur.robot.commit_confirm.network_facts import NetworkDevice, Networks
    from ur.robot.ssh.openssh import SshShell

LOOK_SECONDS = 60.0


@click.command("network")
@click.argument("robot", required=False)
@click.option("--address", metavar="ADDRESS/LENGTH", help="Its new address, for example 192.168.1.7/24.")
@click.option("--gateway", metavar="ADDRESS", help="The address of the router.")
@click.option("--dns", "names", multiple=True, metavar="ADDRESS", help="The address of a name server; may be repeated.")
@click.option("--dhcp", is_flag=True, help="Get an address from the network (DHCP).")
@click.option("--device", metavar="NAME", help="Which device. [default: the one by which it is reached]")
@PASSWORD_FROM
@WAIT
@DRY_RUN
def network(
    robot: str | None,
    address: str | None,
    gateway: str | None,
    names: tuple[str, ...],
    dhcp: bool,
    device: str | None,
    password_from: int | None,
    wait: int,
    dry_run: bool,
) -> int:
    """Show a robot's network devices; change an address, and revert if the robot cannot be reached.

    The robot takes the address and waits for this computer to reach it there. If that does not happen, it returns to
    its previous address. Needs NetworkManager on the robot, or netplan with systemd-networkd.
    """
    from ur.robot.commit_confirm.network import parse_addressing

    if dhcp and (address or gateway):
        raise click.UsageError("--dhcp cannot be used with --address or --gateway")
    if (gateway or names) and not (address or dhcp):
        raise click.UsageError("--gateway and --dns require --address or --dhcp")
    wanted = parse_addressing(address, gateway, names, dhcp=dhcp) if address or dhcp else None
    (password,) = read_lines(password_from, "--password-from", 1)

    def plan(shell: SshShell, networks: Networks) -> GuardedChange | None:
        from ur.robot.commit_confirm.choice import choose_manager

        chosen = _find_device(shell, networks, device)
        if wanted is None:
            _show_devices(networks)
            return None
        return choose_manager(networks, shell.destination, chosen).address(chosen, wanted)

    literal = str(wanted.address.ip) if wanted and wanted.address else None
    return change_network(robot, password, plan, wait, dry_run=dry_run, literal=literal)


def change_network(
    robot: str | None,
    password: str,
    plan: Callable[[SshShell, Networks], GuardedChange | None],
    wait: int,
    *,
    dry_run: bool,
    scan: bool = False,
    literal: str | None = None,
) -> int:
    """Read a robot's networks, plan a change, apply it and reconnect; without a change if the plan is None.

    `literal` is an address that the robot has after the change. Raises UserError.
    """
    from ur.request.remote.connection import connect_robot, robot_address
    from ur.robot.commit_confirm.guarded import change_request
    from ur.robot.commit_confirm.netplan import side_command
    from ur.robot.commit_confirm.network_facts import FACTS_SCRIPT, SCAN_SCRIPT, parse_networks
    from ur.robot.commit_confirm.perform import ChangeAddresses
    from ur.robot.setup.engine import gather
    from ur.robot.ssh.address import Address

    address = robot_address(robot)
    with connect_robot(address) as shell:
        sudo = become_root(shell, password)
        script = FACTS_SCRIPT + f"mark names; {side_command('names')} 2>/dev/null\n" + (SCAN_SCRIPT if scan else "")
        change = plan(shell, parse_networks(shell.run(script, root=True, timeout=LOOK_SECONDS).out))
        if change is None:
            return 0
        facts = gather(shell, change_request(change, address.user), root=True)
        if dry_run:
            show_plan(change, facts)
            return 0
        identity = begin(shell, change, facts, wait)
    after: tuple[Address, ...] = (*([Address(address.user, literal)] if literal else []), address)
    finish(identity, change, ChangeAddresses(after, address), wait, sudo, address.host)
    print_line(
        f"{change.title}: done" + (f"; {address.host} may need a moment until it leads there" if literal else "")
    )
    return 0


def _find_device(shell: SshShell, networks: Networks, name: str | None) -> NetworkDevice:
    """Return the device with this name, or the one that carries this connection. Raises UserError."""
    if name is None:
        fields = shell.run('echo "$SSH_CONNECTION"').out.split()
        found = networks.device_with(fields[2]) if len(fields) > 2 else None
    else:
        found = next((each for each in networks.devices if each.name == name), None)
    if found is None:
        from ur.robot.commit_confirm.network import check_managed

        check_managed(networks, shell.destination, None)
        names = ", ".join(each.name for each in networks.devices if each.kind != "loopback")
        raise user_error_about(
            shell.destination,
            f"{f'no network device {name!r}' if name else 'it is not clear which device is meant'}, "
            f"expected one of {names}",
            rule="bad-device",
            help="give --device",
        )
    return found


def _show_devices(networks: Networks) -> None:
    """Print all devices and their profiles."""
    rows = []
    for each in networks.devices:
        profile = networks.profile(each.profile)
        if each.kind != "loopback":
            rows.append((each.name, each.kind, each.state, profile.name if profile else "", ", ".join(each.addresses)))
    print_table(("device", "kind", "state", "network", "addresses"), rows)
    if not networks.running:
        services = ", ".join((*networks.others, *networks.netplan)) or "no network service known"
        print_line(f"NetworkManager does not run there, but: {services}")


def print_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table of plain texts."""
    from rich.console import Console
    from rich.table import Table

    table = Table()
    for head in heads:
        table.add_column(head)
    for row in rows:
        table.add_row(*map(plain_text, row))
    Console(soft_wrap=not sys.stdout.isatty()).print(table)


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
    one is out of range. Needs NetworkManager on the robot, or netplan with systemd-networkd.
    """
    if ssid is not None and forget is not None:
        raise click.UsageError("--ssid and --forget cannot be used together")
    if (hidden or band) and ssid is None:
        raise click.UsageError("--hidden and --band require --ssid NAME")
    network_password, own_password = read_lines(passwords_from, "--passwords-from", 2)

    def plan(shell: SshShell, networks: Networks) -> GuardedChange | None:
        from ur.robot.commit_confirm.choice import choose_manager, choose_network, find_known, refuse_wireless

        device = networks.wireless
        if device is None:
            refuse_wireless(shell.destination, networks)
        manager = choose_manager(networks, shell.destination, device)
        if ssid is not None:
            wanted = choose_network(
                networks, ssid, network_password, partial(_ask_password, ssid), hidden=hidden, band=band or ""
            )
            print_line(f"while the robot waits, this computer has to be in {ssid}, or in a network that leads there")
            return manager.join(wanted, device)
        if forget is not None:
            return manager.forget(find_known(networks, forget))
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
