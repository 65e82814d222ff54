"""`ur robot wifi`: a robot's wireless networks, changed without losing it."""

from __future__ import annotations

import getpass
import sys
from typing import TYPE_CHECKING

import click

from ur.cli.answers import read_lines
from ur.cli.guarded import DRY_RUN, WAIT, say
from ur.cli.robot_setup.network import change_network, print_table
from ur.source.diagnostic import UserError, error_about
from ur.source.suggest import did_you_mean

if TYPE_CHECKING:
    from ur.robot.commit_confirm.guarded import GuardedChange
    from ur.robot.commit_confirm.network import WirelessNetwork
    from ur.robot.commit_confirm.network_facts import NetworkDevice, Networks, Profile
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
    """Show a robot's wireless networks; join or forget one, without losing the robot.

    The robot joins the network and waits for this computer to reach it there: join the same network meanwhile. Where
    that does not happen, it goes back to the network that it had. What it knew before stays, for places where the new
    network is not in reach. Needs NetworkManager on the robot.
    """
    if ssid is not None and forget is not None:
        raise click.UsageError("--ssid and --forget cannot be used together")
    if (hidden or band) and ssid is None:
        raise click.UsageError("--hidden and --band require --ssid NAME")
    network_password, own_password = read_lines(passwords_from, "--passwords-from", 2)

    def plan(shell: SshShell, networks: Networks) -> GuardedChange | None:
        from ur.robot.commit_confirm.network import check_managed, plan_forget, plan_join

        device = networks.wireless
        if device is None:
            _refuse_wireless(shell.place, networks)
        check_managed(networks, shell.place, device)
        assert device is not None
        if ssid is not None:
            wanted = _choose(networks, ssid, network_password, hidden=hidden, band=band or "")
            say(f"while the robot waits, this computer has to be in {ssid}, or in a network that leads there")
            return plan_join(networks, wanted, device)
        if forget is not None:
            return plan_forget(networks, _find_known(networks, forget))
        _show(networks, device)
        return None

    return change_network(robot, own_password, plan, wait, dry_run=dry_run, scan=True)


def _choose(networks: Networks, ssid: str, password: str, *, hidden: bool, band: str) -> WirelessNetwork:
    """Build the WiFi settings to join; ask for a missing password. Raises UserError: out of reach, bad password."""
    from ur.robot.commit_confirm.network import WirelessNetwork, check_password, choose_management, find_profile
    from ur.robot.ssh.secret import Secret

    seen = next((each for each in networks.seen if each.ssid == ssid), None)
    if seen is None and not hidden:
        near = did_you_mean(ssid, [each.ssid for each in networks.seen])
        reach = ", ".join(each.ssid for each in networks.seen[:8]) or "none"
        raise UserError(
            error_about(
                ssid,
                f"the robot sees no network of this name, expected one in reach: {reach}",
                rule="unknown-network",
                help=f"did you mean {near!r}?" if near else "a network that does not tell its name: --hidden",
            )
        )
    known = find_profile(networks, ssid) is not None
    secured = seen.security not in ("", "OWE") if seen else True
    if not known:
        choose_management(seen, with_password=True)  # no question about a value that cannot be used
    if not password and secured and sys.stdin.isatty():
        password = getpass.getpass(f"password of {ssid}{' (empty: the one that the robot knows)' if known else ''}: ")
    if known and not password:  # its profile knows how, also with a user name
        return WirelessNetwork(ssid, None, "", hidden, band)
    if not password and seen and secured:
        raise UserError(
            error_about(
                ssid,
                "it wants a password, and none is given",
                rule="missing-answer",
                help="run this in a terminal, or give --passwords-from FD",
            )
        )
    management = choose_management(seen, with_password=bool(password))
    secret = Secret(password) if password and management in ("wpa-psk", "sae") else None
    if secret:
        check_password(ssid, secret)
    return WirelessNetwork(ssid, secret, management, hidden, band)


def _refuse_wireless(place: str, networks: Networks) -> None:
    """Raises UserError: there is no wireless device, or it is not ours to change."""
    from ur.robot.commit_confirm.network import check_managed

    device = next((each for each in networks.devices if each.kind == "wifi"), None)
    check_managed(networks, place, device)
    raise UserError(
        error_about(
            place,
            "it has no wireless device, expected one",
            rule="no-wifi",
            help="is its adapter plugged in, and is its driver there? 'ur robot network' shows what it has",
        )
    )


def _find_known(networks: Networks, name: str) -> Profile:
    """The profile of a network. Raises UserError: the robot knows no such network."""
    from ur.robot.commit_confirm.network import find_profile

    profile = find_profile(networks, name)
    if profile is None:
        names = [each.ssid or each.name for each in networks.profiles if each.kind == "802-11-wireless"]
        near = did_you_mean(name, names)
        raise UserError(
            error_about(
                name,
                f"the robot knows no network of this name, expected one of: {', '.join(names) or 'none'}",
                rule="unknown-network",
                help=f"did you mean {near!r}?" if near else None,
            )
        )
    return profile


def _show(networks: Networks, device: NetworkDevice) -> None:
    """Print the network that the robot uses, and those that it sees."""
    profile = networks.profile(device.profile)
    using = f"uses {profile.ssid or profile.name}" if profile else f"uses no network ({device.state})"
    say(f"{device.name} {using}{''.join(f', {address}' for address in device.addresses if ':' not in address)}")
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
        say(f"known, and not in reach: {', '.join(away)}")
