"""From the words of a command line to a plan for pictures: what is wrong is said, and what is right is shown."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from ur.cli.environment import apply_selection, current_selection
from ur.cli.plan_files import declared_arguments, refuse_stray_words, selected_arguments
from ur.launchfile.address import resolve_addresses
from ur.launchfile.plan.load import load_plan
from ur.launchfile.plan.model import Plan
from ur.launchfile.world.system import SystemWorld
from ur.source.diagnostic import Severity
from ur.source.render import render_human


def load_tolerantly(words: Sequence[str]) -> tuple[Plan, list[str], bool]:
    """The plan behind `[PACKAGE] FILE [ARG:=VALUE]...`, the absolute paths of its files, and whether it has no error.

    Arguments that are declared and not given come from the selection. Findings go to standard error. Raises UserError:
    no such file, a word that is neither a file nor an argument.
    """
    selection = current_selection(os.environ)
    apply_selection(selection)
    world = SystemWorld(os.environ, standard_input=lambda: sys.stdin.buffer.read())
    files = resolve_addresses(words, world)
    declared = declared_arguments(files, world)
    refuse_stray_words(files, declared, world)
    given = [word for word in words if ":=" in word]
    arguments = [*given, *selected_arguments(selection, declared, given, here=True)]
    plan = load_plan(files, arguments, world)
    if plan.diagnostics:
        sys.stderr.write(render_human(plan.diagnostics, colour=sys.stderr.isatty()))
    sound = not any(found.severity is Severity.ERROR for found in plan.diagnostics)
    return plan, [world.absolute(path) for path in files], sound
