"""A master of ROS 1 as the middleware of a run."""

import os
import select
import threading
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, ParamValue, Plan
from ur.launchfile.world import World
from ur.run.master.client import CALLER, Master, parse_master_uri
from ur.run.master.monitor import start_watch
from ur.run.master.parameters import CommandParameters, remove_registrations, upload_parameters
from ur.run.master.search import await_master, find_master, find_master_programs, read_run_id, roscore_parameters
from ur.run.master.tcpros import NoTopic, TopicConnection, listen_to, read_frames
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.middleware.protocol import TF_TOPICS, GraphView, NoGraph, ReceivedMessages, RunGraph
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.run.paths import is_local_address
from ur.run.process.command import UnitProgram
from ur.run.record.registry import list_runs, read_computer
from ur.run.supervisor.events import Event, Evicted, Exited
from ur.source.data_classes import dataclass
from ur.source.diagnostic import UserError


@dataclass(frozen=True, slots=True)
class MasterMiddleware:
    """See `Middleware`. `parameters` are those of roscore."""

    master: Master
    own: bool
    run_id: str
    core: tuple[UnitProgram, ...]
    parameters: Mapping[str, ParamValue]

    @property
    def address(self) -> str:
        return self.master.uri

    @property
    def environment(self) -> Mapping[str, str]:
        return {"ROS_MASTER_URI": self.master.uri}

    @property
    def logs(self) -> int:
        """See Middleware. The number is that of roslaunch, whose rosout is the first."""
        return 2 if self.own else 1

    def describe(self) -> str:
        return f"ROS_MASTER_URI={self.master.uri}" + (", master started here" if self.own else "")

    def arrange(
        self,
        programs: tuple[UnitProgram, ...],
        nodes: Sequence[NodeSpec],  # noqa: ARG002 - ROS 2 needs it, and the next
        folder: str,  # noqa: ARG002
    ) -> tuple[UnitProgram, ...]:
        return programs

    def await_core(self, limit: float) -> Event:
        return await_master(self.master, limit)

    def set_parameters(self, plan: Plan, folder: str, options: RunOptions, commands: CommandParameters) -> Event:
        extra: dict[str, ParamValue] = {} if self.run_id else {"/run_id": Path(folder).name}
        if self.own:
            extra |= self.parameters
            extra |= {"/ur/base_name": options.base, "/ur/variant": options.variant} if options.base else {}
        return upload_parameters(plan, self.master, extra, commands)

    def unregister(self, names: Sequence[str]) -> Event:
        return remove_registrations(self.master, list(names))

    def examine_exit(self, event: Exited) -> Event:
        return examine_exit(event, self.master)

    def watch(self, report: Callable[[Event], None]) -> threading.Event:
        return start_watch(self.master, report)

    def view(self) -> GraphView:
        return MasterView(self.master)


def find_ros1(environment: Mapping[str, str], world: World, options: RunOptions, console: Console) -> MasterMiddleware:
    """Find the master of a run, and the programs that start one if none runs. Raises UserError."""
    master = find_master(environment, options)
    run_id = read_run_id(master, options, console)
    if run_id is not None:
        return MasterMiddleware(master, False, run_id, (), {})
    programs = find_master_programs(master, world, options)
    return MasterMiddleware(master, True, "", programs, roscore_parameters(world, environment))


_TIMEOUT = 1.0  # s that a publisher gets to answer


class MasterView:
    """See `GraphView`."""

    def __init__(self, master: Master) -> None:
        self._master = master
        self._listeners: dict[tuple[str, str], TopicConnection] = {}
        self.received: dict[str, ReceivedMessages] = {}

    def look(self, topics: Collection[str]) -> RunGraph:
        try:
            publishers, subscribers, services = (dict(kind) for kind in self._master.get_system_state())
        except (Unanswered, CallRefused, ValueError, TypeError) as problem:
            raise NoGraph(f"the master does not answer: {problem}") from None
        graph = RunGraph(publishers, subscribers, services)
        self._connect(topics, graph)
        return graph

    def wait(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while self._listeners and (left := end - time.monotonic()) > 0:
            keys = {listener.fileno(): key for key, listener in self._listeners.items()}
            for descriptor in select.select(list(keys), [], [], left)[0]:
                self._receive(keys[descriptor])
        if (left := end - time.monotonic()) > 0:
            time.sleep(left)

    def forget(self) -> None:
        for listener in self._listeners.values():
            listener.close()
        self._listeners.clear()
        self.received.clear()

    def _connect(self, topics: Collection[str], graph: RunGraph) -> None:
        for topic in topics:
            for node in graph.publishers.get(topic, ()):
                if (topic, node) in self._listeners:
                    continue
                with suppress(NoTopic, Unanswered, CallRefused):  # it is asked again at the next look
                    uri = self._master.call("lookupNode", node)
                    keep = 1 << 20 if topic in TF_TOPICS else 0
                    listener = listen_to(uri, topic, keep=keep, timeout=_TIMEOUT, caller=CALLER)
                    self._listeners[topic, node] = listener
                    self.received.setdefault(topic, ReceivedMessages())

    def _receive(self, key: tuple[str, str]) -> None:
        received = self.received[key[0]]
        try:
            messages = self._listeners[key].receive()
        except NoTopic:
            self._listeners.pop(key).close()
            return
        received.times.extend([time.monotonic()] * len(messages))
        if key[0] in TF_TOPICS:
            received.frames.update(*(read_frames(message) for message in messages))


_PATIENCE = 5.0  # s; a busy computer answers late, and a port without a listener refuses at once
_MAX_DEPTH = 64


def examine_exit(event: Exited, master: Master) -> Event:
    """Return Evicted in place of Exited if a process of another run answers under the node's name."""
    try:
        asked = Master(master.uri, master.host, master.port, _PATIENCE)
        node = parse_master_uri(str(asked.call("lookupNode", event.name)))
        pid = int(Master(node.uri, node.host, node.port, _PATIENCE).call("getPid"))
    except (Unanswered, CallRefused, UserError, ValueError, TypeError):
        return event
    if not is_local_address(node.host):
        return Evicted(event.name, event.status, f"process {pid} on {node.host}")
    ancestors = _list_ancestors(pid)
    if os.getpid() in ancestors:
        return event
    runs = list_runs(os.environ, os.getuid(), read_computer())
    run = next((each.run for each in runs if each.pid in ancestors), "")
    return Evicted(event.name, event.status, f"run {run}" if run else f"process {pid}")


def _list_ancestors(pid: int) -> list[int]:
    found: list[int] = []
    while pid > 1 and len(found) < _MAX_DEPTH:
        found.append(pid)
        try:
            with open(f"/proc/{pid}/stat", "rb") as file:  # noqa: PTH123 - as in ur.run.record.registry
                pid = int(file.read().rpartition(b")")[2].split()[1])
        except (OSError, ValueError, IndexError):
            break
    return found
