"""A replay in lock step: nodes of a program start as they do in a run, and get what was recorded.

    python -m ur_nodes ur_nodes.lock_step.run PLAN

PLAN is a file as StepPlan has it. The report is printed as JSON.
"""

from __future__ import annotations

import os
import runpy
import sys
import threading
import traceback
from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path

from ur.recordings.lock_step import StepReport
from ur.recordings.mcap_file import open_recording
from ur.source.diagnostic import UserError
from ur.source.foreign.json_values import read_json, write_json
from ur.source.render import render_human
from ur_nodes.lock_step.bus import StepBus
from ur_nodes.lock_step.digest import fingerprint
from ur_nodes.lock_step.outcome import judge
from ur_nodes.one_process.bus import LiveNode
from ur_nodes.one_process.context import NodeContext
from ur_nodes.one_process.host import start_thread
from ur_nodes.one_process.plan import NodeStart
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import FindReader
from ur_nodes.ports.services import AskMap
from ur_nodes.ports.values import Map, Result
from ur_nodes.run import backend_name

_MOST = 1 << 26  # bytes of a plan
_KEPT_LEVELS = ("WARN", "ERROR")


@dataclass(frozen=True, slots=True)
class StepPlan:
    """The recording, the nodes that run against it, and the parameters and facts of the run by their full names."""

    recording: str
    nodes: tuple[NodeStart, ...]
    parameters: dict[str, object] = field(default_factory=dict)
    facts: dict[str, object] = field(default_factory=dict)


def replay(plan: StepPlan, find_reader: FindReader, sent: int | None = None) -> StepReport:
    """Run the nodes against the recording; the digest is that of the first `sent` values, or of all.

    Raises UserError: it cannot be read, or a node does not start.
    """
    recording = open_recording(Path(plan.recording))
    tested = frozenset(each.name for each in plan.nodes)
    log: list[str] = []

    def write_line(level: str, node: str, text: str) -> None:
        if level in _KEPT_LEVELS:
            log.append(f"{node}: {text}")

    latched = recording.kept_topics - {each.name for each in recording.topics.values() if each.sender}
    bus = StepBus(recording, find_reader, tested, latched, write_line, plan.facts)
    bus.load_parameters("", {name.lstrip("/"): value for name, value in plan.parameters.items()})
    _serve_map(bus.node("recording"))
    nodes = [_start(bus, each) for each in plan.nodes]
    for message in recording.messages():
        bus.advance(message.time)
        bus.deliver(message)
    bus.advance(recording.end)
    before, replayed = judge(bus, tested, find_reader)
    digest = fingerprint(bus.outputs[:sent])
    for node, thread in nodes:
        node.end("the recording ends")
        thread.join()
    return StepReport(recording.seconds, len(bus.outputs), digest, before, replayed, bus.used, log)


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
    if not wired:
        from ur.source.diagnostic import error

        reason = problems[0].splitlines()[-1] if problems else "it has ended"
        message = f"{start.name} does not start: {reason}"
        raise UserError(error(message, rule="node-failed", help="'ur run' shows why", subject=start.name))
    return wired[0], thread


def _serve_map(node: Node) -> None:
    """Serve the recorded map, as a map server does."""
    maps: list[Map] = []
    node.subscribe("map", Map, maps.append, Quality.LATCHED)

    def answer(_request: AskMap) -> Result:
        return Result(True, value=maps[-1]) if maps else Result(False, "the recording has no map yet")

    node.serve("static_map", AskMap, answer)


def main() -> int:
    """Replay the plan that the command line names, and print the report."""
    try:
        plan = read_json(Path(sys.argv[1]).read_bytes(), StepPlan, _MOST)
        find_reader: FindReader = import_module(f"ur_nodes.{backend_name()}.stored").find_reader
        os.environ["ROS_VERSION"] = "0"  # the nodes below find the process that they are in
        report = replay(plan, find_reader)
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics))
        return 2
    sys.stdout.write(write_json(report) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
