"""Wanted state of a robot: its own access point (`access_point_side`), with a password that is made on the robot."""

from dataclasses import dataclass
from pathlib import Path

from ur.robot.setup import access_point_side
from ur.robot.setup.change import Change, ChangeScript
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.packages import WantedPackages, WantedService
from ur.robot.setup.wanted import Wanted, WantedFile
from ur.robot.ssh.shell import REPLACE
from ur.source.diagnostic import user_error

UNIT = "robot-access-point.service"
PATH, PROGRAM = f"/etc/systemd/system/{UNIT}", "/usr/local/lib/ubiquity/access_point.py"
PASSWORD, OFF = str(access_point_side.PASSWORD), "off"
RADIO, NETPLAN = "/sys/class/ieee80211", "/etc/netplan"
MANAGER, NETWORKD = "NetworkManager.service", "systemd-networkd.service"
# In a change of networks: closes it, and the new process waits for the end of that change.
CLOSE = f"systemctl try-restart {UNIT} 2>/dev/null || :"
_RUN = f"/usr/bin/python3 -Iu {PROGRAM}"
_UNIT = (
    "[Unit]\nDescription=Access point by ur, where none of the robot's networks is in reach\nAfter=network.target\n\n"
    f"[Service]\nExecStart={_RUN}\nExecStopPost={_RUN} close\nRestart=always\nRestartSec=10\n\n"
    "[Install]\nWantedBy=multi-user.target\n"
)
# 60 bits, without characters that look alike.
_MAKE = "tr -dc abcdefghijkmnpqrstuvwxyz23456789 </dev/urandom | head -c 12 | sed 's/..../&-/g; s/-$//'"
_REMOVE = f"systemctl -q disable --now {UNIT} 2>/dev/null; rm -f {PATH} {PROGRAM}; systemctl daemon-reload"


@dataclass(frozen=True, slots=True)
class WantedAccessPoint:
    """The file of the password, or of the decision against the access point. The change never shows a password."""

    title: str
    on: bool

    def request(self, user: str) -> FactsRequest:
        """Request the file."""
        return FactsRequest(user, files=frozenset({PASSWORD}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Make a password unless there is one, which other computers may know; or remove everything."""
        text = (facts.file(PASSWORD).text or "").strip()
        if text and (text != OFF) == self.on:
            return None
        make = _MAKE if self.on else f"{_REMOVE}; echo {OFF}"
        script = f"{REPLACE}umask 077; {{ {make}; }} >{PASSWORD}.new && replace {PASSWORD}.new {PASSWORD}"
        note = "its password: ur robots --access-points" if self.on else ""
        shown = f"{PASSWORD}: {'a new password' if self.on else OFF}"
        return Change(self.title, shown, (ChangeScript(script, root=True),), note)

    def undo(self, facts: ComputerFacts) -> Change | None:
        """Remove everything."""
        if facts.file(PASSWORD).text is None:
            return None
        return Change(self.title, f"{PASSWORD}: removed", (ChangeScript(f"{_REMOVE}; rm -f {PASSWORD}", root=True),))


def access_point_request(user: str) -> FactsRequest:
    """Return the facts that `want_access_point` needs."""
    return FactsRequest(user, files=frozenset({PASSWORD, RADIO, NETPLAN}), services=frozenset({MANAGER, NETWORKD}))


def want_access_point(facts: ComputerFacts, chosen: bool | None) -> list[Wanted]:
    """Return the states for a robot with a wireless device that NetworkManager or netplan can manage.

    `chosen` None: as was decided before, else on. Raises UserError if it is chosen and not possible.
    """
    off = chosen is None and (facts.file(PASSWORD).text or "").strip() == OFF
    if chosen is False or off:
        return [WantedAccessPoint("no access point", on=False)]
    managed = facts.services[MANAGER].active == "active"
    planned = facts.file(NETPLAN).folder and facts.services[NETWORKD].active == "active"
    if not facts.file(RADIO).folder or not (managed or planned):
        if chosen:
            expected = "expected a wireless device, and NetworkManager, or netplan with systemd-networkd"
            raise user_error(f"{facts.hostname} cannot have an access point, {expected}", rule="no-wifi")
        return []
    return [
        WantedPackages("packages of the access point", ("dnsmasq-base",) if managed else ("hostapd",)),
        WantedAccessPoint("access point", on=True),
        WantedFile("program of the access point", PROGRAM, Path(access_point_side.__file__).read_text("utf-8")),
        WantedFile("access point at boot", PATH, _UNIT, then="systemctl daemon-reload"),
        WantedService("service of the access point", UNIT),
    ]
