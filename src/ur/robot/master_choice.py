"""The robot that a manually set ROS_MASTER_URI refers to, when another robot is selected."""

import ipaddress
import socket
from collections.abc import Callable
from urllib.parse import urlsplit

from ur.robot.addresses import is_address
from ur.robot.selection import DEFAULT_BASE, SIMULATION, Selection, parse_selection
from ur.source.diagnostic import UserError, user_error
from ur.source.printable import printable


def follow_master(
    selection: Selection, uri: str, hostname: str, find_address: Callable[[str], str] | None = None
) -> Selection:
    """Return the selection of the robot whose master `uri` names, in place of the selected real robot.

    A master on this computer is that of a simulated robot, unless this computer is the selected robot itself; any other
    host is a robot of that name. A simulated selection stays unchanged: its nodes run on this computer with any master.
    Raises UserError for an address that is not the selected robot's.
    """
    if selection.simulated or uri.rstrip("/") == selection.master_uri:
        return selection
    host = _read_host(uri)
    own = hostname.split(".")[0].lower()
    name = host.removesuffix(".local")
    if (host == "localhost" or (is_address(host) and ipaddress.ip_address(host).is_loopback)) or name == own:
        if own == selection.robot.lower():
            return selection
        return Selection(
            SIMULATION, selection.base or DEFAULT_BASE, selection.variant if selection.base else "", selection.ros
        )
    if name == selection.robot.lower():
        return selection
    if is_address(host):
        if (find_address or _find_address)(f"{selection.robot}.local") == host:
            return selection
        raise _unknown(selection, uri)
    try:
        return parse_selection(name)
    except UserError:
        raise _unknown(selection, uri) from None


def _unknown(selection: Selection, uri: str) -> UserError:
    message = (
        f"ROS_MASTER_URI={printable(uri)} was set by hand and is not the master of {selection.robot}, "
        f"expected {selection.master_uri} or the name of a robot"
    )
    return user_error(message, rule="bad-master", help="unset ROS_MASTER_URI, and select with 'ur use ROBOT'")


def _read_host(uri: str) -> str:
    try:
        return (urlsplit(uri).hostname or "").lower()
    except ValueError:
        return ""


def _find_address(host: str) -> str:
    try:
        return str(socket.getaddrinfo(host, None, socket.AF_INET, socket.SOCK_STREAM)[0][4][0])
    except OSError:
        return ""
