"""The shell around the supervisor: carries out its actions and feeds it what happens."""

from __future__ import annotations

import os
import select
import signal
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ur.run import host as places
from ur.run.command import Program
from ur.run.console import Console
from ur.run.master import Master
from ur.run.master_watch import watch_master
from ur.run.model import (
    Action,
    AwaitMaster,
    Begin,
    Event,
    Exited,
    Finish,
    Limits,
    MasterAnswered,
    NothingLeft,
    ParametersSet,
    Phase,
    RestartWanted,
    SetParameters,
    SetupFailed,
    Signal,
    Start,
    Started,
    StartFailed,
    StartWanted,
    Status,
    StopRequested,
    StopWanted,
    Sweep,
    TellDeath,
    TellMaster,
    TellPressure,
    TellRevival,
    TellStop,
    TellWish,
    Tick,
    Unregister,
    Unregistered,
)
from ur.run.outputs import Outputs
from ur.run.processes import HostLost, ProcessHost, Suspended, kill_orphans
from ur.run.report import describe_death
from ur.run.supervisor import begin_state, next_deadline, step
from ur.run.terminal import Terminal

if TYPE_CHECKING:
    from ur.run.events import OutputSource, RunCommand, RunStarted, Severity
    from ur.run.readiness import ReadinessProbe
    from ur.run.timings import Timings
    from ur.run.watching import Watching

Job = Callable[[], Event]


@dataclass(frozen=True, slots=True)
class WatchPlan:
    """Who may watch the run, and how it appears to them. `call_started` is called once every node was started.

    `viewer` is our end of a pair whose other end shows the run on our terminal: while it is open the console is silent.
    `events` is an open file that gets every event, in place of the console. `unattended`: nobody sees our console.
    """

    describe: Callable[[], RunStarted] | None = None
    listener: socket.socket | None = None
    viewer: socket.socket | None = None
    events: int | None = None
    unattended: bool = False
    call_started: Callable[[], None] | None = None


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
    master: Master | None = None  # asked which nodes are up, while somebody wants to know
    timings: Timings | None = None  # told once every node is up
    watch: WatchPlan = field(default_factory=lambda: WatchPlan())

    @property
    def terminal_program(self) -> Program | None:
        """The program that owns the keyboard and the screen."""
        return next((each for each in self.programs if each.unit.terminal), None)


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
        self._pids: dict[str, int] = {}
        self._prefixes: dict[str, tuple[str, ...]] = {}
        self._posted: deque[Event] = deque()
        self._exit_code: int | None = None
        self._call_started = run.watch.call_started
        self._poll = select.poll()
        self._outputs = Outputs(
            self._poll,
            run.folder,
            console,
            self._tell_output,
            unattended=run.watch.unattended or run.terminal_program is not None,
        )
        self._watching: Watching | None = None  # made for the first who watches: most runs are never watched
        if run.watch.listener is not None:
            self._poll.register(run.watch.listener, select.POLLIN)
        self._viewer: int | None = None
        self._probe: ReadinessProbe | None = None
        self._watch_over: threading.Event | None = None
        self._timings = run.timings
        self._looked: deque[tuple[str, int, tuple[str, ...]]] = deque()
        self._watched: dict[int, int] = {}
        self._wake, self._wake_end = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._poll.register(self._wake, select.POLLIN)
        self._poll.register(host, select.POLLIN)
        self._handlers: dict[int, object] = {}
        self._old_wake = signal.set_wakeup_fd(self._wake_end, warn_on_full_buffer=False)
        for signum in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            self._handlers[signum] = signal.signal(signum, self._on_signal)

    def run(self) -> int:
        self._welcome()
        self._happen(Begin())
        while self._exit_code is None:
            self._console.flush()
            self._follow_watchers()
            unwritten = self._console.waiting()
            for descriptor in unwritten:
                self._poll.register(descriptor, select.POLLOUT)
            ready = self._poll.poll(self._patience())
            for descriptor in unwritten:
                self._poll.unregister(descriptor)
            for descriptor, _ in ready:
                if descriptor not in unwritten:
                    self._serve(descriptor)
            while self._posted:
                self._happen(self._posted.popleft())
            while self._looked:
                name, pid, missing = self._looked.popleft()
                if self._pids.get(name) == pid:
                    if self._watching is not None:
                        self._watching.note_readiness(name, missing)
                    self._time(name, up=not missing)
            now = time.monotonic()
            deadline = next_deadline(self._state)
            if deadline is not None and now >= deadline:
                self._happen(Tick())
            if self._watching is not None:
                self._watching.work(now)
        return self._exit_code

    def _time(self, name: str, *, up: bool) -> None:
        """Note for `--timings` that a node started or is up; tell once all are."""
        timings = self._timings
        if timings is None:
            return
        from ur.run.timings import describe_timings, read_clock

        (timings.up if up else timings.started).setdefault(name, read_clock())
        if all(
            each.unit.core or each.status is Status.ENDED or each.unit.name in timings.up for each in self._state.units
        ):
            self._timings = None
            self._inform("\n".join(describe_timings(timings.born, timings.steps, timings.started, timings.up)))

    def _serve(self, descriptor: int) -> None:
        if descriptor == self._wake:
            _drain(self._wake)
        elif descriptor == self._host.fileno():
            self._hear(self._host.receive())
        elif descriptor in self._watched or (
            self._run.watch.listener is not None and descriptor == self._run.watch.listener.fileno()
        ):
            self._attend(descriptor)
        else:
            self._outputs.read(descriptor)

    def close(self) -> None:
        """Give back what was taken: signals, the terminal, open files."""
        signal.set_wakeup_fd(self._old_wake)
        for signum, handler in self._handlers.items():
            signal.signal(signum, handler)  # type: ignore[arg-type]  # what signal.signal itself returned
        if self._run.terminal_program is not None and self._run.terminal_program.unit.name in self._pids:
            self._take_terminal_back(reset=True)
        self._console.release()
        self._console.finish(1.0)
        if self._probe is not None:
            self._probe.close()
        if self._watch_over is not None:
            self._watch_over.set()
        if self._watching is not None:
            self._watching.end(1 if self._exit_code is None else self._exit_code)
        elif self._run.watch.listener is not None:
            self._run.watch.listener.close()
        self._outputs.close()
        os.close(self._wake)
        os.close(self._wake_end)

    def _patience(self) -> float | None:
        """Milliseconds until something is due."""
        watching = None if self._watching is None else self._watching.due
        times = [time for time in (next_deadline(self._state), watching) if time is not None]
        deadline = min(times, default=None)
        return None if deadline is None else max(0.0, deadline - time.monotonic()) * 1000 + 1

    def _on_signal(self, signum: int, _frame: object) -> None:
        # roslaunch exits with 0 after Ctrl-C; a program that owns the terminal has not done what it was asked to.
        code = 0 if self._run.terminal_program is None else 128 + signum
        self._posted.append(StopRequested(signal.Signals(signum).name, code))

    def _happen(self, event: Event) -> None:
        if self._timings is not None and isinstance(event, (MasterAnswered, ParametersSet)):
            self._timings.mark("master" if isinstance(event, MasterAnswered) else "parameters")
        now = time.monotonic()
        self._state, actions = step(self._state, event, now)
        if self._watching is not None:
            self._watching.note_state(self._state, now)
        self._follow_readiness()
        for action in actions:
            self._act(action)
        if self._watch_over is None and self._state.phase is Phase.RUNNING:
            self._watch_over = self._watch_master()
        if self._call_started is not None and self._is_started():
            self._call_started()
            self._call_started = None

    def _watch_master(self) -> threading.Event:
        over = threading.Event()
        master = self._run.master
        if master is not None and not self._run.own_master:

            def tell(event: Event) -> None:
                self._posted.append(event)
                self._wake_up()

            threading.Thread(target=watch_master, args=(master, tell, over), daemon=True).start()
        return over

    def _is_started(self) -> bool:
        return self._state.phase is Phase.RUNNING and not any(
            each.status is Status.STARTING for each in self._state.units
        )

    def _welcome(self) -> None:
        """Let those watch who are there from the beginning."""
        watch = self._run.watch
        if watch.events is None and watch.viewer is None:
            return
        from ur.run.events import Watch

        watching = self._open_watching()
        if watch.events is not None:
            self._console.silent = True
            watching.watchers.add_output(watch.events, Watch(output=True, stats=False, readiness=True))
        if watch.viewer is not None:
            self._console.silent = True
            self._viewer = watching.watchers.add_socket(watch.viewer)
            if self._terminal is not None:
                self._terminal.mark_lent()  # the viewer is the foreground group, for Ctrl-C in its pager
        watching.follow_wishes(time.monotonic())

    def _open_watching(self) -> Watching:
        """What watchers are told, from now on."""
        if self._watching is None:
            from ur.run.events import RunStarted
            from ur.run.watching import NodeFacts, Watching

            watch = self._run.watch
            if watch.listener is not None:
                self._poll.unregister(watch.listener)
            self._watching = Watching(
                watch.describe() if watch.describe is not None else RunStarted("", 0, "", "", "", 0.0),
                watch.listener,
                {
                    each.unit.name: NodeFacts(
                        self._outputs.find_path(each), each.executable or each.argv[0], each.cwd or self._run.home
                    )
                    for each in self._run.programs
                },
                lambda anew: self._outputs.skip_back() if anew else self._outputs.read_back(),
                self._state,
                time.monotonic(),
            )
            self._watching.watchers.call_gone = self._forget_watcher
        return self._watching

    def _tell_output(self, name: str, source: OutputSource, text: str) -> None:
        if self._watching is not None:
            self._watching.tell_output(name, source, text)

    def _follow_watchers(self) -> None:
        """Poll for what watchers may do next."""
        if self._watching is None:
            return
        self._watching.watchers.flush()
        wanted = self._watching.watchers.descriptors()
        if wanted == self._watched:
            return
        for descriptor in self._watched.keys() - wanted.keys():
            self._poll.unregister(descriptor)
        for descriptor, events in wanted.items():
            self._poll.register(descriptor, events)
        self._watched = wanted

    def _forget_watcher(self, descriptor: int) -> None:
        if self._watched.pop(descriptor, None) is not None:
            self._poll.unregister(descriptor)

    def _attend(self, descriptor: int) -> None:
        watching = self._open_watching()
        for command in watching.attend(descriptor, time.monotonic()):
            self._obey(command)
        self._follow_readiness()
        if self._viewer is not None and not watching.watchers.watching(self._viewer):
            self._viewer = None
            self._console.silent = False
            if self._terminal is not None:
                self._terminal.take_back(reset=True)

    def _follow_readiness(self) -> None:
        """Look which nodes are up while somebody wants to know."""
        watched = self._watching is not None and self._watching.wants_readiness
        wanted = (watched or self._timings is not None) and self._state.phase is Phase.RUNNING
        if self._probe is None and wanted and self._run.master is not None:
            from ur.run.readiness import ReadinessProbe  # only for those who wait

            conditions = {program.unit.name: program.ready for program in self._run.programs}
            self._probe = ReadinessProbe(self._run.master, conditions, self._hear_readiness)
        if self._probe is not None and not wanted:
            self._probe.close()
            self._probe = None
        if self._probe is not None:
            self._probe.follow(
                {
                    each.unit.name: each.pid
                    for each in self._state.units
                    if each.pid is not None and not each.unit.core and each.wish is None
                }
            )

    def _hear_readiness(self, name: str, pid: int, missing: tuple[str, ...]) -> None:
        self._looked.append((name, pid, missing))
        self._wake_up()

    def _wake_up(self) -> None:
        try:
            os.write(self._wake_end, b"\0")
        except OSError:  # full: it wakes up anyway; closed: nobody waits any more
            return

    def _obey(self, command: RunCommand) -> None:
        from ur.run.events import KillNode, RestartNode, StartNode, StopNode, StopRun

        match command:
            case StartNode(name):
                self._happen(StartWanted(name))
            case StopNode(name):
                self._happen(StopWanted(name))
            case KillNode(name):
                self._happen(StopWanted(name, kill=True))
            case RestartNode(name, prefix):
                self._prefixes[name] = prefix  # for its next start only
                self._happen(RestartWanted(name))
            case StopRun(reason):
                self._happen(StopRequested(reason))

    def _hear(self, event: Event | Suspended) -> None:
        if isinstance(event, Suspended):
            self._suspend(event.name)
            return
        if isinstance(event, Started):
            self._pids[event.name] = event.pid
            if not self._programs[event.name].unit.core:
                self._time(event.name, up=False)
            unit = self._programs[event.name].unit
            if not unit.terminal and not unit.core:
                self._inform(f"[{event.name}] started, process {event.pid}")
        elif isinstance(event, (Exited, StartFailed)):
            self._pids.pop(event.name, None)
            self._outputs.drain(event.name)
            if self._programs[event.name].unit.terminal:
                killed = isinstance(event, Exited) and event.status.signal is not None
                self._take_terminal_back(reset=killed)
        elif isinstance(event, NothingLeft):
            self._outputs.drain_all()
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
            case Finish(exit_code):
                self._exit_code = exit_code
            case _:
                self._tell(action)

    def _tell(self, action: Action) -> None:
        match action:
            case TellDeath(name):
                self._tell_death(action)
            case TellPressure(names, signum):
                self._warn(f"{', '.join(names)} did not stop: {signal.Signals(signum).name}")
            case TellWish(name, refused):
                self._warn(f"{name}: {refused}") if refused else self._inform(f"{name} is stopped, as asked")
            case TellMaster(lost):
                self._tell_master(lost)
            case TellRevival():
                self._warn("another master answers: parameters are set again, and every node is restarted")
            case TellStop(cause, failed):
                if failed:
                    self._warn(f"error: {cause}")
                else:
                    self._inform(f"stopping: {cause}")

    def _tell_master(self, lost: bool) -> None:
        uri = self._run.master.uri if self._run.master is not None else ""
        if lost:
            self._warn(f"error: the master at {uri} does not answer any more; nodes go on, new connections wait for it")
        else:
            self._warn(f"the master at {uri} answers again")

    def _inform(self, text: str) -> None:
        self._console.inform(text)
        if self._watching is not None:
            self._watching.tell_notice("info", text)

    def _warn(self, text: str) -> None:
        for line in text.split("\n"):
            self._console.warn(line)
        severity: Severity = "error" if text.startswith("error: ") else "warning"
        if self._watching is not None:
            self._watching.tell_notice(severity, text.removeprefix("error: "))

    def _do_aside(self, job: Job) -> None:
        def work() -> None:
            event = job()
            self._posted.append(event)
            self._wake_up()

        threading.Thread(target=work, daemon=True).start()

    def _start(self, program: Program) -> None:
        unit = program.unit
        self._outputs.open(program)
        prefix = self._prefixes.pop(unit.name, ())
        words = program.with_prefix(prefix) if prefix else program.argv
        argv = [*words, f"__log:={self._run.folder}/{program.log_name}.log"]
        stdio, given, place = (0, 1, 2), list[int](), places.SESSION
        if unit.terminal:
            place = self._lend_terminal()
        else:
            stdio, given = self._outputs.wire(program)
        cwd = program.cwd or self._run.home
        self._host.start_process(unit.name, argv, cwd, dict(program.changes), stdio, place)
        for descriptor in given:
            os.close(descriptor)

    def _tell_death(self, death: TellDeath) -> None:
        if death.status.clean:
            self._inform(describe_death(death, (), None)[0])
            return
        program = self._programs[death.name]
        lines: tuple[str, ...] | None = self._outputs.find_last_lines(death.name)
        log: str | None = self._outputs.find_path(program)
        if program.unit.terminal:
            own = f"{self._run.folder}/{program.log_name}.log"  # what it printed was on the screen
            lines = None
            log = own if os.path.exists(own) else None  # noqa: PTH110 - pathlib is not worth its import here
        self._warn("\n".join(describe_death(death, lines, log)))

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


def _drain(descriptor: int) -> None:
    try:
        while os.read(descriptor, 4096):
            pass
    except BlockingIOError:
        return


__all__ = ["Job", "Run", "WatchPlan", "SetupFailed", "Unregistered", "run_loop"]
