"""From a command line to a plan for pictures: errors are printed, and what is right is shown."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from ur.launchfile.plan.load import load_plan
from ur.launchfile.plan.model import Plan
from ur.request.environment import apply_selection, current_selection
from ur.request.launch_request import make_request
from ur.request.plan_files import complete_arguments, make_world, texts
from ur.source.diagnostic import Severity
from ur.source.progress_line import show_progress
from ur.source.render import render_human, shows_colour


def load_tolerantly(argv: Sequence[str]) -> tuple[Plan, list[str], bool]:
    """The plan behind `[PACKAGE] FILE [ARG:=VALUE]...`, the absolute paths of its files, and whether it has no error.

    Arguments that are declared and not given come from the selection. Findings go to standard error. Raises UserError:
    no such file, a name that is neither a file nor an argument.
    """
    selection = current_selection(os.environ)
    apply_selection(selection)
    world = make_world()
    with show_progress(f"reading {' '.join(argv)}"):
        request = make_request(argv, world, selection)
        files = request.files
        plan = load_plan(files.paths, texts(complete_arguments(request, local=True)), world, parsed=files.parsed)
    if plan.diagnostics:
        sys.stderr.write(render_human(plan.diagnostics, colour=shows_colour(sys.stderr)))
    sound = not any(found.severity is Severity.ERROR for found in plan.diagnostics)
    return plan, [world.absolute(path) for path in files.paths], sound
