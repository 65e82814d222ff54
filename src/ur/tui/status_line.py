"""The status of a run in one line, below warnings and errors: for small terminals and `--calm`."""

import os
import select
import shutil
import signal
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ur.run.clients.client import RunControl
from ur.run.clients.protocol import Notice, OutputLine, RunEvent, RunStarted, StopRun, Watch
from ur.run.clients.run_state import STANDING, Mood, RunState, apply_events, begin_state
from ur.run.supervisor.events import CTRL_C
from ur.source.ansi import BOLD, CLEAR_LINE, DIM, GREEN, RED, YELLOW, paint, strip_styles

SIGNS: dict[Mood, tuple[str, str]] = {
    "up": (GREEN, "up"),
    "busy": (YELLOW, "starting"),
    "failed": (RED, "failed"),
    "idle": (DIM, "off"),
}
WATCH = Watch(output=True, stats=False, readiness=True)


@dataclass(frozen=True, slots=True)
class StatusText:
    """Text to write: permanent lines, and the line that the next text replaces."""

    lines: tuple[str, ...]
    status: str


def show_events(state: RunState, received: list[RunEvent], width: int) -> tuple[RunState, StatusText]:
    """Return the state after these events, and their text for the user: notices, warnings and errors."""
    from ur.tui.journal import clean

    state = apply_events(state, received)
    lines = []
    for event in received:
        if isinstance(event, OutputLine) and event.severity in ("warning", "error", "fatal"):
            colour = YELLOW if event.severity == "warning" else RED
            lines.append(paint(f"[{event.name}] {strip_styles(clean(event.text))}", colour))
        elif isinstance(event, Notice) and event.severity in ("warning", "error", "fatal"):
            lines += [paint(clean(line), RED) for line in event.text.split("\n")]
    return state, StatusText(tuple(lines[-200:]), describe_status(state, width))


def describe_status(state: RunState, width: int) -> str:
    """Return the status in at most `width` - 1 cells: counts of nodes, then the first one that is not ready."""
    counts = state.count()
    parts = [(f"{counts[mood]} {SIGNS[mood][1]}", SIGNS[mood][0]) for mood in STANDING if counts[mood]]
    if state.cause is not None:
        parts.insert(0, ("stopping", YELLOW))
    elif state.link:
        parts.insert(0, (state.link, RED))
    wrong = next((row for mood in ("failed", "busy") for row in state.rows if row.mood == mood), None)
    if wrong is not None and state.cause is None:
        parts.append((f"{wrong.name.lstrip('/')}: {wrong.word}", DIM))
    left = width - 1
    pieces: list[str] = []
    for text, colour in [(state.run.title, BOLD), *parts]:
        room = left - (2 if pieces else 0)
        if room < 4:
            break
        cut = text if len(text) <= room else text[: room - 1] + "…"
        pieces.append(paint(cut, colour))
        left = room - len(cut)
    return "  ".join(pieces)


def show_status_line(
    control: RunControl,
    write: Callable[[str], object] = sys.stdout.write,
    *,
    guest: bool = False,
    early: Sequence[RunEvent] = (),
) -> tuple[str, int]:
    """Show a run until it ends; return `ended`, `killed` (its supervisor was) or `detached`, and its exit code.

    Ctrl-C leaves a run that is detached or of which this process is a `guest`, and stops any other; repeated, it is
    faster. `early` are the events so far, which were already printed. Handles SIGINT meanwhile.
    """
    if os.environ.get("NO_COLOR"):
        write = _without_colours(write)
    state = begin_state()
    asked = [0]
    reader, writer = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)

    def on_interrupt(*_: object) -> None:
        asked[0] += 1
        os.write(writer, b"\0")

    before = signal.signal(signal.SIGINT, on_interrupt)
    answered = 0
    control.send(WATCH)
    began = next((place for place, event in enumerate(early) if isinstance(event, RunStarted)), 0)
    state, shown = show_events(state, list(early[began:]), shutil.get_terminal_size().columns)
    write("".join(f"{line}\r\n" for line in shown.lines) + shown.status)
    try:
        while True:
            ready, _, _ = select.select([control.fileno(), reader], [], [])
            if reader in ready:
                os.read(reader, 64)
            while answered < asked[0]:
                answered += 1
                if guest or state.run.detached:
                    return "detached", 0
                control.send(StopRun(CTRL_C))
            received = control.receive() if control.fileno() in ready else []
            if received is None:
                return ("killed", 1) if state.exit_code is None else ("ended", state.exit_code)
            state, shown = show_events(state, received, shutil.get_terminal_size().columns)
            write(CLEAR_LINE + "".join(f"{line}\r\n" for line in shown.lines) + shown.status)
            sys.stdout.flush()
            if state.exit_code is not None:
                return "ended", state.exit_code
            time.sleep(0.1)  # s in which events are shown together
    finally:
        signal.signal(signal.SIGINT, before)
        os.close(reader)
        os.close(writer)
        write(CLEAR_LINE)
        sys.stdout.flush()


def _without_colours(write: Callable[[str], object]) -> Callable[[str], object]:
    return lambda text: write(strip_styles(text))
