"""Names of nodes that also run elsewhere: ROS ends a node whose name is registered again."""

import re
import socket
from collections.abc import Callable, Collection, Iterable, Mapping

from ur.launchfile.plan.specs import LOCAL_ADDRESSES, NodeSpec, Plan
from ur.run.master.client import Master, parse_master_uri
from ur.run.remote.signs import Sign, look_up_nodes, probe_node
from ur.source.diagnostic import UserError
from ur.system.ros import read_domain

_TRIES = 9


def find_taken(
    names: Collection[str], master: Master, is_local: Callable[[str], bool], probe: Callable[[str], Sign] = probe_node
) -> frozenset[str]:
    """Return the nodes, of these, that run on another computer. Empty if the master does not answer."""
    try:
        addresses = look_up_nodes(names, master)
    except LookupError:
        return frozenset()
    local: dict[str, bool] = {}

    def is_elsewhere(uri: str) -> bool:
        try:
            host = parse_master_uri(uri).host
        except UserError:
            return False
        if host not in local:
            local[host] = is_local(host)
        return not local[host] and probe(uri) is Sign.PRESENT

    return frozenset(name for name, uri in addresses.items() if is_elsewhere(uri))


def choose_names(
    names: Collection[str], computer: str, find: Callable[[Collection[str]], Collection[str]]
) -> dict[str, str]:
    """Return a free name for each node whose name is taken: with the computer's name appended, and a number if needed.

    `find` returns the names, of those given, that are taken.
    """
    suffix = re.sub(r"[^0-9A-Za-z_]", "_", computer.partition(".")[0]) or "here"
    left = find(names)
    chosen: dict[str, str] = {}
    for number in range(1, _TRIES):
        wanted = {name: f"{name}_{suffix}" + (f"_{number}" if number > 1 else "") for name in sorted(left)}
        taken = find(tuple(wanted.values()))
        chosen |= {name: new for name, new in wanted.items() if new not in taken}
        left = [name for name, new in wanted.items() if new in taken]
        if not left:
            break
    return chosen


def rename_nodes(plan: Plan, names: Mapping[str, str]) -> Plan:
    """Return the plan with other full names for some nodes, including their private parameters and private names."""
    if not names:
        return plan

    def move(name: str) -> str:
        for old, new in names.items():
            if name.startswith(old + "/"):
                return new + name[len(old) :]
        return name

    return plan._replace(
        nodes=tuple(_rename(node, names, move) for node in plan.nodes),
        params=tuple(each._replace(name=move(each.name)) for each in plan.params),
        clear_params=tuple(move(space.rstrip("/") + "/") for space in plan.clear_params),
        commands=tuple(each._replace(name=move(each.name)) for each in plan.commands),
        programs=tuple(each._replace(name=move(each.name)) for each in plan.programs),
    )


def describe_names(names: Mapping[str, str]) -> Iterable[str]:
    """Yield one line for each renamed node."""
    for old, new in names.items():
        yield f"{old} runs on another computer already, so this one is called {new}"


def is_same_master(one: str, other: str) -> bool:
    """Return whether two addresses denote the same master, according to their text."""
    if read_domain(one) is not None or read_domain(other) is not None:
        return one == other
    try:
        first, second = parse_master_uri(one), parse_master_uri(other)
    except UserError:
        return False
    return first.port == second.port and (
        first.host == second.host or {first.host, second.host} <= LOCAL_ADDRESSES | {socket.gethostname()}
    )


def _rename(node: NodeSpec, names: Mapping[str, str], move: Callable[[str], str]) -> NodeSpec:
    full = names.get(node.full_name, node.full_name)
    return node._replace(
        name=full[len(node.namespace) :],
        remaps=tuple((move(source), move(target)) for source, target in node.remaps),
        ready=tuple(each._replace(name=move(each.name)) for each in node.ready),
    )
