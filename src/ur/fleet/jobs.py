"""The state of a command that runs for several robots: which jobs may start, their states, and the results. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

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
