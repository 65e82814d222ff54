"""The bus in real time."""

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from ur.source.diagnostic import UserError
from ur_nodes.file_facts import FileFacts
from ur_nodes.one_process.bus import LiveBus, LiveNode
from ur_nodes.one_process.context import NodeContext, current_context
from ur_nodes.ports.node import SECOND
from ur_nodes.ports.qualities import Quality

LIMIT = 20.0  # s


class LeapingTime:
    """The real time, and leaps: what a slow computer takes."""

    def __init__(self) -> None:
        self.leaps = 0

    def leap(self) -> None:
        self.leaps += 60 * SECOND

    def __call__(self) -> int:
        return time.monotonic_ns() + self.leaps


@pytest.fixture
def leaping() -> LeapingTime:
    return LeapingTime()


@pytest.fixture
def lines() -> list[tuple[str, str, str]]:
    return []


@pytest.fixture
def failures() -> list[BaseException | None]:
    return []


@pytest.fixture
def bus(
    tmp_path: Path,
    lines: list[tuple[str, str, str]],
    failures: list[BaseException | None],
    leaping: LeapingTime,
) -> Iterator[LiveBus]:
    facts = FileFacts(simulated_time=False, file=tmp_path / "facts")
    made = LiveBus(facts, lambda *line: lines.append(line), lambda details: failures.append(details.exc_value), leaping)
    made.begin()
    yield made
    made.close()


def fail(reason: str) -> None:
    raise KeyError(reason)


def add(bus: LiveBus, name: str) -> LiveNode:
    return NodeContext(bus, name).wire("node", lambda _node: None)[1]


def test_values_jobs_and_beats_arrive_on_the_thread_of_the_bus(bus: LiveBus) -> None:
    one, two = add(bus, "/one"), add(bus, "/two")
    threads: dict[str, str] = {}
    done = threading.Event()

    def note(what: str) -> None:
        threads[what] = threading.current_thread().name
        if len(threads) == 4:
            done.set()

    def wire() -> None:
        two.subscribe("text", str, note)
        one.publish("text", str, Quality.EVERY).send("value")
        one.after(0.001, lambda: note("beat"))
        one.work(lambda: threads.setdefault("job", threading.current_thread().name), lambda _name: note("result"))

    bus.do(wire)
    assert done.wait(LIMIT)
    assert threads.pop("job") != "bus"
    assert threads == {"value": "bus", "beat": "bus", "result": "bus"}


def test_time_waits_for_a_callback_that_takes_long(leaping: LeapingTime, bus: LiveBus) -> None:
    node, before, beats = add(bus, "/one"), bus.now, threading.Semaphore(0)
    bus.do(lambda: node.every(0.01, beats.release))
    bus.do(leaping.leap)
    assert all(beats.acquire(timeout=LIMIT) for _ in range(3))
    assert before <= bus.now < before + 30 * SECOND
    assert node.steady() < before * 1e-9 + 30.0


def test_held_time_passes_again_once_it_is_released(leaping: LeapingTime, bus: LiveBus) -> None:
    bus.held = True
    for _ in range(2):
        bus.do(lambda: None)
    before, done = bus.now, threading.Event()
    leaping.leap()
    assert bus.now == before
    bus.do(lambda: add(bus, "/one").after(0.001, done.set))
    bus.held = False
    assert done.wait(LIMIT)


def test_callback_that_fails_ends_all_nodes_and_calls_that_wait(
    bus: LiveBus, failures: list[BaseException | None]
) -> None:
    node = add(bus, "/one")
    ended = threading.Event()
    node.at_over = ended.set
    node.post(lambda: fail("posted"))
    assert ended.wait(LIMIT)
    assert node.over.is_set()
    assert node.failed
    assert isinstance(failures[0], KeyError)
    with pytest.raises(RuntimeError, match="the nodes have ended"):
        bus.do(lambda: None)


def test_job_that_fails_fails_where_callbacks_do(bus: LiveBus, failures: list[BaseException | None]) -> None:
    node = add(bus, "/one")
    node.work(lambda: fail("worked"), lambda _result: None)
    assert node.over.wait(LIMIT)
    assert isinstance(failures[0], KeyError)


def test_node_that_cannot_start_leaves_nothing_on_the_bus(bus: LiveBus) -> None:
    def start(_node: object) -> None:
        raise UserError

    with pytest.raises(UserError):
        NodeContext(bus, "/one").wire("node", start)
    assert "/one" not in bus.nodes


def test_node_of_the_same_name_takes_the_place_of_the_one_before(bus: LiveBus) -> None:
    one, two = add(bus, "/one"), add(bus, "/one")
    assert (one.over.is_set(), one.replaced) == (True, True)
    assert (two.over.is_set(), bus.nodes["/one"]) == (False, two)


def test_node_that_chooses_its_name_takes_a_free_one(bus: LiveBus) -> None:
    assert [NodeContext(bus).wire("web", lambda _node: None)[1].name for _ in range(3)] == ["/web", "/web_2", "/web_3"]


def test_log_has_levels_names_and_limits(bus: LiveBus, lines: list[tuple[str, str, str]]) -> None:
    log = add(bus, "/one").log
    log.debug("left out")
    log.info("begins")
    for _ in range(3):
        log.warn("again", every=100.0)
    log.error("wrong")
    assert lines == [("INFO", "/one", "begins"), ("WARN", "/one", "again"), ("ERROR", "/one", "wrong")]


def test_graph_is_that_of_the_bus_and_facts_are_in_the_file(bus: LiveBus) -> None:
    node = add(bus, "/ns/one")
    found: list[object] = []
    done = threading.Event()

    def take(graph: object) -> None:
        found.append(graph)
        done.set()

    def wire() -> None:
        node.publish("text", str)
        node.read_graph(take)

    bus.do(wire)
    assert done.wait(LIMIT)
    assert "/ns/text" in str(found[0])
    node.facts.set("lease", {"owner": "page"})
    assert bus.run_facts.get("lease") == {"owner": "page"}
    assert node.steady() > 0.0


def test_program_of_its_own_learns_that_it_cannot_reach_the_nodes() -> None:
    with pytest.raises(UserError, match="client: without ROS, all nodes run in the process of 'ur run'"):
        current_context("client")
