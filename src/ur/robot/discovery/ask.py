"""Query of a robot's clock and boot services: over one ssh connection by key, for a limited time."""

import subprocess
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import IO

from ur.robot.boot.units import PREFIX
from ur.robot.discovery.listing import RobotAnswer

ROUNDS = 4
UNKNOWN_KEY = "host key unknown"
_REFUSALS = (
    ("Host key verification failed", UNKNOWN_KEY),
    ("IDENTIFICATION HAS CHANGED", "another host key"),
    ("Permission denied", "key refused"),
    ("Connection refused", "no ssh server"),
)
END = "end"
# After END, each line is answered by the time: the connection is established by then, so the answer is fast.
SCRIPT = (
    f"systemctl list-units --all --plain --no-legend '{PREFIX}*.service' 2>/dev/null; echo {END}; "
    "while read -r x; do date +%s.%N; done"
)


def ask_robot(
    login: str, names: Sequence[str], seconds: float, clock: Callable[[], float], over: threading.Event
) -> RobotAnswer:
    """Ask a robot at USER@ADDRESS, whose host key is known as NAME.local for one of `names`, which are tried in turn.

    Each attempt is limited to `seconds`. `clock` gives the local time (s since 1970). The query ends as soon as `over`
    is set. Without an answer, `refused` of the result is the reason. Raises nothing.
    """
    answer = RobotAnswer()
    for name in names:
        answer = _ask(login, name, seconds, clock, over)
        if not answer.refused:
            return replace(answer, known_as=name)
        if answer.refused != UNKNOWN_KEY:
            break
    return answer


def _ask(login: str, name: str, seconds: float, clock: Callable[[], float], over: threading.Event) -> RobotAnswer:
    options = [
        *("BatchMode=yes", "StrictHostKeyChecking=yes", f"HostKeyAlias={name}.local", "CheckHostIP=no"),
        *(f"ConnectTimeout={max(1, round(seconds))}", "LogLevel=ERROR", "ForwardX11=no", "ControlPath=none"),
    ]
    command = ["ssh", "-T", *(word for option in options for word in ("-o", option)), "--", login, SCRIPT]
    with suppress(OSError, ValueError), _process(command, seconds, over) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        reported = list(_until_end(process.stdout))
        if reported[-1:] == [END]:
            return RobotAnswer(
                services=parse_services(reported[:-1]), offset=_compare(process.stdin, process.stdout, clock)
            )
        return RobotAnswer(refused=explain_refusal(process.stderr.read(), seconds))
    return RobotAnswer(refused=explain_refusal("", seconds))


def explain_refusal(reported: str, seconds: float) -> str:
    """Explain what ssh printed instead of an answer, in a few words; an empty output means a timeout."""
    return next((reason for words, reason in _REFUSALS if words in reported), f"no answer in {seconds:g} s")


@contextmanager
def _process(command: list[str], seconds: float, over: threading.Event) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # Ctrl-C is for this process only
    )
    done = threading.Event()

    def guard() -> None:
        step = 0.05
        for _ in range(round(seconds / step)):
            if done.wait(step) or over.is_set():
                break
        process.kill()

    thread = threading.Thread(target=guard, name="ask", daemon=True)
    thread.start()
    try:
        yield process
    finally:
        done.set()
        thread.join()
        process.wait()
        for stream in (process.stdin, process.stdout, process.stderr):
            with suppress(OSError):
                if stream:
                    stream.close()


def _until_end(stream: IO[str]) -> Iterator[str]:
    for line in stream:
        yield line.strip()
        if line.strip() == END:
            return


def _compare(questions: IO[str], answers: IO[str], clock: Callable[[], float]) -> float | None:
    readings = []
    for _ in range(ROUNDS):
        before = clock()
        questions.write("\n")
        questions.flush()
        answer = answers.readline()
        if not answer:
            break
        readings.append((before, float(answer), clock()))
    return best_offset(readings)


def best_offset(readings: Iterable[tuple[float, float, float]]) -> float | None:
    """Return the offset (s) of the remote clock from the quickest (requested, remote time, answered); None if empty."""
    quickest = min(readings, key=lambda each: each[2] - each[0], default=None)
    return None if quickest is None else clock_offset(*quickest)


def parse_services(lines: Iterable[str]) -> tuple[tuple[str, str], ...]:
    """Yield (name, state) of the units in systemctl's list; the state is that of ActiveState."""
    rows = (line.split() for line in lines)
    return tuple(
        (row[0].removeprefix(PREFIX).removesuffix(".service"), "starting" if row[2] == "activating" else row[2])
        for row in rows
        if len(row) >= 4 and row[1] == "loaded"
    )


def clock_offset(before: float, middle: float, after: float) -> float:
    """Return the least offset (s) of a clock that was read between two local readings: 0 if it lies between them."""
    return min(middle - before, 0.0) + max(middle - after, 0.0)
