"""ROS names, joined and validated as rosgraph does. Source of the rules: `rosgraph.names` as Debian ships it."""

import re
from collections.abc import Mapping, Sequence

from ur.source.arguments import parse_argument

_LEGAL = re.compile(r"[~/A-Za-z][\w/]*\Z")
_ASSIGNMENT = re.compile(r"[~/A-Za-z_][\w/]*:=.*\Z")


def is_private(name: str) -> bool:
    """Return whether a name starts with `~`."""
    return name[:1] == "~"


def make_namespace(name: str) -> str:
    """Return a name as a namespace: from the root, with a slash at the end. Raises ValueError for `~names`."""
    if is_private(name):
        raise ValueError(f"'{name}' is a private name, expected one that can be a namespace")
    if not name.startswith("/"):
        name = "/" + name
    return name if name.endswith("/") else name + "/"


def join_names(namespace: str, name: str) -> str:
    """Return a name in a namespace; global and private names stay unchanged."""
    if name[:1] in ("~", "/") and name:
        return name
    if namespace == "~":
        return "~" + name
    if not namespace:
        return name
    return namespace + name if namespace.endswith("/") else f"{namespace}/{name}"


def canonical_name(name: str) -> str:
    """Return a name without doubled and trailing slashes."""
    if not name or name == "/" or ("//" not in name and name[-1] != "/"):
        return name
    return ("/" if name[0] == "/" else "") + "/".join(part for part in name.split("/") if part)


def is_legal_name(name: str) -> bool:
    """Return whether a name is valid in a ROS graph; the empty name is."""
    return not name or (_LEGAL.match(name) is not None and "//" not in name)


def parents_of(name: str) -> list[str]:
    """Return the namespaces above a name, the root first."""
    parents = ["/"]
    if name[:1] != "/" or "//" in name:
        name = "/" + "/".join(part for part in name.split("/") if part)
    end = name.find("/", 1)
    while end != -1 and end < len(name) - 1:
        parents.append(name[:end])
        end = name.find("/", end + 1)
    return parents


def read_assignments(arguments: Sequence[str]) -> tuple[dict[str, str], list[str]]:
    """Return `NAME:=VALUE` arguments as roslaunch reads them, and those that it silently ignores.

    Ignored: illegal names, empty values, a second `:=`, and `_name:=value`, which belongs to nodes.
    """
    values: dict[str, str] = {}
    ignored: list[str] = []
    for argument in arguments:
        given = parse_argument(argument)
        if given is None:
            continue
        name, value = given.name.strip(), given.value.strip()
        if not _ASSIGNMENT.match(argument) or not name or not value or parse_argument(value) is not None:
            ignored.append(argument)
        elif not (len(name) > 1 and name[0] == "_" and name[1] != "_"):
            values[name] = value
    return values, ignored


def initial_namespace(arguments: Sequence[str], environment: Mapping[str, str]) -> str:
    """Return the initial namespace: `__ns:=...`, else ROS_NAMESPACE, else the root. Raises ValueError."""
    for argument in arguments:
        if argument.startswith("__ns:="):
            return make_namespace(argument[len("__ns:=") :])
    return make_namespace(environment.get("ROS_NAMESPACE", "/"))
