"""The interface between a run and its middleware, which `ros1` and `ros2` implement."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.run.process.command import UnitProgram
from ur.run.supervisor.events import Event, Exited
from ur.source.data_classes import dataclass, field

if TYPE_CHECKING:
    from ur.run.master.parameters import CommandParameters
    from ur.run.options import RunOptions

TF_TOPICS = ("/tf", "/tf_static")


class NoGraph(Exception):  # noqa: N818 - an answer
    """The middleware does not answer; the text is the reason."""


@dataclass(frozen=True, slots=True)
class RunGraph:
    """Nodes by topic and service: publishers, subscribers, and servers; `nodes` are those without any of these."""

    publishers: Mapping[str, Sequence[str]]
    subscribers: Mapping[str, Sequence[str]]
    services: Mapping[str, Sequence[str]]
    nodes: Collection[str] = ()

    def topics(self) -> set[str]:
        """Return the topics that have a publisher or a subscriber."""
        return {*self.publishers, *self.subscribers}

    def knows(self, node: str) -> bool:
        """Test for a registered node."""
        return node in self.nodes or any(
            node in nodes for kind in (self.publishers, self.subscribers, self.services) for nodes in kind.values()
        )


@dataclass(slots=True)
class ReceivedMessages:
    """Messages received on a topic: their times (monotonic, s), and their frames if it is a topic of tf."""

    times: deque[float] = field(default_factory=lambda: deque(maxlen=1000))
    frames: set[str] = field(default_factory=set)


class GraphView(Protocol):
    """Reads the graph, and subscribes to topics to detect that messages arrive; for use in one thread."""

    received: dict[str, ReceivedMessages]

    def look(self, topics: Collection[str]) -> RunGraph:
        """Return the present graph, and receive these topics from now on. Raises NoGraph."""

    def wait(self, seconds: float) -> None:
        """Record received messages for `seconds`."""

    def forget(self) -> None:
        """Stop receiving all topics."""


class Middleware(Protocol):
    """The middleware of a run, as the run needs it."""

    @property
    def address(self) -> str:
        """The address, for display and for other runs."""

    @property
    def own(self) -> bool:
        """Return whether this run starts it."""

    @property
    def run_id(self) -> str:
        """The id of the runs that share it; empty where this run chooses it."""

    @property
    def core(self) -> tuple[UnitProgram, ...]:
        """Return the programs that start the middleware."""

    @property
    def environment(self) -> Mapping[str, str]:
        """Return the environment variables of its nodes."""

    @property
    def logs(self) -> int:
        """The number of the first node's log file."""

    def describe(self) -> str:
        """Describe in one line how the nodes connect."""

    def arrange(
        self, programs: tuple[UnitProgram, ...], nodes: Sequence[NodeSpec], folder: str
    ) -> tuple[UnitProgram, ...]:
        """Return the programs of nodes with the middleware's command lines; `folder` is that of the run's files."""

    def await_core(self, limit: float) -> Event:
        """Wait at most `limit` s until the programs `core` are ready."""

    def set_parameters(self, plan: Plan, folder: str, options: RunOptions, commands: CommandParameters) -> Event:
        """Make the parameters of a plan known to its nodes."""

    def unregister(self, names: Sequence[str]) -> Event:
        """Remove registrations that nodes with these names have left behind."""

    def examine_exit(self, event: Exited) -> Event:
        """Return Evicted in place of Exited if another node has ended this one."""

    def watch(self, report: Callable[[Event], None]) -> threading.Event:
        """Report events of a middleware that another run owns, until the event is set."""

    def view(self) -> GraphView:
        """Create a view of the graph."""
