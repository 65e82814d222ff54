"""The arguments of a node of ROS 2 that set its name, its topics and its parameters. Pure."""

from __future__ import annotations

from ur.launchfile.plan.specs import NodeSpec


def arguments_of(node: NodeSpec, parameters: str) -> tuple[str, ...]:
    """Return the arguments after the node's own: name, namespace, remaps, and the file of its parameters."""
    words = ["--ros-args", "-r", f"__node:={node.name}"]
    if namespace := node.namespace.rstrip("/"):
        words += ["-r", f"__ns:={namespace}"]
    for source, target in node.remaps:
        words += ["-r", f"{_name_of(source)}:={_name_of(target)}"]
    return (*words, "--params-file", parameters)


def _name_of(name: str) -> str:
    """Convert a name to ROS 2: '~goal' becomes '~/goal'."""
    return f"~/{name[1:].lstrip('/')}" if name.startswith("~") else name
