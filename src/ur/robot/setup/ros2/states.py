"""Wanted states of a robot that already has ROS 2: only what this project needs."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from ur.robot.robot_file import COMMANDS, ROBOT_FILE, Ros2Robot, parse_robot_file
from ur.robot.ros2.seen_graph import (
    DEFAULT_MIDDLEWARE,
    TWISTS,
    End,
    Ros2,
    SeenGraph,
    SeenTopic,
    domain_of,
    inspect_ros2,
    middleware_of,
)
from ur.robot.setup.access_point import want_access_point
from ur.robot.setup.facts import ComputerFacts
from ur.robot.setup.keys import allowed_key
from ur.robot.setup.packages import WantedPackages, WantedService
from ur.robot.setup.robot_states import ViewerFacts, WantedPassword, WantedRobot, announcement, robot_file
from ur.robot.setup.ros2.take_over import MUX_NODE, list_topics
from ur.robot.setup.wanted import Wanted, WantedFile, WantedFolder, WantedLine
from ur.robot.ssh.shell import Shell, quote
from ur.system.ros import check_distro

# ROS 2 itself, its domain, middleware, discovery and units stay unchanged.
PACKAGES = (
    *("openssh-server", "avahi-daemon", "libnss-mdns", "xauth", "x11-apps", "rsync", "python3", "python3-venv"),
)
LINGER = "/var/lib/systemd/linger"


def find_ros2(destination: str, found: Ros2, present: Ros2Robot | None = None) -> Ros2Robot | None:
    """Determine a robot's ROS 2 settings from an inspection; None if it has no ROS 2.

    If the base subscribes to the command topic in the `present` robot file, that topic stays. Raises UserError if its
    release is not supported.
    """
    if not found.present:
        return None
    distro = found.distro
    check_distro(distro or "rolling", destination)
    middleware = middleware_of(found.variables)
    commands = find_commands(found.graph) if found.graph else ""
    namespace = commands.removesuffix(COMMANDS) if commands.endswith(COMMANDS) else ""
    if present and (found.graph is None or list_topics(found.graph, present.commands)):
        commands, namespace = present.commands, present.namespace
    return Ros2Robot(
        distro,
        domain_of(found.variables),
        "" if middleware == DEFAULT_MIDDLEWARE else middleware,
        namespace,
        commands or COMMANDS,
    )


def find_commands(graph: SeenGraph) -> str:
    """Find the velocity topic of the base; '' if there is none.

    The base is the end of the chain: a topic named cmd_vel comes before others, a subscriber that is not a mux before a
    mux.
    """

    def rank(topic: SeenTopic) -> tuple[bool, bool, int, str]:
        nodes = [end.node.rpartition("/")[2] for end in _takers(topic)]
        last = topic.name.rpartition("/")[2]
        return all(each == MUX_NODE for each in nodes), last != COMMANDS[1:], topic.name.count("/"), topic.name

    topics = [each for each in graph.topics if _takers(each)]
    return min(topics, key=rank).name if topics else ""


def _takers(topic: SeenTopic) -> list[End]:
    return [end for end in topic.subscribers if end.kind in TWISTS]


def wanted_on_ros2(
    facts: ComputerFacts,
    robot: WantedRobot,
    viewer: ViewerFacts,
    password: WantedPassword | None,
    *,
    library: Sequence[Wanted] = (),
) -> list[Wanted]:
    """List the states in the order of their application. The name is changed only if another one is wanted."""
    present = facts.file(str(ROBOT_FILE)).text
    items: list[Wanted] = [
        WantedFolder("ssh folder", "~/.ssh", mode=0o700),
        allowed_key("login from the viewer", viewer.public_key),
        WantedFile("robot file", str(ROBOT_FILE), robot_file(robot, present)),
        WantedPackages("packages", PACKAGES),
        # Else the end of the user's last login removes the shared memory of the user's units, and DDS sends nothing.
        WantedFile("shared memory outlives logins", f"{LINGER}/{facts.user}", ""),
        WantedService("names ending in .local", "avahi-daemon.service"),
        WantedFile("announcement", "/etc/avahi/services/ubiquity.service", announcement(robot, facts.user)),
    ]
    if password:
        items.append(password)
    items += [*want_access_point(facts, robot.access_point), *library]
    if facts.hostname != robot.name:
        items += [
            WantedLine("host name (hosts)", "/etc/hosts", f"127.0.1.1\t{robot.name}", old=("127.0.1.1",)),
            WantedFile("host name", "/etc/hostname", f"{robot.name}\n"),
        ]
    return items


_ROS1 = "command -v roslaunch rosmaster || ls /opt/ros/noetic/bin/roslaunch"


def find_robot_ros2(shell: Shell) -> tuple[Ros2Robot, dict[str, str]] | None:
    """Find the ROS 2 of a robot, and the velocity topics of its base by their types.

    None without ROS 2, or if ROS 1 is installed as well. Raises UserError if the connection breaks, the release is
    not supported, or its robot file is invalid.
    """
    found = inspect_robot(shell)
    if not found.present or shell.run(f"{{ {_ROS1}; }} >/dev/null 2>&1").code == 0:
        return None
    present = parse_robot_file(shell.run(f"cat {ROBOT_FILE} 2>/dev/null").out, f"{shell.destination}:{ROBOT_FILE}")
    ros2 = find_ros2(shell.destination, found, present.ros2 if present else None)
    assert ros2
    return ros2, list_topics(found.graph, ros2.commands) if found.graph else {}


def inspect_robot(shell: Shell) -> Ros2:
    """Inspect a robot, and its nodes.

    Processes are read as root, since they may belong to any user; nodes are queried as the user who logs in, whose
    shared memory they can open. Raises UserError if the connection breaks.
    """
    found = inspect_ros2(shell, (), graph=False, root=True)
    if not found.processes:
        return found
    environment = {name: value for name, value in found.variables.items() if name != "ROS_DISTRO"}
    return replace(found, graph=inspect_ros2(shell, (), environment=environment).graph)


def restart_silent_units(shell: Shell, report: Callable[[str], None]) -> int:
    """Restart units whose shared memory was removed by a logout, so that new nodes reach theirs; return the count."""
    found = inspect_ros2(shell, (), graph=False, root=True)
    units = sorted({each.unit for each in found.processes if each.lost and each.unit})
    for unit in units:
        report(f"restart of {unit}, whose shared memory a logout has removed")
        shell.run(quote("systemctl", "restart", unit), root=True)
    return len(units)
