"""`ur launch` once its command line is understood: answer, describe, or run."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Iterable, Sequence

from ur.request.environment import apply_selection, current_selection, environment_changes
from ur.request.options import Wishes, choose_query
from ur.robot.selection import Selection
from ur.source.diagnostic import Diagnostic, Severity, UserError

# What optparse finds wrong ends roslaunch with 2, everything later with 1.
_WRONG_WORDS = frozenset({"bad-argument", "bad-options", "refused-option"})


def act_on(words: Sequence[str], wishes: Wishes) -> int:
    """Do what is asked for and return the exit code. Raises UserError."""
    shell = dict(os.environ)
    selection = _know_base(words, wishes)
    query = choose_query(wishes.queries)
    if query is not None and query[0] != "dry-run":
        from ur.request.questions import answer

        return answer(words, selection, query, shell)
    apply_selection(selection)
    return _dry_run(words, selection, wishes, shell) if query is not None else _start(words, selection, wishes)


def _know_base(words: Sequence[str], wishes: Wishes) -> Selection:
    from ur.request.robot_facts import know_base

    selected = _follow_master(current_selection(os.environ), wishes)
    known = know_base(selected, os.environ)
    if selected.base not in ("", known.base) and not any(word.startswith("robot_base:=") for word in words):
        message = f"the robot that runs already is a {known.base}: the selection {selected} is not used"
        wishes.say("warning", message)
    return known


def _follow_master(selected: Selection, wishes: Wishes) -> Selection:
    """The selection, or the robot of a ROS_MASTER_URI that a person has set. Raises UserError."""
    if selected.simulated:
        return selected
    from ur.robot.master_choice import follow_master

    uri = environment_changes(selected, os.environ).get("ROS_MASTER_URI", os.environ.get("ROS_MASTER_URI", ""))
    robot = follow_master(selected, uri, socket.gethostname())
    if robot.robot != selected.robot:
        wishes.say("warning", f"ROS_MASTER_URI={uri} was set by hand: using {robot} with that master, not {selected}")
    return robot


def _dry_run(words: Sequence[str], selection: Selection, wishes: Wishes, shell: dict[str, str]) -> int:
    from ur.cli.launch.dry_run import print_dry_run
    from ur.cli.launch.start import load_wanted

    loaded = load_wanted(words, selection, wishes)
    return 1 if loaded.plan is None else print_dry_run(loaded.plan, loaded.world, shell, words)


def _start(words: Sequence[str], selection: Selection, wishes: Wishes) -> int:
    from ur.cli.launch.start import run_launch

    if not wishes.detach:
        return run_launch(words, selection, wishes, None)
    from ur.cli.runs.detached import start_detached

    return start_detached(
        lambda let_go: run_launch(words, selection, wishes, let_go),
        wait=wishes.timeout_ready if wishes.wait else None,
    )


def explain_problem(problem: UserError, report: str | None = None) -> int:
    """Show what is wrong with what a person gave, and write it to `report` too; returns the exit code."""
    from ur.source.render import render_human, shows_colour

    if report is not None:
        write_report(problem.diagnostics, report)
    sys.stderr.write(render_human(problem.diagnostics, colour=shows_colour(sys.stderr)))
    return 2 if any(each.rule in _WRONG_WORDS for each in problem.diagnostics) else 1


def write_report(diagnostics: Iterable[Diagnostic], path: str) -> None:
    """Write errors to a file, for the laptop that has asked for this run."""
    import json
    from contextlib import suppress
    from pathlib import Path

    errors = [each for each in diagnostics if each.severity is Severity.ERROR]
    fields = [
        {
            "message": each.message,
            "help": each.help or "",
            "rule": each.rule,
            "place": str(each.span) if each.span else "",
        }
        for each in errors
    ]
    with suppress(OSError):
        Path(path).write_text(json.dumps(fields), encoding="utf-8")
