"""For all tests: the same examples every time, none fails because the computer is slow, and Ctrl-C means Ctrl-C."""

import gc
import os
import shutil
import signal
import tempfile
from collections import Counter
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from hypothesis import settings
from tests.slow_list import LIST, PROMISES, function_of, is_listed, name_of, read_promises, read_rows

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of each worker and what it starts, as nodes have it

settings.register_profile("project", deadline=None, derandomize=True, database=None)
settings.load_profile("project")

pytest_plugins = ["tests.parallel", "tests.times"]
NODES = "tests/ur_nodes/"
TEMPORARY, LEFT = pytest.StashKey[str](), pytest.StashKey[list[str]]()

# A shell without job control starts background jobs with these ignored, and programs under test would inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGQUIT, signal.SIG_DFL)

save_coverage = None
if coverage_folder := os.environ.get("UR_COVERAGE"):  # before other conftest.py files import what is measured
    from tests.coverage_probes import measure

    save_coverage = measure(Path(__file__).parents[1] / "src", Path(coverage_folder).absolute())


@pytest.fixture(autouse=True)
def _own_environment() -> Iterator[None]:
    """Take back what a test sets in the environment of its process, as `main` of `ur` does with the robot's ROS."""
    before = dict(os.environ)
    yield
    os.environ.clear()
    os.environ.update(before)


def pytest_configure(config: pytest.Config) -> None:
    """Give the tests a temporary folder of their own.

    Write the coverage of this process and its workers into the folder UR_COVERAGE names; no programs of tests.
    """
    os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", tempfile.gettempdir())  # where folders of tests are kept for a while
    config.stash[TEMPORARY] = os.environ["TMPDIR"] = tempfile.tempdir = tempfile.mkdtemp(prefix="ur-tests-")
    Path(tempfile.tempdir).chmod(0o1777)  # programs of other users have theirs in it
    if save_coverage is not None:
        config.add_cleanup(save_coverage)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect without looking for garbage: what is made stays until the end, and is not looked at later either."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fail a run that left something in the temporary folder."""
    folder = Path(session.config.stash[TEMPORARY])
    session.config.stash[LEFT] = left = sorted(each.name for each in folder.iterdir())
    if left and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED
    shutil.rmtree(folder)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    """Name what the run left."""
    if left := config.stash.get(LEFT, []):
        terminalreporter.section("left in the temporary folder")
        terminalreporter.line(", ".join(left))


def pytest_report_collectionfinish(items: list[pytest.Item]) -> str | None:
    """Print the share of the tests of nodes that need no master, for those that are to run."""
    nodes = [item for item in items if item.nodeid.startswith(NODES)]
    alone = sum(item.get_closest_marker("ros") is None for item in nodes)
    return f"tests/ur_nodes: {alone} of {len(nodes)} ({alone / len(nodes):.1%}) need no master" if nodes else None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests of tests/slow.tsv as slow but for those of tests/promises.tsv, and give them half an hour.

    Mark them with their seconds, too, and those of tests/e2e as robots.
    """
    listed = read_rows(LIST.read_text(encoding="utf-8"))
    tests_of = Counter(function_of(name_of(item.nodeid)) for item in items)
    promised = {test for _, test in read_promises(PROMISES.read_text(encoding="utf-8"))}
    for item in items:
        if item.nodeid.startswith("tests/e2e/"):
            item.add_marker(pytest.mark.robot)
        if is_listed(name := name_of(item.nodeid), listed):
            if not is_listed(name, promised):
                item.add_marker(pytest.mark.slow)
            function = function_of(name)
            seconds = listed[name] if name != function and name in listed else listed[function] / tests_of[function]
            item.add_marker(pytest.mark.seconds(seconds))
            if not item.get_closest_marker("timeout"):
                item.add_marker(pytest.mark.timeout(1800))
