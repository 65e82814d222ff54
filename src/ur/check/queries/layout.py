"""Directories and documentation comments of launch files, as the rules about conventions expect them."""

import re

from ur.check.rule import LaunchView
from ur.launchfile.syntax import Comment, Element

_PLACE = re.compile(r"((?:n|m|rviz)_\w+)/launch/([^/]+)\Z")
_HEADING = re.compile(r"\s*([A-Za-z_]\w*)\s*:(?!/)\s*(.*)\Z", re.DOTALL)
KNOWN_HEADINGS = frozenset({"summary", "overview", "ready", "terminal", "ur"})


def launch_directory(view: LaunchView) -> str | None:
    """Return the directory (`n_x`, `m_x`, `rviz_x`) of a launch file; None for files elsewhere."""
    place = _match(view)
    return place.group(1) if place else None


def file_name(view: LaunchView) -> str:
    """Return the last part of a launch file's path."""
    return view.path.rpartition("/")[2]


def _match(view: LaunchView) -> re.Match[str] | None:
    if view.package is None or not view.package.follows_conventions:
        return None
    return _PLACE.match(view.path.removeprefix(view.package.folder + "/"))


def heading_of(comment: Comment) -> tuple[str, str] | None:
    """Return name and text of a documentation comment `<!--name: text-->`; None for other comments."""
    match = _HEADING.match(comment.text)
    return (match.group(1), match.group(2).strip()) if match else None


def find_heading(view: LaunchView, name: str) -> str | None:
    """Return the text of `<!--Summary: ...-->` or `<!--Overview: ...-->`; None if there is none."""
    launch = view.tree.launch
    comments = [*view.tree.comments, *(launch.comments if launch else ())]
    for heading in map(heading_of, comments):
        if heading and heading[0] == name:
            return heading[1]
    return None


def comments_after(launch: Element, element: Element) -> list[Comment]:
    """Return the comments between an element directly inside `<launch>` and the next element."""
    found: list[Comment] = []
    index = launch.children.index(element)
    for child in launch.children[index + 1 :]:
        if not isinstance(child, Comment):
            break
        found.append(child)
    return found
