"""ROS of this computer: ROS 1 as packaged, the user's own ROS 2, the wheels of ROS 2, or none.

Without ROS, all nodes of a run are in one process.
"""

# Paths are texts here: this runs at each Tab, and pathlib is not worth its import.
# ruff: noqa: PTH110, PTH118, PTH208

import os
import sys
from collections.abc import Mapping
from typing import Literal, NamedTuple

from ur.source.diagnostic import user_error, user_error_about
from ur.source.user_folders import runtime_folder

WHEELS = ".ros2"
"""The environment of the wheels, in the state folder (`ur.source.project.state_folder`)."""

WHEELS_DISTRO = "kilted"
SUPPORTED_UNTIL = {"humble": "May 2027", "jazzy": "May 2029", "kilted": "December 2026", "lyrical": "May 2031"}
"""The end of the releases of ROS 2 on which nodes run, by REP 2000."""

QUIET_MASTER = ("--master-logger-level", "warn")  # it logs each parameter, as amcl keeps its pose every 2 s
MASTER_WORKERS = 32
"""The threads by which a master informs nodes of new publishers. Each waits up to two minutes for a node that the
network has lost; with rosmaster's 3, three nodes of a viewer delay all updates of the robot's own nodes."""

NONE = "none"
"""The choice of no ROS."""

READY = "ready"
"""The file that the set-up writes last into the environment of the wheels."""

_MASTERS = ("usr/bin/rosmaster", "opt/ros/noetic/bin/rosmaster")
_FIRST_DOMAIN, _DOMAINS = 60, 40  # of the simulated robots, by user: 0 to 101 are free of the ports of programs
_FIRST_PORT, _PORTS = 7400, 250  # of domain 0; of each
_SOCKETS = ("/proc/net/udp", "/proc/net/udp6")
_HOST = "localhost"
_SCHEME = "ros2://"
_NO_ROS = "process://localhost/none"
_WHEELS_MACHINES = ("x86_64",)


class Ros(NamedTuple):
    """The ROS of nodes: its release, its installation folder, and the Python of nodes.

    `prefix` is empty for ROS 1. `sourced`: the environment already has it. Version 0 means no ROS.
    """

    version: Literal[0, 1, 2]
    distro: str
    prefix: str
    python: str
    sourced: bool = False

    @property
    def wheels(self) -> bool:
        """Return whether it consists of the wheels that the set-up has installed."""
        return os.path.basename(self.prefix) == WHEELS  # noqa: PTH119 - as above

    def __str__(self) -> str:
        if self.version != 2:
            return "ROS 1" if self.version else "no ROS: all nodes of a run are in one process"
        return f"ROS 2 {self.distro.capitalize()}, {'as wheels ' if self.wheels else ''}in {self.prefix}"


def note_support(distro: str) -> str:
    """Return until when a release of ROS 2 is supported, to be added to its name; '' for any other."""
    return f", supported until {SUPPORTED_UNTIL[distro]}" if distro in SUPPORTED_UNTIL else ""


def find_ros(wanted: str, environment: Mapping[str, str], state: str, *, root: str = "/", machine: str = "") -> Ros:
    """Find the ROS of version `wanted` ("1", "2", "none"; "": ROS 1 if it is installed, else ROS 2, else none).

    `state` is the state folder, `root` the root of the file system, `machine` the processor. Raises UserError if it is
    not installed.
    """
    python = os.path.join(state, ".venv/bin/python")
    if wanted == NONE:
        return Ros(0, NONE, "", python)
    if wanted != "2":
        if any(os.path.exists(os.path.join(root, each)) for each in _MASTERS):
            return Ros(1, "noetic", "", python)
        if wanted == "1":
            raise user_error("ROS 1 is not installed on this computer", rule="no-ros", help="ur use sim --ros 1")
    if found := _find_users(environment, python, root):
        return found
    wheels = os.path.join(state, WHEELS)
    if os.path.exists(os.path.join(wheels, READY)):
        return Ros(2, WHEELS_DISTRO, wheels, os.path.join(wheels, "bin/python"))
    if not wanted and (machine or os.uname().machine) not in _WHEELS_MACHINES:
        return Ros(0, NONE, "", python)
    raise user_error("ROS 2 is not installed on this computer", rule="no-ros", help="ur use sim --ros 2")


def choose_domain(environment: Mapping[str, str], uid: int, tables: tuple[str, ...] = _SOCKETS) -> str:
    """Return the domain of a user's simulated robots, which no other robot uses, unless the user has chosen one.

    It depends on the user's id; if nodes of another user are in it, the next free one is used.
    """
    if chosen := environment.get("ROS_DOMAIN_ID"):
        return chosen
    users = users_of_domains(tables)
    for step in range(_DOMAINS):
        domain = _FIRST_DOMAIN + (uid + step) % _DOMAINS
        if users.get(domain, set()) <= {uid}:
            return str(domain)
    return str(_FIRST_DOMAIN + uid % _DOMAINS)


def users_of_domains(tables: tuple[str, ...] = _SOCKETS) -> dict[int, set[int]]:
    """Return by domain the users whose nodes are in it on this computer: the ports of a domain depend on its number."""
    found: dict[int, set[int]] = {}
    for table in tables:
        try:
            with open(table, encoding="ascii") as file:  # noqa: PTH123 - as above
                lines = file.readlines()[1:]
        except (OSError, ValueError):
            continue
        for words in map(str.split, lines):
            try:
                port, uid = int(words[1].rpartition(":")[2], 16), int(words[7])
            except (IndexError, ValueError):
                continue
            if port >= _FIRST_PORT:
                found.setdefault((port - _FIRST_PORT) // _PORTS, set()).add(uid)
    return found


def facts_file(environment: Mapping[str, str], domain: str) -> str:
    """Return the file with the facts of this user's runs in a domain of ROS 2."""
    return f"{runtime_folder(environment)}/ubiquity_launches/facts-{domain}.json"


def find_facts(environment: Mapping[str, str], domain: str) -> str:
    """Return the file with the facts of a run: that of the environment, or that of the user's runs in a domain."""
    return environment.get("UR_FACTS") or facts_file(environment, domain)


def parameters_file(facts: str) -> str:
    """Return the file with the parameters of all nodes of the runs whose facts are in a file."""
    return f"{facts.removesuffix('.json')}..parameters.json"  # no node has a name without letters


def viewer_socket(environment: Mapping[str, str]) -> str:
    """Return the socket for viewers of the process with all nodes, without ROS."""
    return os.path.join(os.path.dirname(find_facts(environment, NONE)), "nodes.sock")  # noqa: PTH120 - as above


def graph_address(environment: Mapping[str, str]) -> str:
    """Return the address of the middleware: ROS_MASTER_URI, on ROS 2 `ros2://localhost/DOMAIN`."""
    if environment.get("ROS_VERSION") == "0":
        return _NO_ROS
    if environment.get("ROS_VERSION") == "2":
        return f"{_SCHEME}{_HOST}/{environment.get('ROS_DOMAIN_ID') or '0'}"
    return environment.get("ROS_MASTER_URI") or "http://localhost:11311"


def read_domain(address: str) -> str | None:
    """Return the domain in an address of `graph_address`, "none" without ROS; None for a master of ROS 1."""
    if address == _NO_ROS:
        return NONE
    return address.rpartition("/")[2] if address.startswith(_SCHEME) else None


def node_command(environment: Mapping[str, str]) -> tuple[str, ...]:
    """Return the command that runs a module of `ur_nodes` as a node, in its environment."""
    if environment.get("ROS_VERSION") == "0":
        return (sys.executable, "-I", "-m", "ur_nodes.one_process.viewer_program")
    if environment.get("ROS_VERSION") != "2":
        return (sys.executable, "-I", "-m", "ur_nodes")
    from ur.source.project import launch_library  # pathlib, which Tab does without

    return (str(launch_library() / "lib/node"),)


def _find_users(environment: Mapping[str, str], python: str, root: str) -> Ros | None:
    """Return the user's own ROS 2: the one that the shell has sourced, else the newest in /opt/ros.

    Raises UserError.
    """
    distro = environment.get("ROS_DISTRO", "")
    prefixes = [each for each in environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if each]
    if environment.get("ROS_VERSION") == "2" and prefixes and os.path.basename(prefixes[-1]) != WHEELS:  # noqa: PTH119
        check_distro(distro, prefixes[-1])
        return Ros(2, distro, prefixes[-1], python, sourced=True)
    folder = os.path.join(root, "opt/ros")
    try:
        names = os.listdir(folder)
    except OSError:
        return None
    found = [each for each in names if os.path.exists(os.path.join(folder, each, "share/rclpy"))]
    if not found:
        return None
    newest = max(found, key=lambda name: (name != "rolling", name))
    check_distro(newest, os.path.join(folder, newest))
    return Ros(2, newest, os.path.join(folder, newest), python)


def check_distro(distro: str, where: str) -> None:
    """Raise UserError if no node of this project runs on a release of ROS 2; `where` is its folder or computer."""
    if distro not in SUPPORTED_UNTIL and distro < "jazzy":  # names of releases follow the alphabet
        raise user_error(
            f"{where}: ROS 2 {distro.capitalize()} is not supported, expected Humble, Jazzy, Kilted or Lyrical",
            rule="old-ros",
            help="install one of these releases",
            subject=distro,
        )


_LIMIT = 20.0  # s
_SCRIPT = 'unset AMENT_PREFIX_PATH; . "$1" >&2 && exec env -0'
_LEFT_OUT = ("_", "SHLVL", "PWD", "OLDPWD")


def source_ros(prefix: str, environment: Mapping[str, str]) -> dict[str, str]:
    """Run the set-up file of the ROS 2 in `prefix`; return the changes of `environment`. Raises UserError."""
    file = f"{prefix}/setup.bash"
    command = ["bash", "--norc", "-c", _SCRIPT, "bash", file]
    import subprocess  # most commands do not come here, and it takes as long as ten modules

    try:
        done = subprocess.run(command, env=environment, capture_output=True, timeout=_LIMIT, check=False)
    except (OSError, subprocess.TimeoutExpired) as problem:
        raise user_error_about(file, f"cannot be run: {problem}", rule="bad-ros") from None
    if done.returncode:
        reason = done.stderr.decode("utf-8", "replace").strip().splitlines()[-1:] or ["it fails"]
        raise user_error_about(file, f"cannot be run: {reason[0]}", rule="bad-ros")
    pairs = (each.partition("=") for each in done.stdout.decode("utf-8", "surrogateescape").split("\0") if each)
    return {name: value for name, _, value in pairs if name not in _LEFT_OUT and environment.get(name) != value}
