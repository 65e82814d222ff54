"""A new name for a robot, in every file that contains the name. Pure."""

import base64
import hmac
import re
from dataclasses import dataclass

from ur.robot.commit_confirm.guarded import GuardedChange
from ur.robot.robot_file import ROBOT_FILE
from ur.robot.setup.change import Change, show_difference
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.keys import HOST_KEY, KNOWN_HOSTS
from ur.robot.setup.robot_states import CLOUD
from ur.robot.setup.wanted import Wanted, WantedFile, WantedLine, write_file
from ur.robot.ssh.shell import quote

ANNOUNCEMENT = "/etc/avahi/services/ubiquity.service"
# NetworkManager sets the name that it gets from systemd-hostnamed, which reads /etc/hostname at its start. Boot
# services
# wait for their name by themselves.
_FOLLOW = (
    "hostname {name} || exit; systemctl try-restart systemd-hostnamed; "
    "systemctl try-restart avahi-daemon || exit; systemctl --no-block try-restart 'ubiquity-*.service'; :"
)


@dataclass(frozen=True, slots=True)
class WantedKnownName:
    """A computer's public host key in ~/.ssh/known_hosts, under its new name and no longer under its old one."""

    title: str
    old: str
    new: str
    host_key: str

    def request(self, user: str) -> FactsRequest:
        """Request the known_hosts file."""
        return FactsRequest(user, files=frozenset({KNOWN_HOSTS}))

    def plan(self, facts: ComputerFacts) -> Change | None:
        """Add the new entry and remove the old one; entries of other computers stay."""
        state = facts.file(KNOWN_HOSTS)
        text = rename_known_host(state.text or "", self.old, self.new, self.host_key)
        if text == state.text:
            return None
        mode = state.mode if state.text is not None else 0o600
        difference = show_difference(KNOWN_HOSTS, state.text, text)
        return Change(self.title, difference, (write_file(facts, KNOWN_HOSTS, text, mode),))

    def undo(self, facts: ComputerFacts) -> Change | None:  # noqa: ARG002 - of the protocol
        """Return None: the entry stays."""
        return None


def rename_known_host(text: str, old: str, new: str, host_key: str) -> str:
    """Return a known_hosts file (sshd(8)) with one computer's entry under another name, also if names are hashed."""
    kind, key = host_key.split()[:2]
    wanted = f"{new}.local,{new} {kind} {key}"
    removed = {old, f"{old}.local", new, f"{new}.local"}
    lines = text.split("\n")
    if wanted in lines:  # the line stays in its position: a second run changes nothing
        removed -= {new, f"{new}.local"}
    kept = [left for line in lines if (left := _without_names(line, removed)) is not None]
    if wanted not in kept:
        while kept and not kept[-1]:
            kept.pop()
        kept += [wanted, ""]
    return "\n".join(kept)


def _without_names(line: str, removed: set[str]) -> str | None:
    """Return the line without these names; None if no other name is left on it."""
    names, blank, rest = line.partition(" ")
    if not blank or names.startswith(("#", "@")):
        return line
    kept = [name for name in names.split(",") if not any(_means(name, each) for each in removed)]
    return f"{','.join(kept)} {rest}" if kept else None


def _means(entry: str, name: str) -> bool:
    if not entry.startswith("|1|"):
        return entry == name
    try:
        salt, digest = (base64.b64decode(part) for part in entry.split("|")[2:4])
    except ValueError:
        return False
    return hmac.digest(salt, name.encode(), "sha1") == digest


def rename_request(user: str) -> FactsRequest:
    """Return the facts that `plan_rename` needs."""
    return FactsRequest(user, files=frozenset({str(ROBOT_FILE), ANNOUNCEMENT, HOST_KEY, CLOUD}))


def plan_rename(facts: ComputerFacts, new: str) -> GuardedChange:
    """Plan a robot's new name in everything that is set up; what is not set up stays as it is."""
    old = facts.hostname
    items: list[Wanted] = []
    robot, announcement, key = (facts.file(path) for path in (str(ROBOT_FILE), ANNOUNCEMENT, HOST_KEY))
    if robot.text is not None:
        items.append(WantedFile("robot file", str(ROBOT_FILE), name_robot_file(robot.text, new), robot.mode))
    if announcement.text is not None:
        text = re.sub(r"(<txt-record>name=)[^<]*", rf"\g<1>{new}", announcement.text)
        items.append(WantedFile("announcement", ANNOUNCEMENT, text, announcement.mode))
    if key.text:
        items.append(WantedKnownName("its own host key", old, new, key.text))
    if facts.file(CLOUD).text is not None:
        items.append(WantedFile("cloud-init", "/etc/cloud/cloud.cfg.d/99-ubiquity.cfg", "preserve_hostname: true\n"))
    items += [
        WantedLine("host name (hosts)", "/etc/hosts", f"127.0.1.1\t{new}", old=("127.0.1.1",)),
        WantedFile("host name", "/etc/hostname", f"{new}\n"),
    ]
    return GuardedChange(
        f"rename {old} to {new}",
        tuple(items),
        live=_FOLLOW.format(name=quote(new)),
        back=_FOLLOW.format(name=quote(old)),
        early=f"hostname {quote(old)}",
        words=("the name counts at once: avahi and the boot services are started anew",),
    )


def name_robot_file(text: str, new: str) -> str:
    """Return the text of robot.yaml with another name; the user's own lines stay."""
    return re.sub(r"^name:.*$", f'name: "{new}"', text, count=1, flags=re.MULTILINE)
