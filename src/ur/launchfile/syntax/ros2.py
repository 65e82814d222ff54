"""Launch files of ROS 2, which the launch language of ROS 1 cannot express: detected, and reported."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from ur.launchfile.syntax.tree import Element
from ur.source.diagnostic import Diagnostic, error
from ur.source.file import SourceFile, Span

ROS2_SUFFIXES = (".launch.py", ".launch.yaml", ".launch.yml", "_launch.py", "_launch.yaml", "_launch.yml")
_SUBSTITUTIONS = ("$(find-pkg-share", "$(find-pkg-prefix", "$(exec-in-pkg", "$(var ")
_HELP = "start it with ROS 2: ros2 launch PACKAGE FILE; for ROS 1 a file of the package's ROS 1 branch is needed"


def is_ros2_name(path: str) -> bool:
    """Return whether a file is a launch file for ROS 2 by its name."""
    return path.endswith(ROS2_SUFFIXES)


def count_unread(paths: Iterable[str]) -> dict[str, int]:
    """Count the launch files of ROS 2 that no command reads, by kind."""
    kinds = Counter("Python" if path.endswith(".py") else "YAML" for path in paths if is_ros2_name(path))
    return {f"{kind} launch file of ROS 2": number for kind, number in sorted(kinds.items())}


def describe_unread(unread: Mapping[str, int]) -> str:
    """Return `6 Python launch files of ROS 2 were not read`; empty if everything was."""
    kinds = " and ".join(
        f"{number} {kind if number == 1 else kind.replace(' file ', ' files ')}" for kind, number in unread.items()
    )
    return f"{kinds} {'was' if sum(unread.values()) == 1 else 'were'} not read" if kinds else ""


def explain_no_launch_file(unread: Mapping[str, int]) -> str:
    """Return the help of an error about a folder without launch files."""
    return "; ".join(filter(None, ("launch files end in .launch or .launch.xml", describe_unread(unread))))


def find_ros2(source: SourceFile, root: Element | None) -> Diagnostic | None:
    """Return the finding that a file is written for ROS 2, at the first evidence of it; None for any other file."""
    if is_ros2_name(source.path):
        return _explain("its name ends like one", Span(source, 0, 1))
    if (
        root is None
        or root.name != "launch"
        or not any(mark in source.text for mark in ("<let", "exec", *_SUBSTITUTIONS))
    ):
        return None
    waiting = [root]
    while waiting:
        element = waiting.pop()
        sign = _find_sign(element)
        if sign:
            return _explain(sign, element.span)
        waiting += reversed(tuple(element.elements))
    return None


def _find_sign(element: Element) -> str:
    attributes = element.attributes
    if element.name == "let" and "name" in attributes and "value" in attributes:
        return "it uses <let>"
    if element.name == "node" and "exec" in attributes and "type" not in attributes:
        return "its <node> has exec="
    if element.name == "executable" and "cmd" in attributes:
        return "it uses <executable>"
    for value in attributes.values():
        for mark in _SUBSTITUTIONS:
            if mark in value:
                return f"it uses {mark.strip()} ...)"
    return ""


def _explain(sign: str, span: Span) -> Diagnostic:
    message = f"this is a launch file for ROS 2 ({sign}), expected one for ROS 1"
    return error(message, span, rule="wrong-ros-version", help=_HELP)
