"""Parent of the process that expands a xacro file: it sets limits, and answers the requests within them."""

import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Timer
from typing import IO, Literal

SECONDS = 60  # s of processor time, and in all; xacro files may be recursive without end
MEMORY = 1 << 30  # bytes of address space
MOST_SENT = 20_000_000  # bytes of one message of the process
MOST_READ = 100_000_000  # bytes of all files that one description includes
MOST_QUESTIONS = 100_000
SECCOMP = "libseccomp.so.2"  # apt depends on it, so Debian and Ubuntu always have it
_SCRIPT = Path(__file__).with_name("confined.py")


@dataclass(frozen=True, slots=True)
class ExpansionBounds:
    """Limits of an expansion in seconds and number of requests, and the library that confines the process (seccomp)."""

    seconds: int = SECONDS
    questions: int = MOST_QUESTIONS
    seccomp: str = SECCOMP


BOUNDS = ExpansionBounds()


@dataclass(frozen=True, slots=True)
class Expansion:
    """The result of an expansion: the URDF `text`, or a `problem` that is not empty.

    `unconfined` is the reason why the process could not be confined; then nothing of the description was executed.
    `missing` are packages that were requested but not found.
    """

    text: str = ""
    problem: str = ""
    unconfined: str = ""
    missing: tuple[str, ...] = ()


class QuestionRefused(Exception):  # noqa: N818 - an answer, with its reason
    """A request of the process that is refused, with the reason."""


Answer = Callable[[str], object]


def expand(
    order: Mapping[str, object],
    answers: Mapping[str, Answer],
    *,
    confined: bool = True,
    bounds: ExpansionBounds = BOUNDS,
) -> Expansion:
    """Run xacro as `order` describes (`library`, `file`, `folder`, `arguments`), and answer its requests by their kind.

    An answer raises QuestionRefused. Unless it is `confined`, the process has all rights of its parent.
    """
    child = subprocess.Popen(
        [sys.executable, "-I", str(_SCRIPT)],
        env={"LC_ALL": "C.UTF-8", "HOME": "/"},  # no environment variables of the user
        cwd="/",
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    timer = Timer(bounds.seconds, child.kill)
    timer.start()
    assert child.stdin
    assert child.stdout
    limits = {"memory": MEMORY, "seconds": bounds.seconds, "seccomp": bounds.seccomp if confined else ""}
    try:
        report = _converse(child.stdin, child.stdout, {**order, **limits}, answers, bounds.questions)
    except (BrokenPipeError, EOFError):
        report = None
    except (ValueError, KeyError):
        report = _Message(end="done", problem="it sent what xacro does not send")
    finally:
        late = not timer.is_alive()
        timer.cancel()
        child.kill()
        child.wait()
        child.stdout.close()
        with suppress(BrokenPipeError):  # the process ended before it read the last answer
            child.stdin.close()
    if report:
        return _read_report(report)
    return Expansion(problem=f"it did not finish within {bounds.seconds} s" if late else "it ended without a result")


@dataclass(frozen=True, slots=True)
class _Message:
    """A line from the process: `ask` requests the thing with the name `of`; `end` has the result."""

    ask: str = ""
    of: str = ""
    end: Literal["", "done", "not confined"] = ""
    text: str = ""
    problem: str = ""
    errors: str = ""
    missing: tuple[str, ...] = ()


def _converse(
    to: IO[bytes], of: IO[bytes], order: Mapping[str, object], answers: Mapping[str, Answer], most: int
) -> _Message:
    from ur.source.foreign.json_values import read_json  # imported late: only expansions need it

    _send(to, order)
    for _ in range(most):
        line = of.readline(MOST_SENT)
        if not line.endswith(b"\n"):
            if len(line) == MOST_SENT:
                return _Message(end="done", problem=f"the result is larger than {MOST_SENT:,} bytes")
            raise EOFError
        message = read_json(line, _Message, MOST_SENT)
        if message.end:
            return message
        try:
            _send(to, {"value": answers[message.ask](message.of)})
        except QuestionRefused as reason:
            _send(to, {"error": str(reason)})
    return _Message(end="done", problem=f"it asked for more than {most:,} files and packages")


def _send(to: IO[bytes], fields: Mapping[str, object]) -> None:
    to.write(json.dumps(fields).encode() + b"\n")
    to.flush()


def _read_report(report: _Message) -> Expansion:
    if report.end == "not confined":
        return Expansion(unconfined=report.problem or "no reason is known")
    lines = [line for line in report.errors.strip().splitlines() if line.strip() not in ("", "error:")]
    problem = report.problem and (lines or [report.problem])[0]
    return Expansion(report.text, problem, missing=tuple(dict.fromkeys(report.missing)))
