"""For all tests: the same examples every time, none fails because the computer is slow, and Ctrl-C means Ctrl-C."""

from __future__ import annotations

import gc
import os
import signal
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of each worker and what it starts, as nodes have it

settings.register_profile("project", deadline=None, derandomize=True, database=None)
settings.load_profile("project")

pytest_plugins = "tests.parallel"
NODES = "tests/ur_nodes/"
MEASUREMENT = pytest.StashKey[Any]()

# A shell without job control starts background jobs with these ignored, and programs under test would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGQUIT, signal.SIG_DFL)


def pytest_configure(config: pytest.Config) -> None:
    """Measure coverage into the folder that UR_COVERAGE names: this process and its workers, no programs of tests."""
    if folder := os.environ.get("UR_COVERAGE"):
        _measure_coverage(config, Path(folder).absolute())


def _measure_coverage(config: pytest.Config, folder: Path) -> None:
    import coverage

    folder.mkdir(parents=True, exist_ok=True)
    settings = config.rootpath / "pyproject.toml"
    measurement = coverage.Coverage(str(folder / "data"), data_suffix=True, config_file=str(settings))
    measurement.start()

    def save() -> None:
        measurement.stop()
        measurement.save()

    config.add_cleanup(save)
    config.stash[MEASUREMENT] = measurement


@pytest.fixture(autouse=True)
def _leave_unmeasured(request: pytest.FixtureRequest) -> Iterator[None]:
    """Tests about the cost of a computation are not made to cost more."""
    measurement = request.config.stash.get(MEASUREMENT, None)
    if measurement is None or request.node.get_closest_marker("unmeasured") is None:
        yield
        return
    measurement.stop()
    yield
    measurement.start()


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect without looking for garbage: what is made stays until the end, and is not looked at later either."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_report_collectionfinish(items: list[pytest.Item]) -> str | None:
    """Print the share of the tests of nodes that need no master, for those that are to run."""
    nodes = [item for item in items if item.nodeid.startswith(NODES)]
    alone = sum(item.get_closest_marker("ros") is None for item in nodes)
    return f"tests/ur_nodes: {alone} of {len(nodes)} ({alone / len(nodes):.1%}) need no master" if nodes else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A long test has half an hour, unless it says otherwise."""
    for item in items:
        if item.get_closest_marker("long") and not item.get_closest_marker("timeout"):
            item.add_marker(pytest.mark.timeout(1800))
