"""Boot services of a robot as systemd units: a ROS master, programs, and their state. Pure."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.robot.base.own_drivers import GUARD_SOCKET
from ur.robot.robot_file import ROBOT_FILE, Ros2Robot
from ur.robot.ssh.shell import quote
from ur.source.diagnostic import user_error
from ur.source.foreign.numbers import parse_integer
from ur.source.project import STATE_FOLDER
from ur.system.ros import MASTER_WORKERS, QUIET_MASTER

PREFIX = "ubiquity-"
GUARD = "motor-guard"
MASTER = "master"
MASTER_OPTIONS = ("-w", str(MASTER_WORKERS), *QUIET_MASTER)
FOLDER = "/etc/systemd/system"
# The folders of this project on a robot: a clone, the copy that `ur robot setup` makes, or one from a wheel.
LIBRARIES = ("catkin_ws/src/ubiquity_launches", "ubiquity_launches", STATE_FOLDER)
# Neither "network" nor "online" ensures that a robot on WiFi has its address: wait until its own full name resolves.
_WAIT = 'until getent ahostsv4 "$(cat /proc/sys/kernel/hostname).local" >/dev/null; do sleep 1; done'
# RestartSteps= needs systemd 254; Debian 12 and Ubuntu 22.04 have older ones. A manual start, or one with a new master,
# does not wait: NRestarts is 0 then.
_BACK_OFF = """\
cd "$RUNTIME_DIRECTORY" || exit 0
now() {{ cut -d. -f1 /proc/uptime; }}
again=$(systemctl show -P NRestarts {service}) began=$(cat began 2>/dev/null) pause=$(cat pause 2>/dev/null)
if [ "${{again:-0}}" -gt 0 ] && [ $(($(now) - ${{began:-0}})) -lt {calm} ]; then
  pause=$((2 * ${{pause:-0}})); [ $pause -gt 0 ] || pause={first}; [ $pause -lt {last} ] || pause={last}
  echo "it ended within {calm} s of its start: the next start is in $pause s"
else pause=0; fi
echo $pause >pause; sleep $pause; now >began"""
_MISSING = "echo 'this project is not set up on the robot: ur robot setup' >&2; exit 1"
CALM_SECONDS = 60
FIRST_PAUSE, LAST_PAUSE = 2, 60
# Rights that a program of a robot never needs. It keeps devices, /sys (GPIO), real-time scheduling, its user's
# processes and
# /tmp; ProtectClock= and PrivateDevices= would revoke access to its serial ports.
_LIMITS = """\
NoNewPrivileges=yes
ProtectSystem=strict
ReadWritePaths={home} -/home -/root -/run -/tmp -/var/tmp -/var/log -/var/crash -/media -/mnt -/srv
ProtectKernelModules=yes
ProtectKernelLogs=yes
RestrictSUIDSGID=yes
RestrictNamespaces=yes
LockPersonality=yes
RestrictAddressFamilies=AF_UNIX AF_INET AF_INET6 AF_NETLINK AF_CAN AF_BLUETOOTH
SystemCallArchitectures=native
SystemCallFilter=~@clock @cpu-emulation @module @mount @obsolete @raw-io @reboot @swap
SystemCallErrorNumber=EPERM
"""
_CAPABILITIES = {
    "": "CapabilityBoundingSet=\n",
    "root": "CapabilityBoundingSet=CAP_CHOWN CAP_DAC_OVERRIDE CAP_FOWNER CAP_IPC_LOCK CAP_KILL CAP_NET_ADMIN "
    "CAP_NET_RAW CAP_SYS_NICE CAP_SYS_RAWIO\n",
}
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
{limits}
[Install]
WantedBy=multi-user.target
"""

# The guard of a board's motors, which has to outlive the unit of the driver that it guards: a unit for each connection.
# It opens nothing, the driver sends it the open device. What takes a namespace more could keep it from its start.
_GUARD_SOCKET = """\
# Written by ur boot install.
[Unit]
Description=Guards of the motors of this robot

[Socket]
ListenSequentialPacket={path}
SocketUser={user}
SocketMode=0600
Accept=yes

[Install]
WantedBy=sockets.target
"""
_GUARD = """\
# Written by ur boot install.
[Unit]
Description=Stop the motors of this robot when their driver has ended
CollectMode=inactive-or-failed

[Service]
User={user}
ExecStart={start}
StandardInput=socket
StandardOutput=journal
OOMScoreAdjust=-1000
{limits}CapabilityBoundingSet=
PrivateDevices=yes
PrivateTmp=yes
ProtectControlGroups=yes
ProtectKernelTunables=yes
MemoryDenyWriteExecute=yes
RestrictRealtime=yes
IPAddressDeny=any
UMask=0077
"""

# Python of ROS: PyYAML is installed with rospkg. A master that was just started needs a moment until it answers.
_SET_BASE = """\
import os, socket, sys, time, xmlrpc.client, yaml
socket.setdefaulttimeout(5.0)
try:
    with open({path!r}) as file:
        robot = yaml.load(file, yaml.BaseLoader)  # texts only, and nothing that grows
    facts = {{"/ur/base_name": robot["base"], "/ur/variant": robot.get("variant", "")}}
    if not all(isinstance(each, str) for each in facts.values()):
        raise TypeError("base and variant have to be words")
except FileNotFoundError:
    sys.exit()
except (OSError, ValueError, yaml.YAMLError, LookupError, TypeError, AttributeError, RecursionError) as problem:
    sys.exit({path!r} + ": " + str(problem))
master = xmlrpc.client.ServerProxy(os.environ.get("ROS_MASTER_URI", "http://localhost:11311"))
end = time.monotonic() + {seconds}
while True:
    try:
        for name, value in facts.items():
            code, _, before = master.getParam("/ur", name)
            if code != 1 or before != value:
                master.setParam("/ur", name, value)
                print("changed", name)
        break
    except OSError as problem:
        if time.monotonic() > end:
            sys.exit("no ROS master to tell the base to: " + str(problem))
        time.sleep(0.2)
"""


@dataclass(frozen=True, slots=True)
class UnitFile:
    """A unit file: `service` is its name without the suffix."""

    service: str
    text: str

    @property
    def path(self) -> str:
        """The path of the unit."""
        return f"{FOLDER}/{self.service}.service"


def master_unit(user: str, home: str) -> UnitFile:
    """Return the unit that keeps a ROS master running as a user, and sets the robot's base on it."""
    then = ["/usr/bin/python3", "-I", "-c", set_base_script()]
    return _unit(MASTER, command_line(["roscore", *MASTER_OPTIONS]), user, home, then=then)


def set_base_script(path: Path = ROBOT_FILE, *, seconds: float = 60.0) -> str:
    """Return Python code that sets `/ur/base_name` and `/ur/variant` on the master from a robot file, if one exists.

    The code waits up to `seconds` for the master, and prints `changed NAME` for each parameter whose value it changed.
    """
    return _SET_BASE.format(path=str(path), seconds=seconds)


def program_unit(name: str, line: str, user: str, home: str, *, master: bool = True) -> UnitFile:
    """Return the unit of a bash command line, which starts after the master and restarts when either of them ends.

    On ROS 2 there is no master.
    """
    return _unit(name, line, user, home, master=f"{PREFIX}{MASTER}.service" if master else "")


def guard_units(user: str, home: str) -> dict[str, str]:
    """Return the texts of the units that start guards of motors for a user's drivers, by path; the socket is first."""
    start = f"/bin/sh -c {_quote(own_line('-m ur_nodes.drivers.lines.guard_program'))}"
    limits = _LIMITS.format(home=_quote(f"-{home}"))
    return {
        # A change of the service restarts the socket, which must be there then
        f"{FOLDER}/{GUARD}.socket": _GUARD_SOCKET.format(path=GUARD_SOCKET, user=user),
        f"{FOLDER}/{GUARD}@.service": _GUARD.format(user=user, start=start, limits=limits),
    }


def command_line(argv: Sequence[str]) -> str:
    """Return the shell line that replaces the shell by a command."""
    return f"exec {quote(*argv)}"


def source_line(ros2: Ros2Robot, robot: str) -> str:
    """Return the shell line that sets up ROS 2, the packages, and the node settings of the robot with this name."""
    settings = " ".join(f"{name}={quote(value)}" for name, value in ros2.variables(robot).items())
    packages = 'ROS_PACKAGE_PATH="$HOME/catkin_ws/src${ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}"'
    return f". /opt/ros/{ros2.distro}/setup.bash >/dev/null; export {packages} {settings}"


def own_line(words: str, last: str = _MISSING) -> str:
    """Return the shell line that runs Python with `words` if this project is set up on the robot, else `last`."""
    places = " ".join(f'"$HOME"/{place}' for place in LIBRARIES)
    # Not by the script `ur`, which may ask to install something first: a unit has no terminal.
    ready = f'"$d/.venv/bin/python" -I {words}'
    return f'for d in {places}; do [ ! -r "$d/.venv/ready-run" ] || exec {ready}; done; {last}'


def launch_line(package: str, file: str, arguments: Sequence[str], *, roslaunch: bool = True) -> str:
    """Return the shell line that starts a launch file: by `ur launch` if this project is set up there, else roslaunch.

    Both wait for the master instead of starting one. On ROS 2 there is no `roslaunch`.
    """
    target = quote(package, file, *arguments)
    last = f"exec roslaunch --wait {target}" if roslaunch else _MISSING
    return own_line(f"-m ur launch --plain --wait {target}", last)


def page_line(*options: str) -> str:
    """Return the shell line that starts `ur web` with these options if this project is set up on the robot."""
    return own_line(f"-m ur web {quote(*options)}")


def is_unit_name(text: str) -> bool:
    """Return whether a text is a valid name of a program's unit."""
    return text != MASTER and re.fullmatch(r"[a-z0-9][a-z0-9_-]{0,50}", text) is not None


def _unit(name: str, line: str, user: str, home: str, *, master: str = "", then: Sequence[str] = ()) -> UnitFile:
    # A login shell, so that the environment is that of the user.
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
        limits=(_LIMITS.format(home=_quote(f"-{home}")) + _CAPABILITIES["root" if user == "root" else ""]),
        start=start,
        after_start=f"ExecStartPost=-{after_start}\n" if then else "",
    )
    return UnitFile(service, text)


def _quote(word: str) -> str:
    """Quote an argument for systemd (systemd.syntax(7), systemd.service(5)): C escapes, with % and $ doubled."""
    for plain, escaped in (("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("%", "%%"), ("$", "$$")):
        word = word.replace(plain, escaped)
    return f'"{word}"'


LAST_LINES = 3
_PROPERTIES = (
    "Id,Description,ActiveState,SubState,UnitFileState,NRestarts,ActiveEnterTimestamp,ExecMainStatus,ControlPID"
)
_MARK = "\x1e"
SCRIPT = f"""\
for f in {FOLDER}/{PREFIX}*.service; do
  [ -e "$f" ] || continue
  u=${{f##*/}}; printf '\\036'; systemctl show -p {_PROPERTIES} "$u"
  pause=$(cat "/run/${{u%.service}}/pause" 2>/dev/null); echo "Pause=$pause"
  # For a running service, the output since its start; for others, also that from before they ended.
  only=; systemctl -q is-active "$u" && only=_SYSTEMD_INVOCATION_ID=$(systemctl show -P InvocationID "$u")
  journalctl -q -u "$u" $only -n {LAST_LINES} -o cat --no-pager 2>/dev/null | sed 's/^/Said=/'
done
printf '\\036end\\n'
"""


@dataclass(frozen=True, slots=True)
class ServiceStatus:
    """A boot service: the values of its systemd properties, and the last lines of its log.

    `code` is the last exit code, `pause` the time until the next start (s), 0 if no start is scheduled.
    """

    name: str
    active: str
    sub: str
    enabled: bool
    restarts: int
    since: str
    code: int
    pause: int
    reported: tuple[str, ...]


def parse_status(text: str) -> list[ServiceStatus]:
    """Parse the output of SCRIPT; empty where no boot service is installed. Raises UserError for incomplete output."""
    *parts, last = text.split(_MARK)
    if last.strip() != "end" or not parts:
        raise user_error(
            f"the answer of the robot cannot be read, it ends with {text.strip()[-80:]!r}; expected boot services",
            rule="no-answer",
            help="check it with 'ur doctor', then run this again",
        )
    return [_parse(part) for part in parts[1:]]


def _parse(part: str) -> ServiceStatus:
    rows = [line.partition("=") for line in part.splitlines()]
    values = {key: value for key, _, value in rows}
    return ServiceStatus(
        name=values.get("Id", "").removeprefix(PREFIX).removesuffix(".service"),
        active=values.get("ActiveState", ""),
        sub=values.get("SubState", ""),
        enabled=values.get("UnitFileState") == "enabled",
        restarts=_number(values.get("NRestarts")),
        since=values.get("ActiveEnterTimestamp", ""),
        code=_number(values.get("ExecMainStatus")),
        pause=_number(values.get("Pause")),
        reported=tuple(value for key, _, value in rows if key == "Said"),
    )


def _number(text: str | None) -> int:
    return max(parse_integer(text or "") or 0, 0)


def describe_status(status: ServiceStatus) -> Iterator[str]:
    """Yield lines that describe a boot service: its state, and the last lines of its log."""
    yield f"{status.name}: {_describe_state(status)}"
    yield from (f"  | {line}" for line in status.reported)


def _describe_state(status: ServiceStatus) -> str:
    again = f", started again {status.restarts} times by itself" if status.restarts else ""
    if status.active == "active":
        text = f"runs since {status.since}{again}"
    elif status.active == "activating" and status.sub == "start-pre":
        pauses = status.restarts and status.pause
        text = f"pauses for {status.pause} s before its next start" if pauses else "waits for the robot's own address"
        text += again
    elif status.active == "activating":
        text = f"ended with code {status.code}; it is started again{again}"
    else:
        text = f"does not run ({status.active or 'unknown'})"
    return text if status.enabled else f"{text}; not enabled, so it will not start when the robot boots"
