"""`ur launch` once its command line is understood: answer, describe, or run."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence

from ur.cli.environment import apply_selection, current_selection
from ur.cli.launch_wishes import Wishes, choose_query
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError

# What optparse finds wrong ends roslaunch with 2, everything later with 1.
_WRONG_WORDS = frozenset({"bad-argument", "bad-options", "refused-option"})


def act_on(words: Sequence[str], wishes: Wishes) -> int:
    """Do what is asked for and return the exit code. Raises UserError."""
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

    loaded = load_wanted(words, selection, wishes)
    return 1 if loaded.plan is None else print_dry_run(loaded.plan, loaded.world, shell, words)


def _start(words: Sequence[str], selection: Selection, wishes: Wishes) -> int:
    from ur.cli.launch_run import run_launch

    if not wishes.detach:
        return run_launch(words, selection, wishes, None)
    from ur.cli.detached import start_detached

    return start_detached(
        lambda let_go: run_launch(words, selection, wishes, let_go),
        wait=wishes.timeout_ready if wishes.wait else None,
    )


def explain_problem(problem: UserError) -> int:
    """Show what is wrong with what a person gave; returns the exit code."""
    from ur.source.render import render_human

    sys.stderr.write(render_human(problem.diagnostics, colour=sys.stderr.isatty()))
    return 2 if any(each.rule in _WRONG_WORDS for each in problem.diagnostics) else 1
