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
LIBRARIES = ("catkin_ws/src/ubiquity_launches", "ubiquity_launches")  # where this project may be on a robot
# Neither "network" nor "online" means that a robot on WiFi has its address: wait until its own full name leads to one.
_WAIT = 'until getent ahostsv4 "$(cat /proc/sys/kernel/hostname).local" >/dev/null; do sleep 1; done'
# RestartSteps= would do it from systemd 254 on; Debian 12 and Ubuntu 22.04 have older ones. What is started by hand or
# with a new master does not wait: NRestarts is 0 then.
_BACK_OFF = """\
cd "$RUNTIME_DIRECTORY" || exit 0
now() {{ cut -d. -f1 /proc/uptime; }}
again=$(systemctl show -P NRestarts {service}) began=$(cat began 2>/dev/null) pause=$(cat pause 2>/dev/null)
if [ "${{again:-0}}" -gt 0 ] && [ $(($(now) - ${{began:-0}})) -lt {calm} ]; then
  pause=$((2 * ${{pause:-0}})); [ $pause -gt 0 ] || pause={first}; [ $pause -lt {last} ] || pause={last}
  echo "it ended within {calm} s of its start: the next start is in $pause s"
else pause=0; fi
echo $pause >pause; sleep $pause; now >began"""
CALM_SECONDS = 60
FIRST_PAUSE, LAST_PAUSE = 2, 60
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
RuntimeDirectory={service}
RuntimeDirectoryPreserve=restart
ExecStartPre=/bin/sh -c {wait}
ExecStartPre=/bin/sh -c {back_off}
TimeoutStartSec=infinity
ExecStart={start}
{after_start}KillSignal=SIGINT
TimeoutStopSec=20
Restart=always
RestartSec=2

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
    return _unit(MASTER, command_line(["roscore"]), user, then=["/usr/bin/python3", "-c", tell_base_script()])


def tell_base_script(path: Path = ROBOT_FILE) -> str:
    """Python that sets `/ur/base_name` and `/ur/variant` of the master from a robot file, where there is one."""
    return _TELL.format(path=str(path))


def program_unit(name: str, line: str, user: str) -> Unit:
    """The unit of a command line of bash: started after the master, again when it ends, and with a new master."""
    return _unit(name, line, user, master=f"{PREFIX}{MASTER}.service")


def command_line(words: Sequence[str]) -> str:
    """The line that runs a command, in place of the shell."""
    return f"exec {quote(*words)}"


def launch_line(package: str, file: str, arguments: Sequence[str]) -> str:
    """The line that starts a launch file by `ur launch` where this project is set up on the robot, else by roslaunch.

    Either waits for the master instead of starting one of its own.
    """
    words = quote(package, file, *arguments)
    places = " ".join(f'"$HOME"/{place}' for place in LIBRARIES)
    # Not by its script `ur`, which may want to install something first: nobody is there to see that.
    ready = f'"$d/.venv/bin/python" -m ur launch --plain --wait {words}'
    return f'for d in {places}; do [ ! -r "$d/.venv/ready-run" ] || exec {ready}; done; exec roslaunch --wait {words}'


def is_unit_name(text: str) -> bool:
    """Whether a program may be called so."""
    return text != MASTER and re.fullmatch(r"[a-z0-9][a-z0-9_-]{0,50}", text) is not None


def _unit(name: str, line: str, user: str, *, master: str = "", then: Sequence[str] = ()) -> Unit:
    # A login shell, so that the environment is the one that the user has, too.
    start, after_start = (f"/bin/bash -lc {_quote(each)}" for each in (line, command_line(then)))
    service = f"{PREFIX}{name}"
    back_off = _BACK_OFF.format(service=service, calm=CALM_SECONDS, first=FIRST_PAUSE, last=LAST_PAUSE)
    text = _UNIT.format(
        description=f"ROS on this robot: {name}",
        service=service,
        after=f" {master}" if master else "",
        requires=f"Requires={master}\nPartOf={master}\n" if master else "",
        user=user,
        wait=_quote(_WAIT),
        back_off=_quote(back_off),
        start=start,
        after_start=f"ExecStartPost=-{after_start}\n" if then else "",
    )
    return Unit(service, text)


def _quote(word: str) -> str:
    """A word as systemd reads it (systemd.syntax(7), systemd.service(5)): escapes of C, and % and $ doubled."""
    for plain, escaped in (("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("%", "%%"), ("$", "$$")):
        word = word.replace(plain, escaped)
    return f'"{word}"'
