"""Changing a plan from the command line, without editing files: which nodes, and what is put in front of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ur.launchfile.plan.model import Plan
from ur.request.questions import find_node
from ur.source.diagnostic import UserError, error


def choose_nodes(plan: Plan, only: Sequence[str], without: Sequence[str], prefixes: Sequence[str]) -> Plan:
    """A plan with `only` these nodes (none named: all), without others, some with a `NODE=PREFIX` in front.

    Raises UserError for a name that is not there, and for a prefix without its node.
    """
    kept = {find_node(plan, name).full_name for name in only} or {node.full_name for node in plan.nodes}
    kept -= {find_node(plan, name).full_name for name in without}
    before = {}
    for text in prefixes:
        name, found, prefix = text.partition("=")
        if not found:
            raise UserError(error(f"--prefix {text!r}, expected NODE=PREFIX", rule="bad-prefix"))
        before[find_node(plan, name).full_name] = prefix
    nodes = (
        replace(node, launch_prefix=before.get(node.full_name, node.launch_prefix))
        for node in plan.nodes
        if node.full_name in kept
    )
    return replace(plan, nodes=tuple(nodes))
