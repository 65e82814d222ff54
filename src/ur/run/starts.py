"""Starts of processes, sent to the host in bursts."""

from __future__ import annotations

import os
import resource
from typing import NamedTuple

from ur.run.foreground import Foreground
from ur.run.host.protocol import GROUP, SESSION
from ur.run.output.router import NodeOutputs
from ur.run.process.command import UnitProgram
from ur.run.process.host_client import ProcessHost
from ur.run.run import Run

MOST_STARTS = 100  # processes whose files are open at once before they are sent
FILES_KEPT = 3  # of a process: its log, and one end each of standard output and error
FILES_SENT = 2  # the other ends


class _Start(NamedTuple):
    program: UnitProgram
    argv: list[str]
    stdio: tuple[int, int, int]
    given: list[int]
    session_mode: str


class Starts:
    """Starts of the processes of a run.

    All of a burst is prepared before any of it is sent: started nodes take processor time from the preparation of later
    ones.
    """

    def __init__(self, run: Run, host: ProcessHost, outputs: NodeOutputs, foreground: Foreground) -> None:
        """Create the starts, and raise this process's limit of open files for the programs of the run."""
        self._run = run
        self._host = host
        self._outputs = outputs
        self._foreground = foreground
        self._prepared: list[_Start] = []
        allow_open_files(100 + FILES_KEPT * len(run.programs) + FILES_SENT * MOST_STARTS)

    def prepare(self, program: UnitProgram) -> None:
        """Open the files of a process, and send the burst if it is complete."""
        unit = program.unit
        self._outputs.open(program)
        argv = [*program.argv, *([f"__log:={self._run.folder}/{program.log_name}.log"] if program.names_log else [])]
        if unit.terminal:
            self._prepared.append(_Start(program, argv, (0, 1, 2), [], self._foreground.lend()))
        else:
            alone = unit.core or self._run.terminal_program is not None
            stdio, given = self._outputs.wire(program)
            self._prepared.append(_Start(program, argv, stdio, given, SESSION if alone else GROUP))
        if len(self._prepared) >= MOST_STARTS:
            self.send()

    def send(self) -> None:
        """Send the prepared starts to the host."""
        for each in self._prepared:
            program = each.program
            cwd = program.cwd or self._run.home
            self._host.start_process(
                program.unit.name, each.argv, cwd, dict(program.changes), each.stdio, each.session_mode
            )
            for descriptor in each.given:
                os.close(descriptor)
        self._prepared.clear()


def allow_open_files(count: int) -> None:
    """Raise this process's own limit of open files if it is lower; nodes are not its children and keep theirs."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft != resource.RLIM_INFINITY and soft < count:
        most = count if hard == resource.RLIM_INFINITY else min(count, hard)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))
