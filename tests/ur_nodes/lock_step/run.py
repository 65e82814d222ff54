"""A replay in lock step: nodes start as they do in a run, and get what was recorded; and what they did then and now."""

import runpy
import sys
import threading
import traceback
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from tests.ur_nodes.lock_step.bus import StepBus
from tests.ur_nodes.lock_step.digest import fingerprint
from tests.ur_nodes.lock_step.stored import find_reader

from ur.recordings.mcap_file import open_recording
from ur.recordings.message_types import full_type_name
from ur.source.diagnostic import UserError
from ur_nodes.one_process.bus import LiveNode
from ur_nodes.one_process.context import NodeContext
from ur_nodes.one_process.host import NodeStart, start_thread
from ur_nodes.ports.actions import GoalState
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap
from ur_nodes.ports.values import Map, Result

_STATES = (str, bool)


@dataclass(frozen=True, slots=True)
class StepPlan:
    """The recording, the nodes that run against it, and the parameters of the run by their full names."""

    recording: Path
    nodes: tuple[NodeStart, ...]
    parameters: dict[str, object] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Outcome:
    """The states of nodes by topic, each value once until it changes, and how goals ended: their state and text."""

    states: dict[str, list[str]] = field(default_factory=dict)
    endings: list[tuple[str, str]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class StepReport:
    """The outcome as it was recorded and as it was replayed.

    `digest` is equal for replays in which the nodes have sent the same to the last bit: `sent` values.
    """

    sent: int
    digest: str
    recorded: Outcome
    replayed: Outcome


def replay(plan: StepPlan, sent: int | None = None) -> StepReport:
    """Run the nodes against the recording; the digest is that of the first `sent` values, or of all."""
    recording = open_recording(plan.recording)
    tested = frozenset(each.name for each in plan.nodes)
    latched = recording.kept_topics - {each.name for each in recording.topics.values() if each.sender}
    bus = StepBus(recording, tested, latched)
    bus.load_parameters("", {name.lstrip("/"): value for name, value in plan.parameters.items()})
    _serve_map(bus.node("recording"))
    nodes = [_start(bus, each) for each in plan.nodes]
    for message in recording.messages():
        bus.advance(message.time)
        bus.deliver(message)
    bus.advance(recording.end)
    before, replayed = _judge(bus, tested)
    digest = fingerprint(bus.outputs[:sent])
    for node, thread in nodes:
        node.end("the recording ends")
        thread.join()
    return StepReport(len(bus.outputs), digest, before, replayed)


def _start(bus: StepBus, start: NodeStart) -> tuple[LiveNode, threading.Thread]:
    """Run the module of a node on a thread, up to where it waits for its end."""
    wired: list[LiveNode] = []
    problems: list[str] = []

    def run(started: Callable[[], None]) -> None:
        NodeContext(bus, start.name, start.remaps, started, wired.append).enter()
        sys.argv = list(start.words)
        try:
            runpy.run_module(start.words[0], run_name="__main__")
        except SystemExit:
            pass
        except BaseException:
            problems.append(traceback.format_exc())
        finally:
            started()

    thread = start_thread(start.name, run)
    assert wired, f"{start.name} does not start: {problems}"
    return wired[0], thread


def _serve_map(node: Node) -> None:
    """Serve the recorded map, as a map server does."""
    maps: list[Map] = []
    node.subscribe("map", Map, maps.append, Quality.LATCHED)

    def answer(_request: AskMap) -> Result:
        return Result(True, value=maps[-1]) if maps else Result(False, "the recording has no map yet")

    node.serve("static_map", AskMap, answer)


def _judge(bus: StepBus, tested: frozenset[str]) -> tuple[Outcome, Outcome]:
    """The outcome that was recorded, and that of the nodes on a bus that has come to its end."""
    readers = [
        found
        for topic, entry in bus.topics.items()
        for each in entry.publishers
        if each.sender in tested and isinstance(each.kind, type) and each.kind in (*_STATES, GoalState)
        if (found := find_reader(topic, each.kind)) is not None
    ]
    sent: list[tuple[str, object]] = []
    for message in bus.recorded:
        topic = message.topic
        for reader in readers:
            if reader.topic != topic.name or full_type_name(reader.type_name) != full_type_name(topic.type_name):
                continue
            try:
                sent.append((topic.name, reader.read(message.data)))
            except (ValueError, UserError):
                continue
    return _collect(sent), _collect((each.topic, each.value) for each in bus.outputs)


def _collect(sent: Iterable[tuple[str, object]]) -> Outcome:
    found = Outcome()
    ended: set[str] = set()
    for topic, value in sent:
        if isinstance(value, GoalState):
            if not value.open and value.id not in ended:
                ended.add(value.id)
                found.endings.append((value.state, value.text))
        elif isinstance(value, _STATES):
            values = found.states.setdefault(topic, [])
            if not values or values[-1] != str(value):
                values.append(str(value))
    return found
