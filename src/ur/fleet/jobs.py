"""The state of a command that runs for several robots: jobs, their states, and both as text. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from ur.source.printable import printable

SHOWN = 100  # characters of a line of output
FEW_LINES = 4  # of output, that are an error and its help
Phase = Literal["waiting", "running", "asking", "done"]
INTERRUPTED = 130  # the exit code of a command that Ctrl-C has ended


@dataclass(frozen=True, slots=True)
class Job:
    """The command for one robot.

    `stdin` is its input; with `asks`, it asks for confirmation over standard input instead.
    """

    name: str
    argv: tuple[str, ...]
    stdin: str = field(default="", repr=False)
    asks: bool = False


@dataclass(frozen=True, slots=True)
class JobStatus:
    """The state of a job. Times are in s, of the same clock; `line` is the last line of its output.

    `code` is the exit code of a finished job, with 128 added to the number of a signal.
    """

    name: str
    phase: Phase = "waiting"
    began: float = 0.0
    ended: float = 0.0
    line: str = ""
    code: int | None = None


Fleet = tuple[JobStatus, ...]


def plan_fleet(jobs: Sequence[Job]) -> Fleet:
    """Return the state before any job has started."""
    return tuple(JobStatus(job.name) for job in jobs)


def find_startable(fleet: Fleet, limit: int) -> list[int]:
    """Return the indices of the jobs that may start now, in order, so that at most `limit` run.

    A job that asks does not count.
    """
    free = limit - sum(each.phase == "running" for each in fleet)
    waiting = [index for index, each in enumerate(fleet) if each.phase == "waiting"]
    return waiting[: max(0, free)]


def begin_job(fleet: Fleet, index: int, now: float) -> Fleet:
    """Return the state after a job has started."""
    return _change(fleet, index, phase="running", began=now)


def note_line(fleet: Fleet, index: int, line: str) -> Fleet:
    """Return the state after a job has printed a line."""
    return _change(fleet, index, line=line)


def note_question(fleet: Fleet, index: int) -> Fleet:
    """Return the state after a job has asked for confirmation."""
    return _change(fleet, index, phase="asking")


def are_all_asking(fleet: Fleet) -> bool:
    """Return whether at least one job waits for an answer, and all others are finished."""
    phases = {each.phase for each in fleet}
    return "asking" in phases and phases <= {"asking", "done"}


def answer_questions(fleet: Fleet) -> Fleet:
    """Return the state after all questions were answered."""
    return tuple(replace(each, phase="running") if each.phase == "asking" else each for each in fleet)


def end_job(fleet: Fleet, index: int, code: int, now: float) -> Fleet:
    """Return the state after a job has ended. `code` is that of subprocess: negative for a signal."""
    return _change(fleet, index, phase="done", code=code if code >= 0 else 128 - code, ended=now)


def interrupt_fleet(fleet: Fleet, now: float) -> Fleet:
    """Return the state after Ctrl-C has ended every unfinished job."""
    return tuple(
        each if each.phase == "done" else replace(each, phase="done", code=INTERRUPTED, ended=now) for each in fleet
    )


def is_over(fleet: Fleet) -> bool:
    """Return whether every job is finished."""
    return all(each.phase == "done" for each in fleet)


def find_exit_code(fleet: Fleet) -> int:
    """Return the exit code of the whole: the highest of all jobs."""
    return max((each.code or 0 for each in fleet), default=0)


def _change(fleet: Fleet, index: int, **changes: object) -> Fleet:
    changed = replace(fleet[index], **changes)  # type: ignore[arg-type] # keywords of this module
    return (*fleet[:index], changed, *fleet[index + 1 :])


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
