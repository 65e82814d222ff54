"""The state of a command that runs for several robots, as text: one line each, and a summary. Pure."""

from collections.abc import Sequence

from ur.fleet.jobs import INTERRUPTED, Fleet, JobStatus
from ur.source.printable import printable

SHOWN = 100  # characters of a line of output
FEW_LINES = 4  # of output, that are an error and its help


def describe_fleet(fleet: Fleet, now: float) -> list[str]:
    """Return one line for each job: its name, state, duration, and last line of output."""
    width = max((len(each.name) for each in fleet), default=0)
    states = [describe_state(each) for each in fleet]
    wide = max((len(each) for each in states), default=0)
    return [
        f"{printable(each.name):{width}}  {state:{wide}}  {_seconds(each, now):>6}  {_line(each)}".rstrip()
        for each, state in zip(fleet, states, strict=True)
    ]


def describe_end(status: JobStatus) -> str:
    """Return the line about a finished job, for output that is not a terminal."""
    line = f": {_line(status)}" if status.line else ""
    return f"{printable(status.name)}: {describe_state(status)} after {_seconds(status, status.ended).strip()}{line}"


def describe_state(status: JobStatus) -> str:
    """Return the state of a job in a word or two."""
    if status.phase != "done":
        return {"waiting": "waiting", "running": "running", "asking": "ready"}[status.phase]
    if status.code == INTERRUPTED:
        return "interrupted"
    return f"failed ({status.code})" if status.code else "ok"


def summarise(fleet: Fleet) -> str:
    """Return the last line: how many robots succeeded, and the names of the others."""
    good = sum(each.code == 0 for each in fleet)
    robots = "1 robot" if len(fleet) == 1 else f"{len(fleet)} robots"
    stopped = [each.name for each in fleet if each.code == INTERRUPTED]
    failed = [each.name for each in fleet if each.code and each.code != INTERRUPTED]
    parts = [f"{good} of {robots} ok"]
    parts += [f"failed: {printable(', '.join(failed))}"] if failed else []
    parts += [f"interrupted: {printable(', '.join(stopped))}"] if stopped else []
    return "; ".join(parts)


def choose_line(lines: Sequence[str], code: int | None) -> str:
    """Return the line that represents an output: the last one; of a short output with an error, the first one."""
    full = [line.strip() for line in lines if line.strip()]
    if not full:
        return ""
    return full[0] if code and len(full) <= FEW_LINES else full[-1]


def _seconds(status: JobStatus, now: float) -> str:
    if status.phase == "waiting" or (status.phase == "done" and not status.began):
        return ""
    return f"{(status.ended if status.phase == 'done' else now) - status.began:.0f} s"


def _line(status: JobStatus) -> str:
    return printable(status.line)[:SHOWN]
