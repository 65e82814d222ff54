"""`ur launch --dump json`: the complete plan of a launch file, as roslaunch understands it."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence

from ur.launchfile.dump import dump_plan, dump_refusal
from ur.launchfile.plan.commands import refuse_command, run_command
from ur.launchfile.plan.load import load_plan
from ur.request.launch_request import make_request
from ur.request.plan_files import texts
from ur.request.questions import make_world
from ur.source.diagnostic import UserError


def print_dump(
    argv: Sequence[str], shell: Mapping[str, str], *, with_origins: bool = False, no_commands: bool = False
) -> int:
    """Print the plan of `[PACKAGE] FILE [ARG:=VALUE]...` as JSON with sorted keys; return 1 if roslaunch refuses it.

    The selection is ignored: the same arguments and environment have the meaning that they have for roslaunch.
    `no_commands` refuses files with `<param command=...>` instead of running the programs.
    """
    world = make_world(shell, anonymous=True)
    try:
        request = make_request(argv, world)
        files = request.files
        plan = load_plan(files.paths, texts(request.arguments), world, parsed=files.parsed)
        dumped = dump_plan(plan, with_origins=with_origins, run=refuse_command if no_commands else run_command)
    except UserError as problem:
        dumped = dump_refusal(problem.diagnostics)
    sys.stdout.write(json.dumps(dumped, sort_keys=True, indent=2) + "\n")
    sys.stdout.flush()
    return 0 if dumped["ok"] else 1
