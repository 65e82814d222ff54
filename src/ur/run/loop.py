"""The shell around the supervisor: executes its actions and passes events to it."""

import os
import resource
import select
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

from ur.run.clients.monitor import Monitor
from ur.run.host.protocol import FOREGROUND, GROUP, SESSION
from ur.run.output.console import Console
from ur.run.output.log_rotation import LogRotation
from ur.run.output.reporter import RunReporter
from ur.run.output.router import NodeOutputs
from ur.run.process.command import UnitProgram
from ur.run.process.host_client import HostLost, ProcessHost, Suspended
from ur.run.process.terminal import Terminal
from ur.run.run import Job, Run
from ur.run.startup.progress import StartCount, StartProgress
from ur.run.supervisor.actions import (
    Action,
    AwaitMaster,
    Finish,
    SetParameters,
    SignalUnit,
    StartShare,
    StartUnit,
    Sweep,
    Unregister,
    is_before,
)
from ur.run.supervisor.events import (
    CTRL_C,
    Begin,
    Event,
    Exited,
    NothingLeft,
    Printed,
    Started,
    StartFailed,
    StopRequested,
    Tick,
)
from ur.run.supervisor.planned import any_output
from ur.run.supervisor.state import RunPhase, UnitStatus
from ur.run.supervisor.supervisor import begin_state, next_deadline, step

if TYPE_CHECKING:
    from ur.run.clients.protocol import OutputSource


class Foreground:
    """Lends keyboard and screen to the unit (if any) that needs them, and keeps the console quiet meanwhile."""

    def __init__(self, name: str | None, terminal: Terminal | None, console: Console, host: ProcessHost) -> None:
        """`name` is the unit that needs the terminal."""
        self._name = name
        self._terminal = terminal
        self._console = console
        self._host = host

    def lend(self) -> str:
        """Release the terminal for the unit, which is about to start; return the process group kind for its start."""
        self._console.hold()
        if self._terminal is None or not self._terminal.in_foreground():
            return GROUP
        self._terminal.mark_lent()
        return FOREGROUND

    def reclaim(self, *, reset: bool) -> None:
        """Take the terminal back after the unit has ended; `reset` it after one that was killed."""
        if self._terminal is not None:
            self._terminal.reclaim(reset=reset)
        self._console.release()

    def suspend(self, name: str, pid: int | None) -> None:
        """Stop this process with a unit that was stopped (Ctrl-Z), and continue with it (`pid`, if it still exists)."""
        if self._terminal is None or name != self._name:
            return
        self._terminal.reclaim(reset=False)
        self._terminal.wait_suspended()
        if self._terminal.in_foreground() and pid is not None:
            self._terminal.lend(pid)
        self._host.signal_process(name, signal.SIGCONT)


MOST_STARTS = 100  # processes whose files are open at once before they are sent
FILES_KEPT = 3  # of a process: its log, and one end each of standard output and error
FILES_SENT = 2  # the other ends


class _Start(NamedTuple):
    program: UnitProgram
    argv: list[str]
    stdio: tuple[int, int, int]
    given: list[int]
    session_mode: str
    words: tuple[str, ...] = ()


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
            words = (*program.module, *argv[1:]) if program.module else ()
            self._prepared.append(_Start(program, argv, stdio, given, SESSION if alone else GROUP, words))
        if len(self._prepared) >= MOST_STARTS:
            self.send()

    def send(self) -> None:
        """Send the prepared starts to the host."""
        for each in self._prepared:
            program = each.program
            cwd = program.cwd or self._run.home
            self._host.start_process(
                program.unit.name, each.argv, cwd, dict(program.changes), each.stdio, each.session_mode, each.words
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


Task = Callable[[], None]
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)  # signals that request the end of a run
ECHO = 0.25  # s; timeout(1) signals a process and its group, which is one request and not a second, urgent one


class Inbox:
    """A queue of tasks, readable (`fileno`) while it is not empty. Handles SIGNALS until it is closed."""

    def __init__(self, on_signal: Callable[[int], None], read_clock: Callable[[], float] = time.monotonic) -> None:
        """Create the inbox; `on_signal` is called later, in the loop's thread, with a signal, once in ECHO s."""
        self._tasks: deque[Task] = deque()
        self._open = threading.Lock()  # held while the pipe is written to or closed
        self._closed = False
        self._reader, self._writer = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._old_writer = signal.set_wakeup_fd(self._writer, warn_on_full_buffer=False)
        self._on_signal, self._read_clock = on_signal, read_clock
        self._echoes: dict[int, float] = {}  # the end of ECHO, by signal
        self._handlers = {signum: signal.signal(signum, self._note_signal) for signum in SIGNALS}

    def fileno(self) -> int:
        """Return the descriptor for poll."""
        return self._reader

    def post(self, task: Task) -> None:
        """Queue a task for the loop. May be called from any thread. No effect after `close`."""
        with self._open:
            if self._closed:  # the descriptor may belong to another file by now
                return
            self._tasks.append(task)
            with suppress(BlockingIOError):  # the pipe is full: the loop wakes up anyway
                os.write(self._writer, b"\0")

    def _note_signal(self, signum: int, _frame: object) -> None:
        now = self._read_clock()
        if now >= self._echoes.get(signum, now):
            self._echoes[signum] = now + ECHO
            self._tasks.append(lambda: self._on_signal(signum))

    def clear(self) -> None:
        """Make the descriptor unreadable until the next task arrives."""
        try:
            while os.read(self._reader, 4096):
                pass
        except BlockingIOError:
            return

    def drain(self) -> Iterator[Task]:
        """Iterate over the pending requests, oldest first, and remove each."""
        while self._tasks:
            yield self._tasks.popleft()

    def close(self) -> None:
        """Restore the previous signal handlers."""
        signal.set_wakeup_fd(self._old_writer)
        for signum, handler in self._handlers.items():
            signal.signal(signum, handler)
        with self._open:
            self._closed = True
            os.close(self._reader)
            os.close(self._writer)


def run_loop(run: Run, host: ProcessHost, console: Console, terminal: Terminal | None) -> int:
    """Run to the end and return the exit code. No process is left behind, however it ends.

    Handles SIGINT, SIGTERM and SIGHUP, which request the end, while it runs.
    """
    loop = _Loop(run, host, console, terminal)
    try:
        return loop.run()
    except HostLost:
        host.close()  # waits until nothing is left
        console.release()
        loop.fail("the process host was killed; every node has been ended with it")
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
            (program.unit for program in run.programs),
            own_master=run.own_master,
            limits=run.limits,
            shared=run.restart_share is not None,
            planned=run.planned,
        )
        self._exit_code: int | None = None
        self._cause = ""
        self._over = threading.Event()
        self._call_started = run.clients.call_started
        self._master_watch: threading.Event | None = None
        owner = run.terminal_program
        self._poll = select.poll()
        self._inbox = Inbox(self._handle_signal)
        for source in (self._inbox, host):
            self._poll.register(source, select.POLLIN)
        self._foreground = Foreground(None if owner is None else owner.unit.name, terminal, console, host)
        self._monitor = Monitor(run.clients, self._poll, console, terminal)
        rotation = LogRotation(run.folder, run.log_bounds, now=time.monotonic())
        rotation.add(run.log_name)
        self._outputs = NodeOutputs(
            self._poll,
            run.folder,
            console,
            self._note_output if any_output(run.planned) else self._monitor.publish_output,
            unattended=run.clients.unattended or owner is not None,
            rotation=rotation,
        )
        self._starts = Starts(run, host, self._outputs, self._foreground)
        self._reporter = RunReporter(run, console, self._outputs, self._monitor)
        count = None
        if owner is not None and terminal is not None:
            nodes = sum(not program.unit.core for program in run.programs)
            count = StartCount(owner.unit.name, nodes, terminal, console)
        self._progress = StartProgress(run, self._inbox.post, self._monitor, count)

    def run(self) -> int:
        self._monitor.open(self._run, self._state, self._outputs, time.monotonic())
        if self._run.owners:
            from ur.run.join.owner import follow_owners  # only for a run that has joined another one

            follow_owners(self._run.owners, self._post_event, self._over)
        self._handle_event(Begin())
        while self._exit_code is None:
            self._console.flush()
            self._monitor.flush()
            self._wait()
            for task in self._inbox.drain():
                task()
            now = time.monotonic()
            deadline = next_deadline(self._state)
            if deadline is not None and now >= deadline:
                self._handle_event(Tick())
            self._outputs.work(now)
            self._monitor.work(now)
            self._progress.work(now)
        return self._exit_code

    def fail(self, text: str) -> None:
        """Report an end that was not requested."""
        self._cause = text
        self._reporter.fail(text)

    def close(self) -> None:
        """Restore signals and the terminal, and close open files."""
        owner = self._run.terminal_program
        each = None if owner is None else self._state.find(owner.unit.name)
        if each is not None and each.pid is not None:
            self._foreground.reclaim(reset=True)
        self._console.release()
        self._console.finish(1.0)
        self._over.set()
        self._reporter.record_end(self._exit_code, self._cause or self._state.cause or "")
        self._progress.close()
        if self._master_watch is not None:
            self._master_watch.set()
        self._monitor.close(1 if self._exit_code is None else self._exit_code)
        self._outputs.close()
        self._inbox.close()

    def _wait(self) -> None:
        """Wait until a descriptor is ready or a task is due, and handle it."""
        unwritten = self._console.waiting()
        for descriptor in unwritten:
            self._poll.register(descriptor, select.POLLOUT)
        dues = (next_deadline(self._state), self._monitor.due, self._outputs.due, self._progress.due)
        times = [time for time in dues if time is not None]
        ready = self._poll.poll(max(0.0, min(times) - time.monotonic()) * 1000 + 1 if times else None)
        for descriptor in unwritten:
            self._poll.unregister(descriptor)
        for descriptor, _ in ready:
            if descriptor not in unwritten:
                self._serve(descriptor)

    def _serve(self, descriptor: int) -> None:
        if descriptor == self._inbox.fileno():
            self._inbox.clear()
        elif descriptor == self._host.fileno():
            self._handle_host_event(self._host.receive())
        elif self._monitor.serves(descriptor):
            for event in self._monitor.attend(descriptor, time.monotonic()):
                self._handle_event(event)
            self._progress.follow(self._state)
        else:
            self._outputs.read(descriptor)

    def _handle_signal(self, signum: int) -> None:
        # roslaunch exits with 0 after Ctrl-C; a program that owns the terminal has not fulfilled its task.
        code = 0 if self._run.terminal_program is None else 128 + signum
        typed = signum == signal.SIGINT and self._terminal is not None and self._terminal.in_foreground()
        self._handle_event(StopRequested(CTRL_C if typed else signal.Signals(signum).name, code))

    def _handle_host_event(self, event: Event | Suspended) -> None:
        """Handle an event of the process host."""
        match event:
            case Suspended():
                self._progress.stop_count()
                each = self._state.find(event.name)
                self._foreground.suspend(event.name, None if each is None else each.pid)
                return
            case Started(name, pid):
                unit = self._programs[name].unit
                if not unit.terminal and not unit.core:
                    self._reporter.inform(f"[{name}] started, process {pid}")
            case Exited(name) | StartFailed(name):
                self._outputs.drain(name)
                if self._programs[name].unit.terminal:
                    killed = isinstance(event, Exited) and event.status.signal is not None
                    self._foreground.reclaim(reset=killed)
                if isinstance(event, Exited) and self._may_be_evicted(event):
                    middleware = self._run.middleware
                    assert middleware is not None
                    self._run_in_thread(lambda: middleware.examine_exit(event))
                    return
            case NothingLeft():
                self._outputs.drain_all()
        self._handle_event(event)

    def _note_output(self, name: str, source: "OutputSource", text: str) -> None:
        self._monitor.publish_output(name, source, text)
        self._post_event(Printed(name))

    def _may_be_evicted(self, event: Exited) -> bool:
        each = self._state.find(event.name)
        running = (
            self._state.phase is RunPhase.RUNNING and each is not None and each.request is None and not each.unit.core
        )
        return running and event.status.signal is None and self._run.middleware is not None

    def _post_event(self, event: Event) -> None:
        self._inbox.post(lambda: self._handle_event(event))

    def _handle_event(self, event: Event) -> None:
        now = time.monotonic()
        was_going = is_before(self._state, RunPhase.STOPPING_NODES)
        self._state, actions = step(self._state, event, now)
        self._monitor.note_state(self._state, now)
        if was_going and not is_before(self._state, RunPhase.STOPPING_NODES):
            self._reporter.report_joined()
        self._progress.note(event, self._state)
        self._carry_out(actions)
        running = self._state.phase is RunPhase.RUNNING
        if running and self._master_watch is None:
            middleware = None if self._run.own_master else self._run.middleware
            self._master_watch = threading.Event() if middleware is None else middleware.watch(self._post_event)
            if self._run.simulated_time and self._run.middleware is not None:
                from ur.run.startup.readiness import check_clock  # imported late: few runs need it

                warn = lambda text: self._inbox.post(lambda: self._reporter.warn(text))  # noqa: E731
                threading.Thread(
                    target=check_clock, args=(self._run.middleware.view, self._over, warn), daemon=True
                ).start()
        starting = any(each.status is UnitStatus.STARTING for each in self._state.units)
        if running and self._call_started is not None and not starting:
            self._call_started()
            self._call_started = None

    def _carry_out(self, actions: tuple[Action, ...]) -> None:
        for action in actions:
            if isinstance(action, StartUnit):
                self._starts.prepare(self._programs[action.name])
            else:
                self._starts.send()
                self._execute(action)
        self._starts.send()

    def _execute(self, action: Action) -> None:
        match action:
            case SignalUnit(name, signum):
                self._host.signal_process(name, signum)
            case Sweep(signum):
                self._host.sweep(signum)
            case AwaitMaster():
                self._run_in_thread(self._run.await_master)
            case SetParameters():
                self._run_in_thread(self._run.set_parameters)
            case StartShare():
                restart = self._run.restart_share
                assert restart is not None
                self._run_in_thread(restart)
            case Unregister():
                self._run_in_thread(self._run.unregister)
            case Finish(exit_code):
                self._exit_code = exit_code
            case _:
                self._reporter.report(action)

    def _run_in_thread(self, job: Job) -> None:
        def work() -> None:
            event = job()
            self._inbox.post(lambda: self._handle_event(event))

        threading.Thread(target=work, daemon=True).start()
