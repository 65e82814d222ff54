"""Start of another launcher under this project's guard: `ur launch -- ros2 launch PACKAGE FILE`."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from ur.launchfile.plan.specs import NodeSpec, Origin, Plan, ReadyCondition
from ur.source.file import SourceFile, Span

if TYPE_CHECKING:
    from ur.request.launch_request import LaunchOptions
    from ur.run.output.console import Console
    from ur.run.process.host_client import ProcessHost
    from ur.run.record.registry import RunEntry


def make_foreign_plan(command: Sequence[str], *, terminal: bool) -> Plan:
    """Return the plan of a command line, whose end is that of the run."""
    program, *arguments = command
    span = Span(SourceFile("command line", " ".join(command)), 0, 0)
    node = NodeSpec(
        name=os.path.basename(program),  # noqa: PTH119 - of a text
        namespace="/",
        package="",
        type=program,
        args="",
        machine=None,
        respawn=False,
        respawn_delay=0.0,
        required=True,
        output="screen",
        cwd=None,
        launch_prefix=None,
        remaps=(),
        env=(),
        origin=Origin(span),
        terminal=terminal,
        ready=(ReadyCondition("process", ""),),
        kind="program",
        words=tuple(arguments),
    )
    return Plan((node,), (), (), (), (), (" ".join(command),), launcher="other")


def run_foreign(
    plan: Plan,
    options: LaunchOptions,
    host: ProcessHost,
    console: Console,
    call_started: Callable[[RunEntry], None] | None,
) -> int:
    """Run the plan to its end, in the environment of this process, and return the exit code."""
    from ur.request.launch import make_limits
    from ur.request.plan_files import make_world
    from ur.run.launch import run_plan
    from ur.run.options import RunOptions

    events = 1 if options.json else None
    run_options = RunOptions(limits=make_limits(options), events=events, call_started=call_started)
    return run_plan(plan, make_world(), host, console, run_options)
