"""The node between a driver and the rest: what the driver leaves out, under the names that the base file gives."""

from __future__ import annotations

import sys

from ur.robot.base import Bumpers, load_base
from ur.source.diagnostic import UserError, error
from ur.source.project import launch_library
from ur_nodes.drivers.adapters import adapt_bumpers, adapt_odometry, adapt_scan
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.run import run


def start(node: Node) -> None:
    """Read the parameters and connect. Raises UserError."""
    own = node.parameters
    base = load_base(own.text("package", str(launch_library())), own.text("base"), own.text("variant", ""))
    adapt_odometry(node, base, publish_tf=own.boolean("publish_tf", False))
    if own.boolean("rename_scan", False) and base.lidar:
        adapt_scan(node, base.lidar)
    kind = own.text("bumper_messages", "")
    if kind and base.bumpers:
        _adapt_bumpers(node, base.bumpers, kind)


def _adapt_bumpers(node: Node, bumpers: Bumpers, kind: str) -> None:
    known = [bumper.name for bumper in bumpers.at]
    names = read_names(node.parameters, known)
    try:
        adapt_bumpers(node, bumpers.topic, names, known, kind)
    except LookupError:
        expected = "a type of message as package/Name of an installed package"
        node.parameters.fail("bumper_messages", kind, expected)
    except ValueError:
        text = f"messages {kind} have no name and value, expected those of bumpers"
        raise UserError(error(text, rule="bad-parameter")) from None


def read_names(own: Parameters, known: list[str]) -> dict[str, str]:
    """The parameter `bumper_names`: upstream's names and those of the base. Raises UserError."""
    names = own.any("bumper_names", {})
    if not isinstance(names, dict) or not all(isinstance(name, str) and name in known for name in names.values()):
        own.fail("bumper_names", names, f"a map from upstream's names to some of {', '.join(known)}")
    return dict(names)


if __name__ == "__main__":
    sys.exit(run("driver_adapter", start))
