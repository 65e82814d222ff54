"""The shell around the supervisor: carries out its actions and feeds it what happens."""

from __future__ import annotations

import os
import select
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from ur.run import host as places
from ur.run.command import Program
from ur.run.console import Console
from ur.run.model import (
    Action,
    AwaitMaster,
    Begin,
    Event,
    Exited,
    Finish,
    Limits,
    NothingLeft,
    SetParameters,
    SetupFailed,
    Signal,
    Start,
    Started,
    StartFailed,
    StopRequested,
    Sweep,
    TellDeath,
    TellPressure,
    TellStop,
    Tick,
    Unregister,
    Unregistered,
)
from ur.run.output import KEPT_LINES, Stream, read_last_lines
from ur.run.processes import HostLost, ProcessHost, Suspended, kill_orphans
from ur.run.report import describe_death
from ur.run.supervisor import begin_state, next_deadline, step
from ur.run.terminal import Terminal

Job = Callable[[], Event]


@dataclass(frozen=True, slots=True)
class Run:
    """What to run. `folder` takes the log files, `home` is where nodes start.

    `await_master`, `set_parameters` and `unregister` talk to the master and return the event that follows; they are
    called in a thread of their own, so that a slow network holds nothing up.
    """

    programs: tuple[Program, ...]
    folder: str
    home: str
    own_master: bool
    await_master: Job
    set_parameters: Job
    unregister: Job
    limits: Limits = field(default_factory=Limits)

    @property
    def terminal_program(self) -> Program | None:
        """The program that owns the keyboard and the screen."""
        return next((each for each in self.programs if each.unit.terminal), None)


@dataclass(slots=True)
class _Outputs:
    log_path: str
    log: int
    streams: list[Stream]
    recent: deque[str]


def run_loop(run: Run, host: ProcessHost, console: Console, terminal: Terminal | None) -> int:
    """Run to the end and return the exit code. Nothing is left behind, however it ends.

    Takes over SIGINT, SIGTERM and SIGHUP, which ask for the end, for as long as it runs.
    """
    loop = _Loop(run, host, console, terminal)
    try:
        return loop.run()
    except HostLost:
        kill_orphans()
        console.release()
        console.warn("error: the process host was killed; every node has been ended with it")
        console.finish(1.0)
        return 1
    finally:
        host.close()
        loop.close()


class _Loop:
    def __init__(self, run: Run, host: ProcessHost, console: Console, terminal: Terminal | None) -> None:
        self._run = run
        self._host = host
        self._console = console
        self._terminal = terminal
        self._programs = {program.unit.name: program for program in run.programs}
        self._state = begin_state(
            (program.unit for program in run.programs), own_master=run.own_master, limits=run.limits
        )
        self._outputs: dict[str, _Outputs] = {}
        self._streams: dict[int, Stream] = {}
        self._pids: dict[str, int] = {}
        self._posted: deque[Event] = deque()
        self._exit_code: int | None = None
        self._poll = select.poll()
        self._wake, self._wake_end = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._poll.register(self._wake, select.POLLIN)
        self._poll.register(host, select.POLLIN)
        self._handlers: dict[int, object] = {}
        self._old_wake = signal.set_wakeup_fd(self._wake_end, warn_on_full_buffer=False)
        for signum in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            self._handlers[signum] = signal.signal(signum, self._on_signal)

    def run(self) -> int:
        self._happen(Begin())
        while self._exit_code is None:
            self._console.flush()
            unwritten = self._console.waiting()
            for descriptor in unwritten:
                self._poll.register(descriptor, select.POLLOUT)
            ready = self._poll.poll(self._patience())
            for descriptor in unwritten:
                self._poll.unregister(descriptor)
            for descriptor, _ in ready:
                if descriptor in unwritten:
                    continue
                if descriptor == self._wake:
                    _drain(self._wake)
                elif descriptor == self._host.fileno():
                    self._hear(self._host.receive())
                else:
                    self._read(self._streams.get(descriptor))
            while self._posted:
                self._happen(self._posted.popleft())
            deadline = next_deadline(self._state)
            if deadline is not None and time.monotonic() >= deadline:
                self._happen(Tick())
        return self._exit_code

    def close(self) -> None:
        """Give back what was taken: signals, the terminal, open files."""
        signal.set_wakeup_fd(self._old_wake)
        for signum, handler in self._handlers.items():
            signal.signal(signum, handler)  # type: ignore[arg-type]  # what signal.signal itself returned
        if self._run.terminal_program is not None and self._run.terminal_program.unit.name in self._pids:
            self._take_terminal_back(reset=True)
        self._console.release()
        self._console.finish(1.0)
        for outputs in self._outputs.values():
            self._close_outputs(outputs)
        os.close(self._wake)
        os.close(self._wake_end)

    def _patience(self) -> float | None:
        """Milliseconds until something is due."""
        deadline = next_deadline(self._state)
        return None if deadline is None else max(0.0, deadline - time.monotonic()) * 1000 + 1

    def _on_signal(self, signum: int, _frame: object) -> None:
        # roslaunch exits with 0 after Ctrl-C; a program that owns the terminal has not done what it was asked to.
        code = 0 if self._run.terminal_program is None else 128 + signum
        self._posted.append(StopRequested(signal.Signals(signum).name, code))

    def _happen(self, event: Event) -> None:
        self._state, actions = step(self._state, event, time.monotonic())
        for action in actions:
            self._act(action)

    def _hear(self, event: Event | Suspended) -> None:
        if isinstance(event, Suspended):
            self._suspend(event.name)
            return
        if isinstance(event, Started):
            self._pids[event.name] = event.pid
            unit = self._programs[event.name].unit
            if not unit.terminal and not unit.core:
                self._console.inform(f"[{event.name}] started, process {event.pid}")
        elif isinstance(event, (Exited, StartFailed)):
            self._pids.pop(event.name, None)
            self._drain_outputs(event.name)
            if self._programs[event.name].unit.terminal:
                killed = isinstance(event, Exited) and event.status.signal is not None
                self._take_terminal_back(reset=killed)
        elif isinstance(event, NothingLeft):
            for name in list(self._outputs):
                self._drain_outputs(name)
        self._happen(event)

    def _act(self, action: Action) -> None:
        match action:
            case Start(name):
                self._start(self._programs[name])
            case Signal(name, signum):
                self._host.signal_process(name, signum)
            case Sweep(signum):
                self._host.sweep(signum)
            case AwaitMaster():
                self._do_aside(self._run.await_master)
            case SetParameters():
                self._do_aside(self._run.set_parameters)
            case Unregister():
                self._do_aside(self._run.unregister)
            case TellDeath(name):
                self._tell_death(action)
            case TellPressure(names, signum):
                self._console.warn(f"{', '.join(names)} did not stop: {signal.Signals(signum).name}")
            case TellStop(cause, failed):
                if failed:
                    self._console.warn(f"error: {cause}")
                else:
                    self._console.inform(f"stopping: {cause}")
            case Finish(exit_code):
                self._exit_code = exit_code

    def _do_aside(self, job: Job) -> None:
        def work() -> None:
            event = job()
            self._posted.append(event)
            try:
                os.write(self._wake_end, b"\0")
            except OSError:  # full: it wakes up anyway; closed: nobody waits any more
                return

        threading.Thread(target=work, daemon=True).start()

    def _start(self, program: Program) -> None:
        unit = program.unit
        outputs = self._outputs.get(unit.name)
        if outputs is not None:
            self._close_outputs(outputs)
        log_path = f"{self._run.folder}/{program.log_name}-stdout.log"
        log = _open_log(log_path, fresh=outputs is None)
        outputs = _Outputs(log_path, log, [], outputs.recent if outputs else deque(maxlen=KEPT_LINES))
        self._outputs[unit.name] = outputs
        argv = [*program.argv, f"__log:={self._run.folder}/{program.log_name}.log"]
        stdio, given, place = (0, 1, 2), list[int](), places.SESSION
        if unit.terminal:
            place = self._lend_terminal()
        else:
            stdio, given = self._wire(program, outputs)
        cwd = program.cwd or self._run.home
        self._host.start_process(unit.name, argv, cwd, dict(program.changes), stdio, place)
        for descriptor in given:
            os.close(descriptor)

    def _wire(self, program: Program, outputs: _Outputs) -> tuple[tuple[int, int, int], list[int]]:
        """Where a node's output goes. Returns its stdio, and which of these to close once it is started."""
        null = os.open(os.devnull, os.O_RDONLY | os.O_CLOEXEC)
        if program.unit.core or self._run.terminal_program is not None:
            return (null, outputs.log, outputs.log), [null]
        given = [null]
        ends = []
        wishes = (
            (program.screen, self._console.is_terminal, self._console.show),
            (True, False, self._console.show_error),
        )
        for wanted, as_terminal, show in wishes:
            if not wanted:
                ends.append(outputs.log)
                continue
            reader, writer = _open_pseudo_terminal() if as_terminal else os.pipe2(os.O_CLOEXEC)
            stream = Stream(program.unit.name, reader, outputs.log, show)
            outputs.streams.append(stream)
            self._streams[reader] = stream
            self._poll.register(reader, select.POLLIN)
            given.append(writer)
            ends.append(writer)
        return (null, ends[0], ends[1]), given

    def _read(self, stream: Stream | None) -> bool:
        if stream is None:
            return False
        outputs = self._outputs[stream.name]
        more = stream.read(outputs.recent)
        if not more:
            self._close_stream(stream)
            outputs.streams.remove(stream)
        return more

    def _drain_outputs(self, name: str) -> None:
        outputs = self._outputs.get(name)
        for stream in list(outputs.streams) if outputs else ():
            limit = 64  # a child that goes on printing must not keep us here
            while limit and select.select([stream.descriptor], [], [], 0)[0] and self._read(stream):
                limit -= 1

    def _close_stream(self, stream: Stream) -> None:
        self._poll.unregister(stream.descriptor)
        self._streams.pop(stream.descriptor, None)
        stream.close()

    def _close_outputs(self, outputs: _Outputs) -> None:
        for stream in outputs.streams:
            self._close_stream(stream)
        outputs.streams.clear()
        os.close(outputs.log)

    def _tell_death(self, death: TellDeath) -> None:
        if death.status.clean:
            self._console.inform(describe_death(death, (), None)[0])
            return
        outputs = self._outputs.get(death.name)
        program = self._programs[death.name]
        lines: Iterable[str] | None = ()
        log = outputs.log_path if outputs else None
        if program.unit.terminal:
            own = f"{self._run.folder}/{program.log_name}.log"  # what it printed was on the screen
            lines = None
            log = own if os.path.exists(own) else None  # noqa: PTH110 - pathlib is not worth its import here
        elif outputs is not None:
            lines = outputs.recent or read_last_lines(outputs.log_path)
        for line in describe_death(death, None if lines is None else tuple(lines), log):
            self._console.warn(line)

    def _lend_terminal(self) -> str:
        self._console.hold()
        if self._terminal is None:
            return places.GROUP
        if not self._terminal.in_foreground():
            return places.GROUP
        self._terminal.mark_lent()
        return places.FOREGROUND

    def _take_terminal_back(self, *, reset: bool) -> None:
        if self._terminal is not None:
            self._terminal.take_back(reset=reset)
        self._console.release()

    def _suspend(self, name: str) -> None:
        if self._terminal is None or not self._programs[name].unit.terminal:
            return
        self._terminal.take_back(reset=False)
        self._terminal.wait_suspended()
        if self._terminal.in_foreground() and name in self._pids:
            self._terminal.lend(self._pids[name])
        self._host.signal_process(name, signal.SIGCONT)


def _open_log(path: str, *, fresh: bool) -> int:
    flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC | (os.O_TRUNC if fresh else 0)
    try:
        return os.open(path, flags, 0o644)
    except OSError:
        return os.open(os.devnull, os.O_WRONLY | os.O_CLOEXEC)


def _open_pseudo_terminal() -> tuple[int, int]:
    # Programs print line by line to a terminal; through a pipe their output would come in late blocks.
    import termios

    reader, writer = os.openpty()
    attributes = termios.tcgetattr(writer)
    attributes[1] &= ~termios.OPOST  # no carriage returns
    attributes[3] &= ~termios.ECHO
    termios.tcsetattr(writer, termios.TCSANOW, attributes)
    return reader, writer


def _drain(descriptor: int) -> None:
    try:
        while os.read(descriptor, 4096):
            pass
    except BlockingIOError:
        return


__all__ = ["Job", "Run", "SetupFailed", "Unregistered", "run_loop"]
