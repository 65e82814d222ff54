"""Fast path of `ur launch`: no options, or one that queries nodes, files or a command line.

It is the code of `ur.cli.launch.launch` without click, whose import takes longer than reading a large launch file.
"""

from __future__ import annotations

import gc
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ur.request.options import Query

_FLAGS = ("--nodes", "--files")
_WITH_NODE = ("--find-node", "--args")


def launch_fast(argv: Sequence[str]) -> int | None:
    """Run `ur launch [QUESTION] [PACKAGE] FILE [ARG:=VALUE]...`; return None, without effects, for other commands."""
    found = read_plain(argv)
    if found is None:
        return None
    names, query = found
    try:
        if query is not None:
            gc.disable()  # garbage collection is useless in such a short process
        from ur.cli.launch.act import act_on, ask, explain_problem
        from ur.source.diagnostic import UserError
        from ur.source.printable import guard_output, open_closed_streams

        open_closed_streams()
        with guard_output():
            try:
                if query is not None:
                    return ask(names, query)
                from ur.request.options import LaunchOptions

                return act_on(names, LaunchOptions())
            except UserError as problem:
                return explain_problem(problem)
    except KeyboardInterrupt:
        return 130
    except Exception as problem:
        from ur.cli.main import explain_exception

        return explain_exception(problem, list(argv))
    finally:
        gc.enable()


def read_plain(argv: Sequence[str]) -> tuple[list[str], Query | None] | None:
    """The names and arguments of a launch, and its question; None for other commands and options."""
    names = list(argv[1:])
    given = [each for each in names if each.startswith("-")]
    if not names or argv[0] != "launch" or len(given) > 1:
        return None
    if not given:
        return names, None
    at = names.index(given[0])
    question, *rest = names[at:]
    if question in _FLAGS and len(names) > 1:
        return names[:at] + rest, (question[2:], None)
    if question in _WITH_NODE and len(rest) > 1:
        return names[:at] + rest[1:], (question[2:], rest[0])
    return None
