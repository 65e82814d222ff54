"""Processor time of each test: pytest --times FILE.

A line a test that was not skipped, `SECONDS<tab>ID`: user and system time of the process and of the processes that it
has started, as if the test ran alone. What fixtures of a module, a class or the session take is added to each test that
uses them; that of a package is divided among its tests, which always run together.
"""

import contextlib
import os
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest
from tests.slow_list import name_of

TICK = os.sysconf("SC_CLK_TCK")
_SHARED = ("class", "module", "package", "session")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add `--times`."""
    parser.addoption("--times", type=Path, metavar="FILE", help="append the processor time of each test to FILE")


def pytest_configure(config: pytest.Config) -> None:
    """Begin to measure where it is asked for."""
    if path := config.getoption("--times"):
        path.parent.mkdir(parents=True, exist_ok=True)
        config.pluginmanager.register(_Times(path.absolute()))


def read_processor_time() -> float:
    """Return the seconds of processor that this process and its descendants have taken so far."""
    waiting, ticks = [str(os.getpid())], 0
    while waiting:
        process = Path("/proc", waiting.pop())
        with contextlib.suppress(OSError):  # it has ended, or one of its threads
            ticks += sum(map(int, process.joinpath("stat").read_bytes().rpartition(b")")[2].split()[11:15]))
            for thread in process.joinpath("task").iterdir():  # to look at all processes takes 8 ms, for each test
                waiting += thread.joinpath("children").read_text().split()
    return ticks / TICK


class _Times:
    def __init__(self, path: Path) -> None:
        self._path = path
        self._fixtures: dict[object, float] = {}
        """Seconds of each shared fixture, what it uses itself left out."""
        self._users: dict[object, int] = {}
        """Tests of this run that use a fixture of a package."""
        self._nested = 0.0
        """Seconds of shared fixtures in the test that runs."""
        self._end = -1.0
        """Seconds at the end of the test before."""
        self._skipped = False

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: pytest.FixtureDef[Any]) -> Generator[None, object, object]:
        if fixturedef.scope not in _SHARED:
            return (yield)
        before, nested = read_processor_time(), self._nested
        try:
            return (yield)
        finally:
            taken = read_processor_time() - before - (self._nested - nested)
            self._fixtures[fixturedef] = taken
            self._nested += taken

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        before, self._nested = self._end if self._end >= 0.0 else read_processor_time(), 0.0
        self._skipped = False
        try:
            return (yield)
        finally:
            self._end = read_processor_time()
            own = self._end - before - self._nested
            shared = sum(self._fixtures.get(each, 0.0) / self._count_users(each, item) for each in _fixtures_of(item))
            if not self._skipped:
                with self._path.open("a", encoding="utf-8") as file:
                    file.write(f"{own + shared:.3f}\t{name_of(item.nodeid)}\n")

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._skipped |= report.skipped

    def _count_users(self, fixture: pytest.FixtureDef[Any], item: pytest.Item) -> int:
        if fixture.scope != "package":
            return 1
        if fixture not in self._users:
            self._users[fixture] = sum(fixture in _fixtures_of(each) for each in item.session.items)
        return self._users[fixture]


def _fixtures_of(item: pytest.Item) -> set[pytest.FixtureDef[Any]]:
    found: Any = getattr(item, "_fixtureinfo", None)
    return {each[-1] for each in found.name2fixturedefs.values() if each} if found else set()
