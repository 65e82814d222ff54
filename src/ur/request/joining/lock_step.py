"""Nodes of a program that run against a recording, in lock step: their plan for `ur_nodes.lock_step`."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

from ur.launchfile.plan.load import load_plan
from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.world.protocol import World
from ur.request.arguments import Argument, values_of
from ur.request.launch_request import make_request
from ur.request.plan_files import complete_arguments, localisation_argument, texts
from ur.robot.selection import Selection
from ur.run.middleware.one_process import describe_start
from ur.run.process.command import find_programs
from ur.source.diagnostic import Severity, UserError, error
from ur.source.suggest import did_you_mean

_BASE, _VARIANT = "robot_base", "robot_variant"


def plan_lock_step(
    recording: Path,
    program: str,
    arguments: Iterable[Argument],
    selection: Selection,
    world: World,
    names: Sequence[str],
) -> str:
    """Plan the nodes of a launch file that run against a recording, as JSON.

    `names` are nodes, with or without their namespaces. Raises UserError: an error in the launch file, or a node that
    it does not start.
    """
    request = make_request([program, *texts(arguments)], world, selection)
    given = complete_arguments(request, local=True)
    given = (*given, *localisation_argument(request, given))
    plan = load_plan(request.files.paths, texts(given), world, parsed=request.files.parsed)
    if errors := [each for each in plan.diagnostics if each.severity is Severity.ERROR]:
        raise UserError(*errors)
    nodes = [_find_node(plan, name) for name in names]
    programs, missing = find_programs(nodes, world)
    if missing:
        raise UserError(*missing)
    values = values_of(given)
    return json.dumps(
        {
            "recording": str(recording.absolute()),
            "nodes": [describe_start(each, node) for each, node in zip(programs, nodes, strict=True)],
            "parameters": {each.name: each.value for each in plan.params if each.command is None},
            "facts": {"base_name": values.get(_BASE, ""), "variant": values.get(_VARIANT, "")},
        },
        default=list,  # bytes
    )


def _find_node(plan: Plan, name: str) -> NodeSpec:
    for node in plan.nodes:
        if name in (node.name, node.full_name):
            return node
    known = [node.full_name for node in plan.nodes]
    raise UserError(
        error(
            f"the program starts no node '{name}', expected one of {', '.join(known)}",
            rule="unknown-node",
            help=f"did you mean '{near}'?" if (near := did_you_mean(name, known)) else None,
            subject=name,
        )
    )
