"""Options of `ur launch` that change a plan: the nodes that start, and their prefixes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ur.launchfile.plan.specs import Plan
from ur.request.launch_request import LaunchRequest
from ur.request.options import LaunchOptions, Report
from ur.request.plan_files import Inspect, LoadedPlan, load_request
from ur.source.diagnostic import UserError, error


def load_chosen(request: LaunchRequest, report: Report, inspect: Inspect | None = None) -> LoadedPlan:
    """Load a request, and apply the options that choose nodes; errors in the files are printed.

    `inspect` is called with the errors before. Raises UserError, as `load_request` does, and for unknown nodes in
    options.
    """
    if request.options.core:
        return LoadedPlan(request, Plan((), (), (), (), (), ("core",)))
    loaded = load_request(request, inspect)
    if loaded.plan is None:
        return loaded
    return replace(loaded, plan=apply_options(loaded.plan, request.options, report))


def apply_options(plan: Plan, options: LaunchOptions, report: Report) -> Plan:
    """Return a plan with the nodes that options choose. Raises UserError for unknown nodes in options."""
    if options.local:
        from ur.run.paths import is_local_address
        from ur.run.startup.node_selection import split_plan

        plan, remote = split_plan(plan, is_local_address)
        for each in remote:
            names = ", ".join(node.full_name for node in each.nodes)
            report("warning", f"--local: {names} for {each.machine.name} ({each.machine.address}) left out")
    if options.only or options.except_ or options.prefix:
        plan = choose_nodes(plan, options.only, options.except_, options.prefix)
    if options.no_terminal:
        left_out = [node.full_name for node in plan.nodes if node.terminal]
        plan = replace(plan, nodes=tuple(node for node in plan.nodes if not node.terminal))
        if left_out:
            report("info", f"--no-terminal: {', '.join(left_out)} left out")
    for node in plan.nodes if options.required else ():
        if node.respawn:
            message = f"--required: {node.full_name} is to be respawned, expected a node that may end"
            raise UserError(error(message, node.origin.span, rule="required-respawn"))
    if options.verbose:
        report("info", "\n".join(_list_contents(plan)))
    if options.part is not None:
        from ur.run.startup.node_selection import keep_nodes

        mine = {node.full_name for node in plan.nodes if node.machine == options.part} - set(options.runs_already)
        plan = keep_nodes(plan, mine)
        plan = replace(plan, commands=tuple(each for each in plan.commands if each.command != "dump"))
    return plan


def choose_nodes(plan: Plan, only: Sequence[str], without: Sequence[str], prefixes: Sequence[str]) -> Plan:
    """Return a plan with `only` these nodes (empty: all), `without` others, some with a `NODE=PREFIX`.

    Raises UserError for a node that is not in the plan, and for a prefix without its node.
    """
    from ur.request.questions import find_node

    kept = {find_node(plan, name).full_name for name in only} or {node.full_name for node in plan.nodes}
    kept -= {find_node(plan, name).full_name for name in without}
    before = {}
    for text in prefixes:
        name, found, prefix = text.partition("=")
        if not found:
            raise UserError(error(f"--prefix {text!r}, expected NODE=PREFIX", rule="bad-prefix", subject=text))
        before[find_node(plan, name).full_name] = prefix
    nodes = (
        replace(node, launch_prefix=before.get(node.full_name, node.launch_prefix))
        for node in plan.nodes
        if node.full_name in kept
    )
    return replace(plan, nodes=tuple(nodes))


def _list_contents(plan: Plan) -> Iterator[str]:
    yield from (f"file {path}" for path in plan.files)
    yield from (f"parameter {each.name}: {each.command or each.value!r}" for each in plan.params)
    yield from (f"node {node.full_name} ({node.package}/{node.type})" for node in plan.nodes)
