"""The way round click, for plain command lines only: importing it takes longer than reading a large launch file.

To roslaunch's questions only good news is told here: for everything else the usual way is gone, from its start, and
says what is wrong.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Sequence

_FLAGS = {"--nodes": "nodes", "--files": "files"}
_WITH_NODE = {"--find-node": "find-node", "--args": "args"}


def answer_fast(argv: Sequence[str]) -> int | None:
    """Answer `ur ARGUMENTS` when it is one plain question about launch files; else None, and nothing is printed."""
    question = read_question(argv)
    if question is None:
        return None
    gc.disable()  # nothing lives long enough to be worth collecting
    try:
        from ur.request.environment import current_selection
        from ur.request.questions import answer

        selection = current_selection(os.environ)
        if not selection.base:
            return None  # the robot itself may know it
        return answer(question[1], selection, question[0], dict(os.environ))
    except KeyboardInterrupt:
        return 130
    except Exception:  # the normal path meets it again, and explains it
        return None
    finally:
        gc.enable()


def launch_fast(argv: Sequence[str]) -> int | None:
    """Run `ur launch [PACKAGE] FILE [ARG:=VALUE]...`; return None, without effects, for other commands and options."""
    if len(argv) < 2 or argv[0] != "launch" or any(word.startswith("-") for word in argv):
        return None
    try:
        from ur.cli.launch.act import act_on, explain_problem
        from ur.request.options import LaunchOptions
        from ur.source.diagnostic import UserError
        from ur.source.printable import guard_output

        with guard_output():
            try:
                return act_on(argv[1:], LaunchOptions())
            except UserError as problem:
                return explain_problem(problem)
    except KeyboardInterrupt:
        return 130
    except Exception as problem:
        from ur.cli.main import explain_exception

        return explain_exception(problem, list(argv))


def read_question(argv: Sequence[str]) -> tuple[tuple[str, str | None], list[str]] | None:
    """The question, and the arguments it is about: `launch --nodes FILE [ARG:=VALUE]...`, the option in any place."""
    if len(argv) < 3 or argv[0] != "launch":
        return None
    rest = list(argv[1:])
    options = [word for word in rest if word.startswith("-")]
    if len(options) != 1:
        return None
    at = rest.index(options[0])
    if options[0] in _FLAGS:
        del rest[at]
        return ((_FLAGS[options[0]], None), rest)
    if options[0] in _WITH_NODE and len(rest) > at + 2:
        node = rest[at + 1]
        del rest[at : at + 2]
        return ((_WITH_NODE[options[0]], node), rest)
    return None
