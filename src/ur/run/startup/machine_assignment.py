"""Assignment of a plan's nodes to computers. Pure: the identity of this computer is a parameter."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace

from ur.launchfile.plan.specs import MachineSpec, NodeSpec, Plan


@dataclass(frozen=True, slots=True)
class Away:
    """Another computer and the nodes of a plan that run on it."""

    machine: MachineSpec
    nodes: tuple[NodeSpec, ...]


def split_plan(plan: Plan, is_here: Callable[[str], bool]) -> tuple[Plan, tuple[Away, ...]]:
    """Return the plan with the nodes of this computer only, and those of each other computer, in the plan's order.

    `is_here` tests an address for this computer. Machines with the same address, port and user are one computer.
    Parameters stay in the plan, since there is only one master. A node whose machine is not defined stays too.
    """
    machines = {machine.name: machine for machine in plan.machines}
    known: dict[str, bool] = {}
    here: list[NodeSpec] = []
    away: dict[tuple[str, int, str | None], Away] = {}
    for node in plan.nodes:
        machine = machines.get(node.machine or "")
        if machine is None or known.setdefault(machine.address, is_here(machine.address)):
            here.append(node)
            continue
        key = (machine.address, machine.ssh_port, machine.user)
        before = away.get(key, Away(machine, ()))
        away[key] = replace(before, nodes=(*before.nodes, node))
    return replace(plan, nodes=tuple(here)), tuple(away.values())


def keep_nodes(plan: Plan, names: Collection[str]) -> Plan:
    """Return the plan with these nodes only (full names), for a computer whose nodes share a master with others.

    It neither sets private parameters of the other nodes nor clears a namespace that contains one of them.
    """
    nodes = tuple(node for node in plan.nodes if node.full_name in names)
    others = [node.full_name + "/" for node in plan.nodes if node.full_name not in names]
    return replace(
        plan,
        nodes=nodes,
        params=tuple(each for each in plan.params if not any(each.name.startswith(other) for other in others)),
        clear_params=tuple(
            space
            for space in plan.clear_params
            if not any(other.startswith(space.rstrip("/") + "/") for other in others)
        ),
    )
