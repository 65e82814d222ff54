"""`ur launch`: start a launch file, in place of roslaunch."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Any

from ur.cli.environment import apply_selection, current_selection
from ur.cli.launch_options import LaunchCommand, Query, Wishes, check_wishes, choose_query, make_parameters
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError, error

# What optparse finds wrong ends roslaunch with 2, everything later with 1.
_WRONG_WORDS = frozenset({"bad-argument", "bad-options", "refused-option"})


def launch(
    words: tuple[str, ...],
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
    **options: Any,
) -> int:
    """Start a launch file, in place of roslaunch.

    The file is given by path, or as a package and a file name; '-' reads it from standard input. Starts a master where
    none runs, and stops everything again at the end: on Ctrl-C, when a required node ends, or when all nodes have
    ended. Options mean what they mean to roslaunch.
    """
    flags = {"nodes": nodes, "files": files, "dump-params": dump_params, "ros-args": ros_args, "dry-run": dry_run}
    queries: list[Query] = [(name, None) for name, asked in flags.items() if asked]
    queries += [(name, node) for name, node in (("find-node", find_node), ("args", args), ("dump", dump)) if node]
    wishes = Wishes(**options, queries=queries)
    check_wishes(words, wishes)
    if (with_origins or no_commands) and not dump:
        raise UserError(error("--with-origins and --no-commands belong to --dump json", rule="bad-options"))
    try:
        if dump:
            from ur.cli.dump import print_dump

            return print_dump(words, dict(os.environ), with_origins=with_origins, no_commands=no_commands)
        return _act(words, wishes)
    except UserError as problem:
        from ur.source.render import render_human

        sys.stderr.write(render_human(problem.diagnostics, colour=sys.stderr.isatty()))
        return 2 if any(each.rule in _WRONG_WORDS for each in problem.diagnostics) else 1


command = LaunchCommand("launch", callback=launch, params=make_parameters(), help=launch.__doc__)


def _act(words: Sequence[str], wishes: Wishes) -> int:
    shell = dict(os.environ)
    selection = _know_base(words, wishes)
    query = choose_query(wishes.queries)
    if query is not None and query[0] != "dry-run":
        from ur.cli.queries import answer

        return answer(words, selection, query, shell)
    apply_selection(selection)
    if not selection.simulated and os.environ["ROS_MASTER_URI"] != selection.master_uri:
        uri = os.environ["ROS_MASTER_URI"]
        wishes.say("warning", f"ROS_MASTER_URI={uri} was set by hand: {selection} is not used")
    return _dry_run(words, selection, wishes, shell) if query is not None else _start(words, selection, wishes)


def _know_base(words: Sequence[str], wishes: Wishes) -> Selection:
    from ur.cli.robot_facts import know_base

    selected = current_selection(os.environ)
    known = know_base(selected, os.environ)
    if selected.base not in ("", known.base) and not any(word.startswith("robot_base:=") for word in words):
        message = f"the robot that runs already is a {known.base}: the selection {selected} is not used"
        wishes.say("warning", message)
    return known


def _dry_run(words: Sequence[str], selection: Selection, wishes: Wishes, shell: dict[str, str]) -> int:
    from ur.cli.dry_run import print_dry_run
    from ur.cli.launch_run import load_wanted

    plan, world = load_wanted(words, selection, wishes)
    return 1 if plan is None else print_dry_run(plan, world, shell, words)


def _start(words: Sequence[str], selection: Selection, wishes: Wishes) -> int:
    from ur.cli.launch_run import run_launch

    if not wishes.detach:
        return run_launch(words, selection, wishes, None)
    from ur.cli.detached import start_detached

    return start_detached(
        lambda let_go: run_launch(words, selection, wishes, let_go),
        wait=wishes.timeout_ready if wishes.wait else None,
    )
