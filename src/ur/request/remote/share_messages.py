"""Messages about a robot's share of a run: its nodes, its end, and reasons for a failed start."""

from __future__ import annotations

from collections.abc import Sequence

from ur.run.remote.protocol import Problem, ShareAnswer
from ur.source.diagnostic import UserError, error_about

# Of the command line: the launch file does not exist on the robot
_MISSING = frozenset({"missing-file", "unknown-package"})


def describe_part(robot: str, answer: ShareAnswer, count: int) -> list[str]:
    """Describe the nodes that run on the robot, in a line or two."""
    lines = []
    if answer.renamed_from:
        lines.append(f"{robot}: its nodes ran under its old name {answer.renamed_from} and are started again")
    if answer.running:
        others = "node runs" if len(answer.running) == 1 else "nodes run"
        lines.append(f"{robot}: {len(answer.running)} {others} already: {', '.join(answer.running)}")
    if answer.run:
        number = count - len(answer.running)
        what = f"{number} node{'' if number == 1 else 's'}, run {answer.run}"
        found = f", {_explain_found(answer.clients)}" if answer.found else ""
        lines.append(f"{robot}: {what}{found}; what they print: ur shell {robot} ur attach {answer.run}")
    if answer.clients and not answer.found:
        lines.append(f"{robot}: {', '.join(answer.clients)} {_use(answer.clients)} these nodes too")
    return lines


def describe_end(robot: str, answer: ShareAnswer) -> list[str]:
    """Describe the state of the robot's nodes after this run has unregistered from them."""
    lines = [f"{robot}: {run} has ended" for run in answer.ended]
    return [*lines, *(f"{robot}: {run} goes on for {', '.join(answer.clients)}" for run in answer.kept)]


def explain_problem(robot: str, problem: Problem) -> UserError:
    """Convert a problem of the robot to an error of this computer."""
    help_ = problem.help or f"ur doctor {robot}"
    if problem.rule in _MISSING and not problem.place:
        help_ = f"is it in the workspace of this computer? then: ur sync {robot}"
    place = f"{problem.place}: " if problem.place else ""
    return UserError(error_about(robot, f"{place}{problem.message}", rule=problem.rule or "robot-part", help=help_))


def _explain_found(clients: Sequence[str]) -> str:
    return f"which {', '.join(clients)} {_use(clients)} too" if clients else "which ran already and is taken over"


def _use(names: Sequence[str]) -> str:
    return "uses" if len(names) == 1 else "use"
