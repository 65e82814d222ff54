"""`ur robot wifi` and `ur robot network`: a robot's networks, changed without losing it."""

from __future__ import annotations

import getpass
import sys
from typing import TYPE_CHECKING

import click

from ur.cli.guarded import DRY_RUN, PASSWORD_FROM, WAIT, become_root, begin, finish, read_lines, say, show_plan
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ur.robot.change.guarded import GuardedChange
    from ur.robot.change.network import Wifi
    from ur.robot.change.network_facts import Device, Networks, Profile
    from ur.robot.ssh.openssh import SshShell

SCAN_SECONDS = 60.0


@click.command("wifi")
@click.argument("robot", required=False)
@click.option("--ssid", metavar="NAME", help="Join this network. Its password is asked for.")
@click.option("--hidden", is_flag=True, help="The network does not tell its name.")
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
    """Show a robot's wireless networks; join or forget one, without losing the robot.

    The robot joins the network and waits for this computer to reach it there: join the same network meanwhile. Where
    that does not happen, it goes back to the network that it had. What it knew before stays, for places where the new
    network is not in reach. Needs NetworkManager on the robot.
    """
    if ssid is not None and forget is not None:
        raise click.UsageError("--ssid and --forget are two changes, expected one of them")
    if (hidden or band) and ssid is None:
        raise click.UsageError("--hidden and --band say how to join a network, expected --ssid NAME with them")
    network_password, own_password = read_lines(passwords_from, "--passwords-from", 2)

    def plan(shell: SshShell, networks: Networks) -> GuardedChange | None:
        from ur.robot.change.network import check_managed, plan_forget, plan_join

        device = networks.wireless
        if device is None:
            _refuse_wireless(shell.place, networks)
        check_managed(networks, shell.place, device)
        assert device is not None
        if ssid is not None:
            wanted = _choose(networks, ssid, network_password, hidden=hidden, band=band or "")
            say(f"join {ssid} with this computer, too, if it is in another network now")
            return plan_join(networks, wanted, device)
        if forget is not None:
            return plan_forget(networks, _find_known(networks, forget))
        _show(networks, device)
        return None

    return _change(robot, own_password, plan, wait, dry_run=dry_run, scan=True)


@click.command("network")
@click.argument("robot", required=False)
@click.option("--address", metavar="ADDRESS/LENGTH", help="Its address from now on, for instance 192.168.1.7/24.")
@click.option("--gateway", metavar="ADDRESS", help="The way to other networks.")
@click.option("--dns", "names", multiple=True, metavar="ADDRESS", help="Who resolves names; may be repeated.")
@click.option("--dhcp", is_flag=True, help="Let the network give it an address.")
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
    """Show a robot's network devices; give one another address, without losing the robot.

    The robot takes the address and waits for this computer to reach it there. Where that does not happen, it goes back
    to the address that it had. Needs NetworkManager on the robot.
    """
    from ur.robot.change.network import parse_addressing

    if dhcp and (address or gateway):
        raise click.UsageError("--dhcp gives address and gateway, expected no --address or --gateway beside it")
    if (gateway or names) and not (address or dhcp):
        raise click.UsageError("--gateway and --dns belong to an address, expected --address or --dhcp with them")
    wanted = parse_addressing(address, gateway, names, dhcp=dhcp) if address or dhcp else None
    (password,) = read_lines(password_from, "--password-from", 1)

    def plan(shell: SshShell, networks: Networks) -> GuardedChange | None:
        from ur.robot.change.network import check_managed, plan_addressing

        chosen = _find_device(shell, networks, device)
        if wanted is None:
            _show_devices(networks)
            return None
        check_managed(networks, shell.place, chosen)
        profile = networks.profile(chosen.profile)
        if profile is None:
            raise UserError(
                error(
                    f"{chosen.name}: it is in no network ({chosen.state}), expected a device in use", rule="bad-device"
                )
            )
        return plan_addressing(networks, profile, chosen, wanted)

    literal = str(wanted.address.ip) if wanted and wanted.address else None
    return _change(robot, password, plan, wait, dry_run=dry_run, literal=literal)


def _change(
    robot: str | None,
    password: str,
    plan: Callable[[SshShell, Networks], GuardedChange | None],
    wait: int,
    *,
    dry_run: bool,
    scan: bool = False,
    literal: str | None = None,
) -> int:
    from ur.cli.shell import robot_address
    from ur.robot.change.guarded import change_request
    from ur.robot.change.network_facts import FACTS_SCRIPT, SCAN_SCRIPT, parse_networks
    from ur.robot.change.perform import Ways
    from ur.robot.setup.engine import gather
    from ur.robot.ssh.openssh import Address, connect

    address = robot_address(robot)
    with connect(address) as shell:
        sudo = become_root(shell, password)
        script = FACTS_SCRIPT + (SCAN_SCRIPT if scan else "")
        change = plan(shell, parse_networks(shell.run(script, root=True, timeout=SCAN_SECONDS).out))
        if change is None:
            return 0
        facts = gather(shell, change_request(change, address.user), root=True)
        if dry_run:
            show_plan(change, facts)
            return 0
        identity = begin(shell, change, facts, wait)
    after: tuple[Address, ...] = (*([Address(address.user, literal)] if literal else []), address)
    finish(identity, change, Ways(after, address), wait, sudo, address.host)
    say(f"{change.title}: done" + (f"; {address.host} may need a moment until it leads there" if literal else ""))
    return 0


def _choose(networks: Networks, ssid: str, password: str, *, hidden: bool, band: str) -> Wifi:
    """What to join, after asking for what is missing. Raises UserError: out of reach, or not a password."""
    from ur.robot.change.network import Wifi, check_password, choose_management, find_profile
    from ur.robot.ssh.secret import Secret

    seen = next((each for each in networks.seen if each.ssid == ssid), None)
    if seen is None and not hidden:
        near = did_you_mean(ssid, [each.ssid for each in networks.seen])
        reach = ", ".join(each.ssid for each in networks.seen[:8]) or "none"
        raise UserError(
            error(
                f"{ssid}: the robot sees no network of this name, expected one in reach: {reach}",
                rule="unknown-network",
                help=f"did you mean {near!r}?" if near else "a network that does not tell its name: --hidden",
            )
        )
    known = find_profile(networks, ssid) is not None
    secured = seen.security not in ("", "OWE") if seen else True
    if not password and secured and sys.stdin.isatty():
        password = getpass.getpass(f"password of {ssid}{' (empty: the one that the robot knows)' if known else ''}: ")
    if known and not password:  # its profile knows how, also with a user name
        return Wifi(ssid, None, "", hidden, band)
    if not password and seen and secured:
        raise UserError(
            error(
                f"{ssid}: it wants a password, and none is given",
                rule="missing-answer",
                help="run this in a terminal, or give --passwords-from FD",
            )
        )
    management = choose_management(seen, with_password=bool(password))
    secret = Secret(password) if password and management in ("wpa-psk", "sae") else None
    if secret:
        check_password(ssid, secret)
    return Wifi(ssid, secret, management, hidden, band)


def _refuse_wireless(place: str, networks: Networks) -> None:
    """Raises UserError: there is no wireless device, or it is not ours to change."""
    from ur.robot.change.network import check_managed

    device = next((each for each in networks.devices if each.kind == "wifi"), None)
    check_managed(networks, place, device)
    raise UserError(
        error(
            f"{place}: it has no wireless device, expected one",
            rule="no-wifi",
            help="is its adapter plugged in, and is its driver there? 'ur robot network' shows what it has",
        )
    )


def _find_known(networks: Networks, name: str) -> Profile:
    """The profile of a network. Raises UserError: the robot knows no such network."""
    from ur.robot.change.network import find_profile

    profile = find_profile(networks, name)
    if profile is None:
        names = [each.ssid or each.name for each in networks.profiles if each.kind == "802-11-wireless"]
        near = did_you_mean(name, names)
        raise UserError(
            error(
                f"{name}: the robot knows no network of this name, expected one of: {', '.join(names) or 'none'}",
                rule="unknown-network",
                help=f"did you mean {near!r}?" if near else None,
            )
        )
    return profile


def _find_device(shell: SshShell, networks: Networks, name: str | None) -> Device:
    """The device that is meant: by its name, or the one that carries this connection. Raises UserError."""
    if name is None:
        words = shell.run('echo "$SSH_CONNECTION"').out.split()
        found = networks.device_with(words[2]) if len(words) > 2 else None
    else:
        found = next((each for each in networks.devices if each.name == name), None)
    if found is None:
        from ur.robot.change.network import check_managed

        check_managed(networks, shell.place, None)
        names = ", ".join(each.name for each in networks.devices if each.kind != "loopback")
        raise UserError(
            error(
                f"{shell.place}: {f'no network device {name!r}' if name else 'it is not clear which device is meant'}, "
                f"expected one of {names}",
                rule="bad-device",
                help="give --device",
            )
        )
    return found


def _show(networks: Networks, device: Device) -> None:
    """What the robot uses, and what it sees."""
    profile = networks.profile(device.profile)
    using = f"uses {profile.ssid or profile.name}" if profile else f"uses no network ({device.state})"
    say(f"{device.name} {using}{''.join(f', {address}' for address in device.addresses if ':' not in address)}")
    known = {each.ssid for each in networks.profiles if each.ssid}
    _print_table(
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
        say(f"known, and not in reach: {', '.join(away)}")


def _show_devices(networks: Networks) -> None:
    """All devices and what they use."""
    rows = []
    for each in networks.devices:
        profile = networks.profile(each.profile)
        if each.kind != "loopback":
            rows.append((each.name, each.kind, each.state, profile.name if profile else "", ", ".join(each.addresses)))
    _print_table(("device", "kind", "state", "network", "addresses"), rows)
    if not networks.running:
        say(f"NetworkManager does not run there, but: {', '.join(networks.others) or 'nobody known'}")


def _print_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table()
    for head in heads:
        table.add_column(head)
    for row in rows:
        table.add_row(*map(Text, row))  # names of networks are not ours: they may look like markup
    Console(soft_wrap=not sys.stdout.isatty()).print(table)
