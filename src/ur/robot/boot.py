"""What a robot starts when it boots: a ROS master that is kept up, and programs, as systemd units. Pure."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from ur.robot.ssh.shell import quote

PREFIX = "ubiquity-"
MASTER = "master"
FOLDER = "/etc/systemd/system"
# Neither "network" nor "online" means that a robot on WiFi has its address: wait until its own full name leads to one.
_WAIT = 'until getent ahostsv4 "$(cat /proc/sys/kernel/hostname).local" >/dev/null; do sleep 1; done'
_UNIT = """\
# Written by ur boot install.
[Unit]
Description={description}
Wants=network-online.target
After=network-online.target avahi-daemon.service{after}
{requires}StartLimitIntervalSec=0

[Service]
User={user}
WorkingDirectory=~
ExecStartPre=/bin/sh -c {wait}
TimeoutStartSec=infinity
ExecStart={start}
KillSignal=SIGINT
TimeoutStopSec=20
Restart=always
RestartSec={pause}

[Install]
WantedBy=multi-user.target
"""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit file: `service` is its name without the ending."""

    service: str
    text: str

    @property
    def path(self) -> str:
        """Where it belongs."""
        return f"{FOLDER}/{self.service}.service"


def master_unit(user: str) -> Unit:
    """The unit that keeps a ROS master up."""
    return _unit(MASTER, ["roscore"], user, pause=2)


def program_unit(name: str, words: Sequence[str], user: str) -> Unit:
    """The unit of a program: started after the master, started again when it ends, and with a new master."""
    return _unit(name, words, user, pause=5, master=f"{PREFIX}{MASTER}.service")


def is_unit_name(text: str) -> bool:
    """Whether a program may be called so."""
    return text != MASTER and re.fullmatch(r"[a-z0-9][a-z0-9_-]{0,50}", text) is not None


def _unit(name: str, words: Sequence[str], user: str, *, pause: int, master: str = "") -> Unit:
    # A login shell, so that the environment is the one that the user has, too.
    start = f"/bin/bash -lc {_quote(f'exec {quote(*words)}')}"
    text = _UNIT.format(
        description=f"ROS on this robot: {name}",
        after=f" {master}" if master else "",
        requires=f"Requires={master}\nPartOf={master}\n" if master else "",
        user=user,
        wait=_quote(_WAIT),
        start=start,
        pause=pause,
    )
    return Unit(f"{PREFIX}{name}", text)


def _quote(word: str) -> str:
    """A word as systemd reads it (systemd.syntax(7), systemd.service(5)): escapes of C, and % and $ doubled."""
    for plain, escaped in (("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("%", "%%"), ("$", "$$")):
        word = word.replace(plain, escaped)
    return f'"{word}"'
