"""What a robot starts when it boots: a ROS master that is kept up, and programs, as systemd units. Pure."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.robot.robot_file import ROBOT_FILE
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
{after_start}KillSignal=SIGINT
TimeoutStopSec=20
Restart=always
RestartSec={pause}

[Install]
WantedBy=multi-user.target
"""

# Python as ROS has it: PyYAML comes with rospkg. The master needs a moment until it answers.
_TELL = """\
import os, sys, time, xmlrpc.client, yaml
try:
    with open({path!r}) as file:
        robot = yaml.safe_load(file)
    facts = {{"/ur/base_name": str(robot["base"]), "/ur/variant": str(robot.get("variant") or "")}}
except FileNotFoundError:
    sys.exit()
except (OSError, yaml.YAMLError, KeyError, TypeError, AttributeError) as problem:
    sys.exit({path!r} + ": " + str(problem))
master = xmlrpc.client.ServerProxy(os.environ.get("ROS_MASTER_URI", "http://localhost:11311"))
end = time.monotonic() + 60.0
while True:
    try:
        for name, value in facts.items():
            master.setParam("/ur", name, value)
        break
    except OSError as problem:
        if time.monotonic() > end:
            sys.exit("no ROS master to tell the base to: " + str(problem))
        time.sleep(0.2)
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
    """The unit that keeps a ROS master up, and tells it what base the robot is."""
    return _unit(MASTER, ["roscore"], user, pause=2, then=["/usr/bin/python3", "-c", tell_base_script()])


def tell_base_script(path: Path = ROBOT_FILE) -> str:
    """Python that sets `/ur/base_name` and `/ur/variant` of the master from a robot file, where there is one."""
    return _TELL.format(path=str(path))


def program_unit(name: str, words: Sequence[str], user: str) -> Unit:
    """The unit of a program: started after the master, started again when it ends, and with a new master."""
    return _unit(name, words, user, pause=5, master=f"{PREFIX}{MASTER}.service")


def is_unit_name(text: str) -> bool:
    """Whether a program may be called so."""
    return text != MASTER and re.fullmatch(r"[a-z0-9][a-z0-9_-]{0,50}", text) is not None


def _unit(
    name: str, words: Sequence[str], user: str, *, pause: int, master: str = "", then: Sequence[str] = ()
) -> Unit:
    # A login shell, so that the environment is the one that the user has, too.
    start, after_start = (f"/bin/bash -lc {_quote(f'exec {quote(*each)}')}" for each in (words, then))
    text = _UNIT.format(
        description=f"ROS on this robot: {name}",
        after=f" {master}" if master else "",
        requires=f"Requires={master}\nPartOf={master}\n" if master else "",
        user=user,
        wait=_quote(_WAIT),
        start=start,
        after_start=f"ExecStartPost=-{after_start}\n" if then else "",
        pause=pause,
    )
    return Unit(f"{PREFIX}{name}", text)


def _quote(word: str) -> str:
    """A word as systemd reads it (systemd.syntax(7), systemd.service(5)): escapes of C, and % and $ doubled."""
    for plain, escaped in (("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("%", "%%"), ("$", "$$")):
        word = word.replace(plain, escaped)
    return f'"{word}"'
