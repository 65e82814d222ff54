"""One process for all nodes of a run, if no ROS is installed."""

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.query.topics import resolve_name
from ur.run.master.parameters import CommandParameters
from ur.run.middleware.facts import write_facts
from ur.run.middleware.parameter_files import find_descriptions
from ur.run.middleware.ros2 import DomainMiddleware, find_domain, list_others
from ur.run.options import RunOptions
from ur.run.process.command import UnitProgram, read_module
from ur.run.supervisor.events import Event, ParametersSet, SetupFailed
from ur.source.diagnostic import UserError, user_error
from ur.system.ros import viewer_socket

ALL_NODES = "/nodes"
"""The name of the process, where no node has the terminal."""

_MODULE = "ur_nodes.one_process.host"
_SIMULATED_TIME = "/use_sim_time"


@dataclass(frozen=True, slots=True)
class ProcessMiddleware(DomainMiddleware):
    """See `Middleware`."""

    def describe(self) -> str:
        return "no ROS: all nodes are in one process, out of reach of other programs, other runs, RViz and robots"

    def arrange(
        self, programs: tuple[UnitProgram, ...], nodes: Sequence[NodeSpec], folder: str
    ) -> tuple[UnitProgram, ...]:
        """See Middleware. Raises UserError for a node that needs a separate process."""
        if not programs:
            return ()
        pairs = list(zip(programs, nodes, strict=True))
        starts = [describe_start(program, node) for program, node in pairs]
        owner = next((program for program in programs if program.unit.terminal), None)
        file = f"{folder}/nodes.json"
        plan = {
            "name": owner.unit.name if owner else ALL_NODES,
            "nodes": starts,
            "log": f"{folder}/{owner.log_name}.log" if owner else "",
            "parameters": f"{folder}/parameters.json",
            "viewers": viewer_socket(self.variables),
        }
        Path(file).write_text(json.dumps(plan, indent=1), encoding="utf-8")
        first = owner or programs[0]
        unit = replace(first.unit, name=str(plan["name"]), required=True, respawn=False)
        changes = tuple(pair for program in programs for pair in program.changes if pair[0] != "ROS_NAMESPACE")
        return (
            replace(
                first,
                unit=unit,
                argv=(sys.executable, "-I", "-m", "ur_nodes", _MODULE, file),
                changes=changes,
                cwd=None,
                log_name=first.log_name if owner else "nodes-1",
                screen=any(program.screen for program in programs),
                ready=tuple(each for program in programs for each in program.ready),
                executable=sys.executable,
                names_log=False,
                module=(),
            ),
        )

    def set_parameters(self, plan: Plan, folder: str, options: RunOptions, commands: CommandParameters) -> Event:
        try:
            printed = commands.collect()
            values = {each.name: printed.get(each.name, each.value) for each in plan.params}
            if values.get(_SIMULATED_TIME) is True:
                return SetupFailed(
                    "simulated time needs ROS: a speed other than 1, as publish_clock, is not possible here"
                )
            values |= find_descriptions(plan.nodes, values)
            text = json.dumps(values, default=list)  # bytes
            Path(f"{folder}/parameters.json").write_text(text, encoding="utf-8")
            facts = {"run_id": Path(folder).name, "base_name": options.base, "variant": options.variant}
            write_facts(self.facts, facts)
        except UserError as problem:
            return SetupFailed(str(problem))
        except OSError as problem:
            return SetupFailed(f"parameters cannot be written to {folder}: {(problem.strerror or '').lower()}")
        return ParametersSet()


def find_process(environment: Mapping[str, str], options: RunOptions) -> ProcessMiddleware:
    """Prepare the process of a run. Raises UserError if another run is active."""
    refuse_second_run(environment)
    return find_domain(ProcessMiddleware, environment, options)


def refuse_second_run(environment: Mapping[str, str], own: int | None = None) -> None:
    """Raise UserError while a run of a process other than `own` is active: the two cannot reach each other."""
    if others := list_others(environment, own):
        raise user_error(
            f"run {others[0].run} is under way: without ROS, all nodes are in its process, and no run can join it",
            rule="second-run",
            help=f"end it first: ur stop {others[0].run}; the page of 'ur web' can show and drive it",
            subject=others[0].run,
        )


def describe_start(program: UnitProgram, node: NodeSpec) -> dict[str, object]:
    """Describe the start of a node, as `ur_nodes.one_process.host` reads it. Raises UserError."""
    words = read_module(program.executable)
    if not words or node.launch_prefix:
        reason = (
            f"launch-prefix {node.launch_prefix!r} needs a process" if words else f"{program.executable} is a program"
        )
        raise user_error(
            f"{node.full_name}: {reason} of its own, expected a node of ur_nodes without launch-prefix",
            node.origin.span,
            rule="own-process",
            help=f"--except {node.full_name} leaves the node out; or use ROS 2 instead: ur use sim --ros 2",
        )
    own = program.argv[1 : len(program.argv) - len(node.remaps) - 1]
    return {
        "name": node.full_name,
        "words": (*words, *own),
        "remaps": {resolve_name(source, node): resolve_name(target, node) for source, target in node.remaps},
        "required": node.required,
        "respawn": node.respawn,
        "respawn_delay": node.respawn_delay,
        "terminal": node.terminal,
    }
