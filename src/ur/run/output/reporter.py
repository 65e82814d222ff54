"""Reports of a run, as text on the console and as events to its clients."""

from __future__ import annotations

import os
import signal
from collections import deque
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from ur.run.output.messages import LossLines, describe_death, describe_link
from ur.run.supervisor.actions import (
    Action,
    ReportDeath,
    ReportLink,
    ReportMaster,
    ReportPlanned,
    ReportPressure,
    ReportRequest,
    ReportRevival,
    ReportStop,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ur.run.clients.monitor import Monitor
    from ur.run.output.console import Console
    from ur.run.output.router import NodeOutputs
    from ur.run.process.command import UnitProgram
    from ur.run.run import Run

KEPT_LINES = 30
NOT_RUN = (126, 127)  # exit codes of a shell for a command that it could not run


class RunReporter:
    """Formats reports of the supervisor as lines."""

    def __init__(self, run: Run, console: Console, outputs: NodeOutputs, monitor: Monitor) -> None:
        self._folder = run.folder
        self._master = "" if run.middleware is None else run.middleware.address
        self._robot = (urlsplit(self._master).hostname or "").removesuffix(".local")
        self._loss_lines = LossLines()
        self._programs = {program.unit.name: program for program in run.programs}
        self._list_joined, self._record_end = run.list_joined, run.clients.record_end
        self._report_event = run.clients.report_event
        self._shared = run.restart_share is not None
        self._console = console
        self._outputs = outputs
        self._monitor = monitor
        self.last_lines: deque[str] = deque(maxlen=KEPT_LINES)

    def report_joined(self) -> None:
        """Warn about the runs that end with this one."""
        if self._list_joined is not None and (runs := self._list_joined()):
            from ur.run.join.owner import describe_joined  # for few runs, and it takes time

            self.warn(describe_joined(runs))

    def record_end(self, exit_code: int | None, cause: str) -> None:
        """Record the end of the run, with its last lines and the logs of its nodes."""
        if self._record_end is not None:
            programs = self._programs.values()
            logs = {each.unit.name: self._outputs.find_path(each) for each in programs if not each.unit.terminal}
            self._record_end(1 if exit_code is None else exit_code, cause, tuple(self.last_lines), logs)

    def inform(self, text: str) -> None:
        """Report information."""
        self.last_lines.append(text)
        self._console.inform(text)
        self._monitor.publish_notice("info", text)

    def warn(self, text: str) -> None:
        """Report a warning."""
        self._warn_lines(text.split("\n"))
        self._monitor.publish_notice("warning", text)

    def fail(self, text: str) -> None:
        """Report an error, given without `error: `; the lines after the first explain it."""
        first, *rest = text.split("\n")
        self.last_lines.append(f"error: {first}")
        self._console.fail(first)
        self._warn_lines(rest)
        self._monitor.publish_notice("error", text)

    def _warn_lines(self, lines: Sequence[str]) -> None:
        for line in lines:
            self.last_lines.append(line)
            self._console.warn(line)

    def report(self, action: Action) -> None:
        """Report an action of the supervisor that is a report; ignore every other action."""
        match action:
            case ReportDeath():
                self._report_death(action)
            case ReportPressure(names, signum):
                self.warn(f"{', '.join(names)} did not stop: {signal.Signals(signum).name}")
            case ReportRequest(name, refused):
                self.warn(f"{name}: {refused}") if refused else self.inform(f"{name} is stopped, as asked")
            case ReportMaster(lost=True):
                what = "does not answer any more; nodes go on, new connections wait for it"
                self.fail(f"the master at {self._master} {what}")
            case ReportMaster():
                self.warn(f"the master at {self._master} answers again")
            case ReportLink(lost, seconds):
                if self._loss_lines.is_due(seconds, lost=lost):
                    self.warn(describe_link(self._robot, seconds, lost=lost))
                self._monitor.publish_link(self._robot, seconds, lost=lost)
            case ReportRevival() if self._shared:
                self.warn(f"{self._robot} has another master, or none: its nodes are started again, then those here")
            case ReportRevival():
                self.warn("another master answers: parameters are set again, and every node is restarted")
            case ReportPlanned(text):
                self.inform(text)
            case ReportStop(cause, failed):
                self.fail(cause) if failed else self.inform(f"stopping: {cause}")

    def _report_death(self, death: ReportDeath) -> None:
        if death.status.clean and not death.evicted_by:
            self.inform(describe_death(death, (), None)[0])
            return
        program = self._programs[death.name]
        fault = ""
        if death.reason or death.status.code in NOT_RUN:
            path = dict(program.changes).get("PATH", os.environ.get("PATH"))
            from ur.source.script import explain_script  # only once a node has died

            fault = explain_script(program.executable, path)
        if program.unit.terminal:  # what it printed was on the screen
            lines = describe_death(death, None, self._find_own_log(program), fault)
        else:
            last = self._outputs.find_last_lines(death.name)
            lines = describe_death(death, last, self._outputs.find_path(program), fault)
        self.fail("\n".join(lines))
        if self._report_event is not None:
            self._report_event(lines[0])

    def _find_own_log(self, program: UnitProgram) -> str | None:
        path = f"{self._folder}/{program.log_name}.log"
        return path if os.path.exists(path) else None  # noqa: PTH110 - pathlib is not worth its import here
