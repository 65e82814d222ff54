"""The arguments of a node of ROS 2 that name it, its topics and its parameters. Pure."""

from __future__ import annotations

from ur.launchfile.plan.specs import NodeSpec


def arguments_of(node: NodeSpec, parameters: str) -> tuple[str, ...]:
    """The arguments after the node's own: name, namespace, remaps, and the file of its parameters."""
    words = ["--ros-args", "-r", f"__node:={node.name}"]
    if namespace := node.namespace.rstrip("/"):
        words += ["-r", f"__ns:={namespace}"]
    for source, target in node.remaps:
        words += ["-r", f"{_name_of(source)}:={_name_of(target)}"]
    return (*words, "--params-file", parameters)


def _name_of(name: str) -> str:
    """A name as ROS 2 writes it: '~goal' is '~/goal'."""
    return f"~/{name[1:].lstrip('/')}" if name.startswith("~") else name
