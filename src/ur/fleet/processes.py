"""The processes of a command that runs for several robots: started, monitored and ended together."""

from __future__ import annotations

import os
import re
import select
import signal
import socket
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ur.fleet.jobs import (
    Fleet,
    Job,
    answer_questions,
    are_all_asking,
    begin_job,
    choose_line,
    end_job,
    find_startable,
    interrupt_fleet,
    is_over,
    note_line,
    note_question,
    plan_fleet,
)
from ur.source.ansi import strip_styles
from ur.source.user_folders import user_folder
from ur.system.child_processes import end_with_us

TAIL = 4096  # bytes in which the last line is looked for
MOST_BYTES = 1 << 22  # of an output that is printed again; the file has all of it


def logs_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder of these files, below the user's state folder (XDG base directory specification)."""
    return Path(user_folder("XDG_STATE_HOME", environment)) / "ubiquity_launches" / "fleet"


@dataclass(slots=True)
class LogFile:
    """An open file with the output of a command. It is read through its descriptor, since its path may change."""

    path: Path
    descriptor: int

    def read_all(self) -> str:
        """Read the output, or the end of one that is larger than MOST_BYTES."""
        size = os.fstat(self.descriptor).st_size
        return self._read(max(0, size - MOST_BYTES), MOST_BYTES)

    def read_tail(self) -> list[str]:
        """Read the last lines."""
        size = os.fstat(self.descriptor).st_size
        return self._read(max(0, size - TAIL), TAIL).splitlines()

    def size(self) -> int:
        """Return the present number of bytes."""
        return os.fstat(self.descriptor).st_size

    def close(self) -> None:
        """Close the file without deleting it."""
        os.close(self.descriptor)

    def _read(self, start: int, size: int) -> str:
        text = os.pread(self.descriptor, size, start).decode(errors="replace")
        return strip_styles(text.replace("\r\n", "\n").replace("\r", "\n"))


def open_log(folder: Path, command: str, robot: str, kind: str = "log") -> LogFile:
    """Open a new file for the output of a command on a robot.

    Only this user may read it. Raises OSError. An existing file is replaced: a process that still writes to it is not
    affected.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    path = folder / f"{_name(command)}-{_name(robot)}.{kind}"
    with suppress(FileNotFoundError):
        path.unlink()
    flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_APPEND | os.O_NOFOLLOW | os.O_CLOEXEC
    return LogFile(path, os.open(path, flags, 0o600))


def _name(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9@._-]+", "_", text)[:100]


AT_ONCE = 16
PERIOD = 0.25  # s between two pictures
ASK, YES, NO = b"ask\n", b"yes\n", b"no\n"
# Longer than any command takes to end its processes on its robot.
STEPS = ((signal.SIGINT, 25.0), (signal.SIGTERM, 5.0), (signal.SIGKILL, 5.0))

Show = Callable[[Fleet, float], None]
Confirm = Callable[[Fleet, Sequence["Output"]], bool]


@dataclass(slots=True)
class Output:
    """The output of a job. `errors` is separate if that was requested."""

    log: LogFile
    errors: LogFile | None = None

    def close(self) -> None:
        """Close the files without deleting them."""
        self.log.close()
        if self.errors:
            self.errors.close()


@dataclass(slots=True)
class _Child:
    process: subprocess.Popen[bytes]
    handle: int  # readable when the process has ended: pidfd_open(2)
    questions: socket.socket | None
    shown: int = 0  # bytes of the log whose last line is shown


class Processes:
    """Runs a command for each robot; a context manager. All processes have ended when it exits, for any reason."""

    def __init__(
        self, jobs: Sequence[Job], folder: Path, command: str, *, limit: int = AT_ONCE, errors_apart: bool = False
    ) -> None:
        """Create the processes of jobs, with the folder for the files of their output. `command` names these files."""
        self._jobs = jobs
        self._limit = limit
        self._children: dict[int, _Child] = {}
        self.fleet = plan_fleet(jobs)
        self.outputs = [
            Output(
                open_log(folder, command, job.name),
                open_log(folder, command, job.name, "errors") if errors_apart else None,
            )
            for job in jobs
        ]

    def __enter__(self) -> Processes:
        return self

    def __exit__(self, *_: object) -> None:
        self._end_all()
        for output in self.outputs:
            output.close()

    def run(self, show: Show, confirm: Confirm | None = None) -> Fleet:
        """Run all jobs to their ends; return the final state. Raises KeyboardInterrupt after all were ended.

        `show` is called periodically, and at each change. `confirm` is called once when no job runs and some ask for
        confirmation; its answer is given to all of these.
        """
        try:
            while not is_over(self.fleet):
                for index in find_startable(self.fleet, self._limit):
                    self._begin(index)
                show(self.fleet, time.monotonic())
                self._wait(PERIOD)
                if confirm and are_all_asking(self.fleet):
                    self._answer(YES if confirm(self.fleet, self.outputs) else NO)
        except KeyboardInterrupt:
            self._end_all()
            self.fleet = interrupt_fleet(self.fleet, time.monotonic())
            show(self.fleet, time.monotonic())
            raise
        show(self.fleet, time.monotonic())
        return self.fleet

    def _begin(self, index: int) -> None:
        job, output = self._jobs[index], self.outputs[index]
        ours, theirs = socket.socketpair() if job.asks else (None, None)
        argv = [*end_with_us(), *job.argv]
        try:
            process = subprocess.Popen(
                argv,
                stdin=theirs.fileno() if theirs else subprocess.PIPE,
                stdout=output.log.descriptor,
                stderr=(output.errors or output.log).descriptor,
                start_new_session=True,  # Ctrl-C is for this process only, and no question uses this terminal
            )
        finally:
            if theirs:
                theirs.close()
        if process.stdin:
            with suppress(BrokenPipeError):
                process.stdin.write(job.stdin.encode())  # a line or two: it fits into the pipe
                process.stdin.flush()
            with suppress(BrokenPipeError):
                process.stdin.close()
        self._children[index] = _Child(process, os.pidfd_open(process.pid), ours)
        self.fleet = begin_job(self.fleet, index, time.monotonic())

    def _wait(self, seconds: float) -> None:
        """Wait until a process ends or asks, or `seconds` pass, and record that with the last lines."""
        waited: list[int | socket.socket] = [child.handle for child in self._children.values()]
        waited += [child.questions for child in self._children.values() if child.questions]
        select.select(waited, [], [], seconds)
        for index, child in list(self._children.items()):
            code = child.process.poll()
            log = self.outputs[index].log
            size = log.size()
            if size != child.shown or code is not None:
                child.shown = size
                self.fleet = note_line(self.fleet, index, choose_line(log.read_tail(), code))
            if code is not None:
                self.fleet = end_job(self.fleet, index, code, time.monotonic())
                _close(self._children.pop(index))
            elif child.questions and (reported := _read_question(child.questions)) is not None:
                if reported == ASK:
                    self.fleet = note_question(self.fleet, index)
                else:  # it asks no more
                    child.questions.close()
                    child.questions = None

    def _answer(self, word: bytes) -> None:
        for index, child in self._children.items():
            if child.questions and self.fleet[index].phase == "asking":
                with suppress(OSError):  # it has just ended
                    child.questions.sendall(word)
        self.fleet = answer_questions(self.fleet)

    def _end_all(self) -> None:
        """End the running processes: as Ctrl-C does, then by stronger signals. A second Ctrl-C skips the wait."""
        for number, patience in STEPS:
            for child in self._children.values():
                if child.process.poll() is None:
                    with suppress(ProcessLookupError):
                        if number == signal.SIGKILL:
                            os.killpg(child.process.pid, number)
                        else:
                            child.process.send_signal(number)  # the command ends its own children
            end = time.monotonic() + patience
            try:
                for child in self._children.values():
                    with suppress(subprocess.TimeoutExpired):
                        child.process.wait(max(0.0, end - time.monotonic()))
            except KeyboardInterrupt:
                continue
        for child in self._children.values():
            _close(child)
        self._children.clear()


def answer_confirmed(descriptor: int) -> bool:
    """Ask the parent process for confirmation over a socket; for a job that `asks`."""
    with socket.socket(fileno=os.dup(descriptor)) as parent:
        parent.sendall(ASK)
        return parent.recv(16) == YES


def _read_question(questions: socket.socket) -> bytes | None:
    """Read available data: b"" at the end, None if there is none."""
    with suppress(BlockingIOError, ConnectionError):
        return questions.recv(16, socket.MSG_DONTWAIT)
    return None


def _close(child: _Child) -> None:
    os.close(child.handle)
    if child.questions:
        child.questions.close()
