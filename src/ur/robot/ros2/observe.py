"""Inspection of ROS 2 on a computer: send the finder to it, and parse its answer, which is untrusted."""

import json
from collections.abc import Mapping
from importlib.resources import files

from ur.robot.ros2.seen_graph import Ros2
from ur.robot.ssh.shell import Shell, quote
from ur.source.foreign.json_values import BadJsonError, read_json

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
