"""Values about ROS 2 on a computer, with limits on the size of a robot's answer. Values only."""

import json
import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Annotated

from msgspec import Meta

from ur.robot.ssh.shell import Shell, quote
from ur.source.foreign.json_values import BadJsonError, Count, read_json

Name = Annotated[str, Meta(max_length=400)]
Release = Annotated[str, Meta(pattern="^[a-z]{0,20}\\Z")]
Unit = Annotated[str, Meta(pattern=r"^[A-Za-z0-9@._:\\-]{0,200}\Z")]
Variables = Mapping[Annotated[str, Meta(pattern="^[A-Z][A-Z0-9_]{0,40}\\Z")], Name]

DEFAULT_MIDDLEWARE = "rmw_fastrtps_cpp"  # of every release from Humble to Lyrical
# Their graphs have no type hashes; nodes of newer releases raise exceptions when they discover one of these.
OLD_RELEASES = ("foxy", "galactic", "humble")
TWISTS = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
NAMES = {"humble": "Humble", "iron": "Iron", "jazzy": "Jazzy", "kilted": "Kilted", "lyrical": "Lyrical"}


@dataclass(frozen=True, slots=True)
class Installation:
    """A release: its name such as jazzy, its folder, and its installed middlewares."""

    distro: Name
    folder: Name
    middlewares: tuple[Name, ...] = ()


@dataclass(frozen=True, slots=True)
class Process:
    """A process of ROS 2: process id, user, command line, release, systemd unit ('': none), and its ROS 2 variables.

    `readable` is False if its variables could not be read, since it belongs to another user. `lost`: its shared memory
    was removed while it ran.
    """

    pid: Count
    user: Name
    argv: Name
    distro: Release = ""
    unit: Unit = ""
    variables: Variables = field(default_factory=dict)
    readable: bool = True
    lost: bool = False


@dataclass(frozen=True, slots=True)
class Qos:
    """The QoS policies of a publisher or subscriber that decide about a match. Times in s."""

    reliable: bool = True
    latched: bool = False
    deadline: float = math.inf
    lease: float = math.inf
    manual: bool = False


@dataclass(frozen=True, slots=True)
class End:
    """A publisher or subscriber: full name of the node, type, and hash of the type's definition ('': unknown)."""

    node: Name
    kind: Name
    hash: Name = ""
    qos: Qos = Qos()


@dataclass(frozen=True, slots=True)
class SeenTopic:
    """A topic and its publishers and subscribers."""

    name: Name
    publishers: tuple[End, ...] = ()
    subscribers: tuple[End, ...] = ()


@dataclass(frozen=True, slots=True)
class Received:
    """The number of messages received on a topic during the inspection, and the least age of their stamps (s)."""

    messages: Count
    age: float | None = None


@dataclass(frozen=True, slots=True)
class SeenFrame:
    """A frame of tf: the nodes that publish its transform, and its parent frames."""

    senders: tuple[Name, ...]
    parents: tuple[Name, ...]


@dataclass(frozen=True, slots=True)
class SeenGraph:
    """The graph as a node on the computer sees it.

    By node: `simulated` time, and lifecycle `states`. By topic: received scans, and the charge of batteries (0..1).
    """

    nodes: tuple[Name, ...] = ()
    topics: tuple[SeenTopic, ...] = ()
    simulated: Mapping[Name, bool] = field(default_factory=dict)
    states: Mapping[Name, Name] = field(default_factory=dict)
    scans: Mapping[Name, Received] = field(default_factory=dict)
    charge: Mapping[Name, float] = field(default_factory=dict)
    frames: Mapping[Name, SeenFrame] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Ros2:
    """ROS 2 on one computer.

    `shell`: variables of a new terminal; `called`: of the calling shell. `settings` are pairs (file, variable) of lines
    that set one. `files` are settings files that variables refer to, and whether they exist. `ports` are the numbers on
    which a program listens, UDP and TCP. `no_multicast` are network interfaces that are up without multicast.
    `forgotten` are users whose units lose their shared memory when their last login ends. `graph` is None if it could
    not be read; `problem` is the reason. `receives`: multicast packets of the other computer arrived; None if that was
    not tested.
    """

    installations: tuple[Installation, ...] = ()
    processes: tuple[Process, ...] = ()
    shell: Variables = field(default_factory=dict)
    called: Variables = field(default_factory=dict)
    settings: tuple[tuple[Name, Name], ...] = ()
    files: Mapping[Name, bool] = field(default_factory=dict)
    ports: frozenset[Count] = frozenset()
    no_multicast: tuple[Name, ...] = ()
    forgotten: tuple[Name, ...] = ()
    graph: SeenGraph | None = None
    problem: Name = ""
    receives: bool | None = None

    @property
    def present(self) -> bool:
        """Return whether ROS 2 is installed or runs on the computer."""
        return bool(self.installations or self.processes)

    @property
    def variables(self) -> Mapping[str, str]:
        """The environment variables that most processes have; those of a new terminal if none can be read."""
        known = [tuple(sorted(each.variables.items())) for each in self.processes if each.readable]
        return dict(Counter(known).most_common(1)[0][0]) if known else self.shell

    @property
    def distro(self) -> str:
        """The release that most processes use; else the newest installed one; '' if none is known."""
        running = [each.distro for each in self.processes if each.distro]
        if running:
            return Counter(running).most_common(1)[0][0]
        return max((each.distro for each in self.installations), default="")


def mixes(first: str, second: str) -> bool:
    """Return whether the nodes of two releases understand one another."""
    return first == second or (first in OLD_RELEASES) == (second in OLD_RELEASES)


def domain_of(variables: Mapping[str, str]) -> str:
    """Return the domain id as text; the default of ROS 2 is 0."""
    return variables.get("ROS_DOMAIN_ID", "").strip() or "0"


def middleware_of(variables: Mapping[str, str]) -> str:
    """Return the name of the middleware."""
    return variables.get("RMW_IMPLEMENTATION", "").strip() or DEFAULT_MIDDLEWARE


def range_of(variables: Mapping[str, str]) -> str:
    """Return the discovery range: SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT."""
    if variables.get("ROS_LOCALHOST_ONLY", "").strip() == "1":
        return "LOCALHOST"
    return variables.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").strip().upper() or "SUBNET"


def peers_of(variables: Mapping[str, str]) -> tuple[str, ...]:
    """Return the static peers, which are contacted without multicast."""
    return tuple(each.strip() for each in variables.get("ROS_STATIC_PEERS", "").split(";") if each.strip())


VARIABLES = (
    *("ROS_DOMAIN_ID", "RMW_IMPLEMENTATION", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS", "ROS_LOCALHOST_ONLY"),
    *("ROS_DISCOVERY_SERVER", "ROS_SUPER_CLIENT", "ROS_DISTRO", "CYCLONEDDS_URI"),
    *("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"),
)
FIND_SECONDS = 75.0
RECEIVE_SECONDS = 5
_LONGEST = 4 << 20  # characters of an answer
# The group and port of `ros2 multicast`. Each computer sends its name and listens for the other's.
_RECEIVE = r"""
import socket, struct, sys, time
group, port, own, other = "225.0.0.1", 49150, sys.argv[1].encode(), sys.argv[2].encode()
server = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
server.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
server.bind((group, port))
server.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, struct.pack("=4sl", socket.inet_aton(group), 0))
server.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
server.settimeout(0.2)
heard, end = False, time.monotonic() + float(sys.argv[3])
while time.monotonic() < end:
    try:
        server.sendto(b"ur doctor " + own, (group, port))
        heard = server.recv(200) == b"ur doctor " + other or heard
    except OSError:
        pass
print("heard" if heard else "silent")
"""


def inspect_ros2(
    shell: Shell,
    shell_files: tuple[str, ...],
    *,
    graph: bool = True,
    root: bool = False,
    environment: Mapping[str, str] | None = None,
) -> Ros2:
    """Inspect ROS 2 on a computer; empty for an invalid answer. Raises UserError if the connection breaks.

    With `graph`, the nodes are queried too, which takes some seconds. With `root`, processes of all users can be read.
    `environment` are variables for reading the graph; None: those of the processes that can be read.
    """
    program = files("ur.robot.ros2").joinpath("finder.py").read_text("utf-8")
    survey = files("ur_nodes.ros2").joinpath("survey.py").read_text("utf-8") if graph else ""
    wanted = {"variables": VARIABLES, "files": shell_files, "graph": survey, "environment": environment or {}}
    line = f"timeout {FIND_SECONDS:.0f} python3 -I -c {quote(program)}"
    done = shell.run(line, stdin=json.dumps(wanted), timeout=FIND_SECONDS + 30.0, root=root)
    return parse_ros2(done.out)


def receive_from(shell: Shell, own: str, other: str) -> bool | None:
    """Send multicast packets as `own`, and return whether those of `other` arrive; None if that could not be tested."""
    done = shell.run(f"python3 -I -c {quote(_RECEIVE)} {quote(own, other, str(RECEIVE_SECONDS))}", timeout=30.0)
    return {"heard": True, "silent": False}.get(done.out.strip())


def parse_ros2(output: str) -> Ros2:
    """Parse the finder's answer; empty if it is invalid."""
    try:
        return read_json(output, Ros2, _LONGEST)
    except BadJsonError:
        return Ros2()
