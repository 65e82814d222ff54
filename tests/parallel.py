"""Tests in several processes that share one collection: pytest -n N.

This process collects, and forks N workers, which run what it hands them: a file at a time, for the fixtures that its
tests share, a folder where these have the scope of a package, or one test that shares none, where it is slow or boots
computers. What takes longest comes first, by the marker `seconds`, so that no worker has much left when the others have
nothing. A third of the workers run tests that start a whole robot (the marker `robot`), whose programs wait for one
another: five at once on two processors took minutes to start. Once only robots are left, one more does.
pytest-xdist collects once in each worker, which took a tenth of the time of all tests.
"""

import os
import signal
import traceback
import warnings
from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from multiprocessing import connection as connections
from multiprocessing import get_context
from multiprocessing.connection import Connection
from multiprocessing.context import ForkProcess
from typing import Any

import pytest

FORK = get_context("fork")
END = 60.0
"""Seconds that workers have to end what they started after Ctrl-C."""
GRACE = 2.0
"""Seconds for workers to end the test that Ctrl-C interrupts; without a terminal it interrupts this process only."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add `-n`, as pytest-xdist calls it; pytest keeps short options in small letters for itself."""
    group = parser.getgroup("parallel")
    group._addoption(
        "-n", dest="workers", type=int, default=0, metavar="N", help="run tests in N forks of this process"
    )


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> bool | None:
    """Run the tests in forks where they are asked for."""
    options = session.config.option
    if not options.workers or options.collectonly or session.testsfailed:
        return None
    _Run(session).run(options.workers)
    return True


def group_items(items: Sequence[pytest.Item]) -> list[list[int]]:
    """Return the indices of items that stay in one process, first those that wait for programs they start.

    Of these and of the others, those that take longest come first.
    """
    groups: dict[str, list[int]] = {}
    folders = {file_of(item): folder for item in items if (folder := folder_of_fixtures(item))}
    for index, item in enumerate(items):
        large = item.get_closest_marker("slow") or item.get_closest_marker("hosts")
        alone = large and not shares_fixtures(item)
        name = item.nodeid if alone else folders.get(file_of(item), file_of(item))
        groups.setdefault(name, []).append(index)

    def waits(group: list[int]) -> bool:
        return any(items[index].get_closest_marker("ros") is not None for index in group)

    def takes(group: list[int]) -> float:
        return sum(float(mark.args[0]) for index in group for mark in items[index].iter_markers("seconds"))

    return sorted(groups.values(), key=lambda each: (not waits(each), -takes(each)))


def file_of(item: pytest.Item) -> str:
    """Return the file of a test, as it is in its id."""
    return item.nodeid.partition("::")[0]


def shares_fixtures(item: pytest.Item) -> bool:
    """Return whether a test uses what is set up once for its file or folder."""
    return any(each.scope in ("module", "class", "package") for each in _fixtures_of(item))


def folder_of_fixtures(item: pytest.Item) -> str:
    """Return the folder that sets up what a test uses once for all its files; '' without that."""
    folders = (each.baseid for each in _fixtures_of(item) if each.scope == "package" and each.baseid)
    return min(folders, key=len, default="")


def _fixtures_of(item: pytest.Item) -> list[Any]:
    found: Any = getattr(item, "_fixtureinfo", None)
    return [each[-1] for each in found.name2fixturedefs.values() if each] if found else []


@dataclass(eq=False)
class _Worker:
    process: ForkProcess
    connection: Connection
    items: deque[int] = field(default_factory=deque)
    """What it was handed and has not finished; it runs the first."""
    error: str = ""


class _Run:
    def __init__(self, session: pytest.Session) -> None:
        self._session = session
        self._hook = session.config.hook
        groups = group_items(session.items)
        self._groups = deque(each for each in groups if not self._is_robot(each))
        self._robots = deque(each for each in groups if self._is_robot(each))
        """Groups that start a whole robot."""
        self._most_robots = 1
        self._workers: list[_Worker] = []

    def run(self, count: int) -> None:
        """Start workers, report what they report, and replace those that end before their tests have."""
        stop = ""
        self._most_robots = max(1, (count + 1) // 3)
        try:
            for _ in range(min(count, len(self._groups) + len(self._robots))):
                self._start()
            while self._workers and not stop:
                connections.wait([e for worker in self._workers for e in (worker.connection, worker.process.sentinel)])
                for worker in list(self._workers):
                    if not self._receive(worker):
                        self._replace(worker)
                stop = str(self._session.shouldfail or self._session.shouldstop or "")
        except KeyboardInterrupt:
            self._end(GRACE)
            raise
        self._end()
        if stop:
            raise (self._session.Failed if self._session.shouldfail else self._session.Interrupted)(stop)

    def _start(self) -> None:
        ours, theirs = FORK.Pipe()
        mine = [ours, *(each.connection for each in self._workers)]
        process = FORK.Process(target=_work, args=(self._session, theirs, mine))
        process.start()
        theirs.close()
        self._workers.append(_Worker(process, ours))

    def _receive(self, worker: _Worker) -> bool:
        """Handle what a worker has sent; return whether it still runs."""
        ended = worker.process.exitcode is not None  # before what it sent last is read
        try:
            while worker.connection.poll():
                kind, content = worker.connection.recv()
                self._handle(worker, kind, content)
        except (EOFError, ConnectionError):
            return False
        return not ended

    def _handle(self, worker: _Worker, kind: str, content: Any) -> None:
        if kind == "ask":
            group = self._take(worker)
            worker.items.extend(group)
            worker.connection.send(group)
        elif kind == "report":
            report = self._hook.pytest_report_from_serializable(config=self._session.config, data=content)
            self._hook.pytest_runtest_logreport(report=report)
        elif kind == "warning":
            text, category, filename, line, more = content
            warning = warnings.WarningMessage(text, type(category, (Warning,), {}), filename, line)
            self._hook.pytest_warning_recorded.call_historic(kwargs={"warning_message": warning, **more})
        elif kind == "finished":
            item = self._session.items[worker.items.popleft()]
            self._hook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
        else:
            worker.error = content

    def _is_robot(self, group: Iterable[int]) -> bool:
        return any(self._session.items[index].get_closest_marker("robot") for index in group)

    def _take(self, worker: _Worker) -> list[int]:
        """Return the next group for a worker; none where only robots are left and the others run enough of them."""
        running = [each.items for each in self._workers if each is not worker and each.items]
        robots = sum(map(self._is_robot, running))
        only_robots = not self._groups and robots == len(running)
        if self._robots and robots < self._most_robots + only_robots:
            return self._robots.popleft()
        return self._groups.popleft() if self._groups else []

    def _replace(self, worker: _Worker) -> None:
        """Report the test that ended its process as failed, and run what followed it in another."""
        worker.process.join()
        worker.connection.close()
        self._workers.remove(worker)
        if not worker.items:
            return
        item = self._session.items[worker.items.popleft()]
        error = worker.error or f"the process of this test ended with exit code {worker.process.exitcode}"
        report = pytest.TestReport(item.nodeid, item.location, {}, "failed", error, "call")
        self._hook.pytest_runtest_logreport(report=report)
        if worker.items:
            (self._robots if self._is_robot(worker.items) else self._groups).appendleft(list(worker.items))
        if self._groups or self._robots:
            self._start()

    def _end(self, grace: float = 0.0) -> None:
        """Let workers that still run tests end those, as Ctrl-C does."""
        for worker in self._workers:
            worker.process.join(grace)
            if worker.process.exitcode is None:
                os.kill(worker.process.ident or 0, signal.SIGINT)
        for worker in self._workers:
            worker.process.join(END)
            worker.process.kill()
            worker.process.join()


class _Sender:
    """Sends what a worker's plugins report."""

    def __init__(self, config: pytest.Config, connection: Connection) -> None:
        self._config = config
        self._connection = connection

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        hook = self._config.hook
        self._connection.send(("report", hook.pytest_report_to_serializable(config=self._config, report=report)))

    def pytest_warning_recorded(
        self, warning_message: warnings.WarningMessage, when: str, nodeid: str, location: tuple[str, int, str] | None
    ) -> None:
        text, category = str(warning_message.message), warning_message.category.__name__
        more = {"when": when, "nodeid": nodeid, "location": location}
        self._connection.send(("warning", (text, category, warning_message.filename, warning_message.lineno, more)))


def _work(session: pytest.Session, connection: Connection, others: Iterable[Connection]) -> None:
    """Run what the parent hands out, in a fork of it."""
    for other in others:
        other.close()
    try:
        _become_worker(session.config, connection)
        _run_groups(session, connection)
    except BaseException:  # of a plugin, or Ctrl-C; those of tests are in reports
        signal.signal(signal.SIGINT, lambda *_: None)
        connection.send(("error", traceback.format_exc()))
        session._setupstate.teardown_exact(None)
    finally:
        session.config._ensure_unconfigure()


def _become_worker(config: pytest.Config, connection: Connection) -> None:
    plugins = config.pluginmanager
    if capture := plugins.get_plugin("capturemanager"):  # else all workers capture into one file
        capture.stop_global_capturing()
        capture.start_global_capturing()
    plugins.unregister(name="terminalreporter")
    plugins.register(_Sender(config, connection))
    factory: Any = config._tmp_path_factory  # type: ignore[attr-defined]
    # A short name: paths of sockets have 107 bytes at most, unix(7), and programs have theirs in folders of tests.
    factory._basetemp = factory.getbasetemp() / f"w{os.getpid()}"
    factory._basetemp.mkdir(mode=0o700)


class _Next:
    """The next test, asked for when the one before it is taken down: until then another worker may get it."""

    def __init__(self, session: pytest.Session, connection: Connection) -> None:
        self._session = session
        self._connection = connection
        self._indices: deque[int] = deque()

    def take(self) -> pytest.Item | None:
        return self._session.items[self._indices.popleft()] if self._is_known() else None

    def listchain(self) -> list[Any]:
        """See pytest.Item: what this test uses is not taken down."""
        return self._session.items[self._indices[0]].listchain() if self._is_known() else []

    def _is_known(self) -> bool:
        if not self._indices:
            self._connection.send(("ask", None))
            self._indices.extend(self._connection.recv())
        return bool(self._indices)


def _run_groups(session: pytest.Session, connection: Connection) -> None:
    following: Any = _Next(session, connection)
    while not session.shouldfail and not session.shouldstop and (item := following.take()) is not None:
        session.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        connection.send(("finished", None))
