"""Selection of a wireless network to join or forget, among those that a robot receives or has stored."""

from collections.abc import Callable
from typing import NoReturn

from ur.robot.commit_confirm.netplan import Netplan
from ur.robot.commit_confirm.network import (
    NetworkChanges,
    NetworkManager,
    WirelessNetwork,
    check_managed,
    check_password,
    choose_management,
    find_profile,
)
from ur.robot.commit_confirm.network_facts import NETWORK_MANAGER, NetworkDevice, Networks, Profile
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import user_error_about
from ur.source.suggest import did_you_mean


def choose_manager(networks: Networks, destination: str, device: NetworkDevice) -> NetworkChanges:
    """Return what changes the networks of a device. Raises UserError if it is managed by something else."""
    check_managed(networks, destination, device)
    return NetworkManager(networks) if device.owner == NETWORK_MANAGER else Netplan(networks)


def choose_network(
    networks: Networks, ssid: str, password: str, ask: Callable[[bool], str], *, hidden: bool, band: str
) -> WirelessNetwork:
    """Choose the settings of a network to join. Raises UserError if it is out of range or the password is invalid.

    `ask` is called for a missing password, with whether the robot already stores one; it returns "" for none.
    """
    seen = next((each for each in networks.seen if each.ssid == ssid), None)
    if seen is None and not hidden:
        near = did_you_mean(ssid, [each.ssid for each in networks.seen])
        reach = ", ".join(each.ssid for each in networks.seen[:8]) or "none"
        raise user_error_about(
            ssid,
            f"the robot sees no network of this name, expected one in reach: {reach}",
            rule="unknown-network",
            help=f"did you mean {near!r}?" if near else "a network that does not tell its name: --hidden",
        )
    known = find_profile(networks, ssid) is not None
    secured = seen.security not in ("", "OWE") if seen else True
    if not known:
        choose_management(seen, with_password=True)  # do not ask for a password that cannot be used
    if not password and secured:
        password = ask(known)
    if known and not password:  # the stored profile has the credentials, including a user name
        return WirelessNetwork(ssid, None, "", hidden, band)
    if not password and seen and secured:
        raise user_error_about(
            ssid,
            "it requires a password, and none was given",
            rule="missing-answer",
            help="run this in a terminal, or give --passwords-from FD",
        )
    management = choose_management(seen, with_password=bool(password))
    secret = Secret(password) if password and management in ("wpa-psk", "sae") else None
    if secret:
        check_password(ssid, secret)
    return WirelessNetwork(ssid, secret, management, hidden, band)


def refuse_wireless(destination: str, networks: Networks) -> NoReturn:
    """Raise UserError if the robot has no wireless device, or neither NetworkManager nor netplan manages it."""
    device = next((each for each in networks.devices if each.kind == "wifi"), None)
    check_managed(networks, destination, device)
    raise user_error_about(
        destination,
        "it has no wireless device, expected one",
        rule="no-wifi",
        help="is its adapter plugged in, and is its driver there? 'ur robot network' shows what it has",
    )


def find_known(networks: Networks, name: str) -> Profile:
    """Return the profile of a network. Raises UserError if the robot stores no such network."""
    profile = find_profile(networks, name)
    if profile is None:
        names = [each.ssid or each.name for each in networks.profiles if each.kind == "802-11-wireless"]
        near = did_you_mean(name, names)
        raise user_error_about(
            name,
            f"the robot has no network with this name, expected one of: {', '.join(names) or 'none'}",
            rule="unknown-network",
            help=f"did you mean {near!r}?" if near else None,
        )
    return profile
