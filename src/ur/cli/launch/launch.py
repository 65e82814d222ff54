"""`ur launch`: start a launch file, in place of roslaunch."""

from __future__ import annotations

import os
from typing import Any

import click

from ur.cli.launch.act import act_on, explain_problem
from ur.cli.launch.options import PARAMETERS, LaunchCommand
from ur.request.options import LaunchOptions, Query, check_options
from ur.source.diagnostic import UserError, error


def launch(
    argv: tuple[str, ...],
    nodes: bool,
    files: bool,
    find_node: str | None,
    args: str | None,
    dump_params: bool,
    ros_args: bool,
    dry_run: bool,
    dump: str | None,
    with_origins: bool,
    no_commands: bool,
    **others: Any,
) -> int:
    """Start a launch file, in place of roslaunch.

    The file is given by path, or as a package and a file name; '-' reads it from standard input. Starts a master where
    none runs, and stops everything again at the end: on Ctrl-C, when a required node ends, or when all nodes have
    ended. Options have the same meaning as for roslaunch.
    """
    flags = {"nodes": nodes, "files": files, "dump-params": dump_params, "ros-args": ros_args, "dry-run": dry_run}
    queries: list[Query] = [(name, None) for name, asked in flags.items() if asked]
    queries += [(name, node) for name, node in (("find-node", find_node), ("args", args), ("dump", dump)) if node]
    options = LaunchOptions(**others, queries=tuple(queries))
    if not argv and not options.core:
        raise click.UsageError("missing argument '[PACKAGE] FILE [ARG:=VALUE]...'", click.get_current_context())
    check_options(argv, options)
    if (with_origins or no_commands) and not dump:
        raise UserError(error("--with-origins and --no-commands belong to --dump json", rule="bad-options"))
    try:
        if dump:
            from ur.cli.launch.dump import print_dump

            return print_dump(argv, dict(os.environ), with_origins=with_origins, no_commands=no_commands)
        return act_on(argv, options)
    except UserError as problem:
        return explain_problem(problem, options.report)


command = LaunchCommand("launch", callback=launch, params=list(PARAMETERS), help=launch.__doc__)
