"""Messages of a run for the user, as text. Pure."""

from __future__ import annotations

import signal
from collections.abc import Sequence

from ur.run.supervisor.actions import ReportDeath
from ur.run.supervisor.advice import Crash, advise
from ur.run.supervisor.state import ExitStatus


def describe_status(status: ExitStatus) -> str:
    """Describe the end of a process: `exit code 3`, `signal SIGSEGV (segmentation fault)`."""
    if status.signal is not None:
        try:
            known = signal.Signals(status.signal)
        except ValueError:
            return f"signal {status.signal}"
        meaning = signal.strsignal(known)
        return f"signal {known.name}" + (f" ({meaning.lower()})" if meaning else "")
    return "not started" if status.code is None else f"exit code {status.code}"


def describe_death(death: ReportDeath, lines: Sequence[str] | None, log: str | None, fault: str = "") -> list[str]:
    """Describe the end of a unit: its status, its last lines (None: already on the screen), and its log file.

    `fault` is what the unit's file shows of the reason, as in `Crash`.
    """
    follow = ""
    if death.restart_in is not None:
        follow = f", starts again in {death.restart_in:.3g} s" if death.restart_in > 0 else ", starts again"
    elif death.deaths:
        follow = f", {death.deaths} times in a row soon after its start: it is not started again"
    elif death.ends_run:
        follow = ", which ends the run"
    if death.evicted_by:
        return [f"{death.name} was ended by {death.evicted_by}, which started another node of this name{follow}"]
    if death.status.clean:
        return [f"{death.name} has finished{follow}"]
    if death.reason is not None:
        advice = advise(Crash(death.name, death.status, (), death.reason, fault))
        reported = [f"{death.name} could not be started: {death.reason}{follow}"]
        return [*reported, f"  try: {advice}"] if advice else reported
    reported = [f"{death.name} died: {describe_status(death.status)}{follow}"]
    reported += [f"  | {line}" for line in lines or ()]
    if log is not None:
        reported.append(f"  log: {log}" if lines or lines is None else f"  log: {log} (it printed nothing)")
    advice = _advise(death, lines or (), fault)
    return [*reported, f"  try: {advice}"] if advice else reported


def describe_link(robot: str, seconds: float, *, lost: bool) -> str:
    """Describe the link to a robot: `no word from bob for 1.2 s`, `bob answers again after 12.3 s`."""
    return f"no word from {robot} for {seconds:.1f} s" if lost else f"{robot} answers again after {seconds:.1f} s"


class LossLines:
    """Selects the reports of a lost link that become separate lines: the first, then each after twice the time."""

    def __init__(self) -> None:
        self._next = 0.0

    def is_due(self, seconds: float, *, lost: bool) -> bool:
        """Return whether this change of the connection is to be printed."""
        if not lost:
            self._next = 0.0
            return True
        due = seconds >= self._next
        if due:
            self._next = 2.0 * seconds
        return due


def _advise(death: ReportDeath, lines: Sequence[str], fault: str) -> str:
    again = f"'ur restart {death.name}' starts it once more"
    if death.deaths and death.status.code == 2:
        return f"exit code 2 is about what it was given: correct that, then 'ur restart {death.name}'"
    return advise(Crash(death.name, death.status, lines, fault=fault)) or (again if death.deaths else "")
