"""Execution of `ur launch` after its command line is parsed: answer a query, print commands, or run."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ur.request.arguments import split_argv
from ur.request.environment import apply_selection, current_selection
from ur.robot.selection import Selection
from ur.source.diagnostic import Diagnostic, UserError

if TYPE_CHECKING:
    from ur.request.options import LaunchOptions, Query, StartReporter

# roslaunch exits with 2 for errors that optparse finds, and with 1 for later ones.
_WRONG_ARGUMENTS = frozenset({"bad-argument", "bad-options", "refused-option"})
# Queries about the files: no robot is contacted for its base.
_OF_FILES = frozenset({"nodes", "files", "find-node", "args"})


def ask(argv: Sequence[str], query: Query) -> int:
    """Answer a query about the launch file that `argv` names, and return the exit code. Raises UserError."""
    from ur.request.questions import answer

    shell = dict(os.environ)
    selection = current_selection(os.environ)
    if query[0] not in _OF_FILES or not selection.base:
        from ur.request.bases.robot_facts import know_robot
        from ur.request.options import StartReporter

        selection = know_robot(selection, os.environ, split_argv(argv)[1], StartReporter().report)
    return answer(argv, selection, query, shell)


def act_on(argv: Sequence[str], options: LaunchOptions) -> int:
    """Answer the query or launch the file that `argv` names, and return the exit code. Raises UserError."""
    from ur.request.bases.robot_facts import know_robot
    from ur.request.options import StartReporter, choose_query

    query = choose_query(options.queries)
    if query is not None and query[0] != "dry-run":
        return ask(argv, query)
    shell = dict(os.environ)
    reporter = StartReporter()
    selection = know_robot(current_selection(os.environ), os.environ, split_argv(argv)[1], reporter.report)
    apply_selection(selection)
    if query is not None:
        return _dry_run(argv, selection, options, reporter, shell)
    return _start(argv, selection, options, reporter)


def _dry_run(
    argv: Sequence[str], selection: Selection, options: LaunchOptions, reporter: StartReporter, shell: dict[str, str]
) -> int:
    from ur.request.dry_run import format_dry_run
    from ur.request.launch_request import make_request
    from ur.request.node_choice import load_chosen
    from ur.request.plan_files import make_world

    loaded = load_chosen(make_request(argv, make_world(), selection, options), reporter.report)
    if loaded.plan is None:
        return 1
    lines, problems = format_dry_run(loaded.plan, loaded.world, shell, argv)
    sys.stdout.write("".join(f"{line}\n" for line in lines))
    sys.stdout.flush()
    if problems:
        _print_diagnostics(problems)
    return 1 if problems else 0


def _start(argv: Sequence[str], selection: Selection, options: LaunchOptions, reporter: StartReporter) -> int:
    from ur.cli.launch.start import run_launch

    if not options.detach:
        return run_launch(argv, selection, options, reporter, None)
    from ur.cli.runs.wait import start_detached

    return start_detached(
        lambda detach: run_launch(argv, selection, options, reporter, detach),
        wait=options.timeout_ready if options.wait else None,
    )


def explain_problem(problem: UserError, report: str | None = None) -> int:
    """Print errors about the user's input, and write them to `report` too; return the exit code."""
    if report is not None:
        from ur.request.launch import write_report

        write_report(problem.diagnostics, report)
    _print_diagnostics(problem.diagnostics)
    return 2 if any(each.rule in _WRONG_ARGUMENTS for each in problem.diagnostics) else 1


def _print_diagnostics(diagnostics: Sequence[Diagnostic]) -> None:
    from ur.source.render import render_human, shows_colour

    sys.stderr.write(render_human(diagnostics, colour=shows_colour(sys.stderr)))
