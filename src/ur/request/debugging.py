"""`ur launch --debug NODE[=pudb|gdb|debugpy]`: a plan in which these nodes start under a debugger."""

import os
import shlex
from collections.abc import Sequence

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.world import World
from ur.request.plan_files import find_node
from ur.run.debugger.choice import TOOLS, Tool, choose_tool, plan_debugging
from ur.run.debugger.environment import find_debug_tools, find_free_port, read_target
from ur.run.process.command import find_executable
from ur.source.diagnostic import user_error
from ur.source.suggest import suggest


def debug_nodes(plan: Plan, requests: Sequence[str], world: World, *, terminal: bool) -> tuple[Plan, tuple[str, ...]]:
    """Return the plan with debuggers, and instructions for other terminals. `terminal`: a terminal is available.

    A debugger replaces the node's own launch-prefix, and is not restarted when it ends. Raises UserError for an unknown
    node or debugger, or a debugger that is unsuitable or not installed.
    """
    changed: dict[str, NodeSpec] = {}
    lines: list[str] = []
    port = 5678  # debugpy's usual one
    for request in requests:
        name, _, tool_name = request.partition("=")
        node = find_node(plan, name)
        path = find_executable(node, world)
        target = read_target(node.full_name, path)
        tools = find_debug_tools(
            world.environment,
            terminal=terminal and not any(each.terminal for each in (*plan.nodes, *changed.values())),
            python=target.interpreter if target.kind == "python" else "",
        )
        tool = _parse_tool(request, tool_name) if tool_name else choose_tool(target.kind)
        if tool == "debugpy":
            port = find_free_port(port)
        found = plan_debugging(target, tool, tools, port)
        here = found.terminal == "here"
        changed[node.full_name] = node._replace(
            launch_prefix=shlex.join(found.prefix),
            respawn=False,
            terminal=here,
            required=node.required or here,
            output="screen" if found.terminal == "log" else node.output,
        )
        lines += found.notes if found.terminal == "log" else found.notes[1:]  # a window is visible
        port += 1
    return plan._replace(nodes=tuple(changed.get(node.full_name, node) for node in plan.nodes)), tuple(lines)


def has_terminal() -> bool:
    """Return whether keyboard and screen are a terminal of this process group."""
    try:
        return os.isatty(0) and os.isatty(1) and os.tcgetpgrp(0) == os.getpgrp()
    except OSError:
        return False


def _parse_tool(request: str, name: str) -> Tool:
    for tool in TOOLS:
        if tool == name:
            return tool
    raise user_error(
        f"--debug {request}: no such debugger, expected one of {', '.join(TOOLS)}",
        rule="unknown-debugger",
        help=suggest(name, TOOLS),
        subject=request,
    )
