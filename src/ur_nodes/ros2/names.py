"""Conversion of names of `ports` to those of ROS 2, and of a launch file's remaps and parameters."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from ur.source.arguments import parse_argument
from ur_nodes.ports.raw import upstream_name

if TYPE_CHECKING:
    from rclpy.node import Node as RosNode


def resolve(node: RosNode, name: str) -> str:
    """The full name of a topic or service of a node; both the name as on ROS 1 and the one of ROS 2 can be remapped."""
    full = str(node.resolve_topic_name(name_of(name)))
    known = upstream_name(full)
    return full if known == full else str(node.resolve_topic_name(known))


def name_of(name: str) -> str:
    """Convert a name of `ports.node` to ROS 2: '~goal' is '~/goal'."""
    return f"~/{name[1:].lstrip('/')}" if name.startswith("~") else name


def full_name(namespace: str, name: str) -> str:
    """The full name of a node."""
    return f"{namespace.rstrip('/')}/{name}"


def type_name_of(message_class: type) -> str:
    """The middleware's name of a type of messages, 'geometry_msgs/msg/Twist'."""
    package, *_ = message_class.__module__.split(".")
    return f"{package}/msg/{message_class.__name__}"


def arguments_of(arguments: Iterable[str]) -> list[str]:
    """The command line of a node (`__name:=N`, `__ns:=N`, `_parameter:=V`, `topic:=other`) in ROS 2's form.

    Arguments after `--ros-args` are in that form already. Arguments that are the program's own are left out.
    """
    given = list(arguments)
    own = given.index("--ros-args") if "--ros-args" in given else len(given)
    made: list[str] = []
    for each in given[:own]:
        argument = parse_argument(each)
        if argument is None:
            continue
        name, value = argument
        if name == "__name":
            made += ["-r", f"__node:={value}"]
        elif name == "__ns":
            made += ["-r", f"__ns:=/{value.strip('/')}"]
        elif name.startswith("__"):
            continue
        elif name.startswith("_"):
            made += ["-p", f"{name[1:].replace('/', '.')}:={value}"]
        else:
            made += ["-r", f"{name_of(name)}:={name_of(value)}"]
    return [*(["--ros-args", *made, "--"] if made else []), *given[own:]]
