"""Inspection of ROS 2 on a computer: sends the finder there, and reads its answer, which may be anything."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Any, TypeVar

from ur.robot.ros2.seen_graph import End, Installation, Process, Qos, Received, Ros2, SeenFrame, SeenGraph, SeenTopic
from ur.robot.ssh.shell import Shell, quote

VARIABLES = (
    *("ROS_DOMAIN_ID", "RMW_IMPLEMENTATION", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS", "ROS_LOCALHOST_ONLY"),
    *("ROS_DISCOVERY_SERVER", "ROS_SUPER_CLIENT", "ROS_DISTRO", "CYCLONEDDS_URI"),
    *("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE"),
)
FIND_SECONDS = 75.0
HEAR_SECONDS = 5
MOST = 2000  # entries of a list, which no small robot has
LONGEST = 400  # characters of a name
_BAD_ANSWER = (LookupError, TypeError, ValueError, AttributeError)
# The group and port of `ros2 multicast`. Each computer sends its name and listens for the other's.
_HEAR = r"""
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
Value = TypeVar("Value")


def inspect_ros2(
    shell: Shell,
    shell_files: tuple[str, ...],
    *,
    graph: bool = True,
    root: bool = False,
    environment: Mapping[str, str] | None = None,
) -> Ros2:
    """Inspect a computer. Nothing where its answer makes no sense. Raises UserError when the connection is lost.

    With `graph`, nodes are asked, too, which takes some seconds. With `root`, processes of all users can be read.
    `environment` are variables for reading the graph; None: those of the processes that can be read.
    """
    program = files("ur.robot.ros2").joinpath("finder.py").read_text("utf-8")
    survey = files("ur_nodes.ros2").joinpath("survey.py").read_text("utf-8") if graph else ""
    wanted = {"variables": VARIABLES, "files": shell_files, "graph": survey, "environment": environment or {}}
    line = f"timeout {FIND_SECONDS:.0f} python3 -I -c {quote(program)}"
    done = shell.run(line, stdin=json.dumps(wanted), timeout=FIND_SECONDS + 30.0, root=root)
    return parse_ros2(done.out)


def hear_other(shell: Shell, own: str, other: str) -> bool | None:
    """Send multicast packets as `own`, and return whether those of `other` arrive; None: it could not be tried."""
    done = shell.run(f"python3 -I -c {quote(_HEAR)} {quote(own, other, str(HEAR_SECONDS))}", timeout=30.0)
    return {"heard": True, "silent": False}.get(done.out.strip())


def parse_ros2(output: str) -> Ros2:
    """Read the finder's answer; nothing where it makes no sense."""
    try:
        top = json.loads(output)
        return _read(top) if top else Ros2()
    except (*_BAD_ANSWER, RecursionError):
        return Ros2()


def _read(top: Any) -> Ros2:
    return Ros2(
        installations=_each(top["installations"], lambda row: Installation(
            _text(row["distro"]), _text(row["folder"]), _texts(row["middlewares"])
        )),
        processes=_each(top["processes"], _process),
        shell=_variables(top["shell"]),
        called=_variables(top["called"]),
        settings=_each(top["settings"], lambda row: (_text(row[0]), _text(row[1]))),
        files=_mapping(top["files"], _truth),
        ports=frozenset(_each(top["ports"], _whole)),
        no_multicast=_texts(top["no_multicast"]),
        graph=_graph(top["graph"]) if top["graph"] is not None else None,
        problem=_text(top["problem"]),
    )  # fmt: skip


def _process(row: Any) -> Process:
    unit = _text(row["unit"])
    return Process(
        _whole(row["pid"]),
        _text(row["user"]),
        _text(row["argv"]),
        distro if re.fullmatch(r"[a-z]{1,20}", distro := _text(row["distro"])) else "",
        unit if re.fullmatch(r"[A-Za-z0-9@._:\\-]{1,200}", unit) else "",
        _variables(row["variables"]),
        _truth(row["readable"]),
    )


def _graph(top: Any) -> SeenGraph:
    def ends(rows: Any) -> tuple[End, ...]:
        return _each(rows, lambda row: End(
            _text(row[0]), _text(row[1]), _text(row[2]),
            Qos(_truth(row[3]), _truth(row[4]), _period(row[5]), _period(row[6]), _truth(row[7])),
        ))  # fmt: skip

    return SeenGraph(
        nodes=_texts(top["nodes"]),
        topics=_each(top["topics"], lambda row: SeenTopic(_text(row[0]), ends(row[1]), ends(row[2]))),
        simulated=_mapping(top["simulated"], _truth),
        states=_mapping(top["states"], _text),
        scans=_mapping(top["scans"], lambda row: Received(_whole(row[0]), None if row[1] is None else _number(row[1]))),
        charge=_mapping(top["charge"], _number),
        frames=_mapping(top["frames"], lambda row: SeenFrame(_texts(row[0]), _texts(row[1]))),
    )


def _each(rows: Any, read: Callable[[Any], Value]) -> tuple[Value, ...]:
    if not isinstance(rows, list):
        raise TypeError(rows)
    return tuple(map(read, rows[:MOST]))


def _mapping(rows: Any, read: Callable[[Any], Value]) -> dict[str, Value]:
    return {_text(name): read(value) for name, value in list(rows.items())[:MOST]}


def _variables(rows: Any) -> Mapping[str, str]:
    return {name: value for name, value in _mapping(rows, _text).items() if name in VARIABLES}


def _texts(rows: Any) -> tuple[str, ...]:
    return _each(rows, _text)


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise TypeError(value)
    return value[:LONGEST]


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise TypeError(value)
    return value


def _whole(value: Any) -> int:
    if not isinstance(value, int) or not 0 <= value < 1 << 53:
        raise TypeError(value)
    return value


def _number(value: Any) -> float:
    if not isinstance(value, (int, float)) or not math.isfinite(value):
        raise TypeError(value)
    return float(value)


def _period(value: Any) -> float:
    return math.inf if value is None else _number(value)
