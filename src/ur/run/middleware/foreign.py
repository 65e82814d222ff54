"""No middleware of this run: another launcher starts what its nodes need."""

import threading
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.run.master.parameters import CommandParameters
from ur.run.middleware.protocol import GraphView, ReceivedMessages, RunGraph
from ur.run.options import RunOptions
from ur.run.process.command import UnitProgram
from ur.run.supervisor.events import Event, Exited, ParametersSet, SetupFailed, Unregistered
from ur.system.ros import graph_address


@dataclass(frozen=True, slots=True)
class ForeignMiddleware:
    """See `Middleware`."""

    address: str
    own: bool = False
    run_id: str = ""
    core: tuple[UnitProgram, ...] = ()
    logs: int = 1

    @property
    def environment(self) -> Mapping[str, str]:
        return {}

    def describe(self) -> str:
        return "another launcher, whose processes end with this one"

    def arrange(
        self,
        programs: tuple[UnitProgram, ...],
        nodes: Sequence[NodeSpec],  # noqa: ARG002 - as all below
        folder: str,  # noqa: ARG002
    ) -> tuple[UnitProgram, ...]:
        return programs

    def await_core(self, limit: float) -> Event:  # noqa: ARG002
        return SetupFailed("there is no master to wait for")

    def set_parameters(self, plan: Plan, folder: str, options: RunOptions, commands: CommandParameters) -> Event:  # noqa: ARG002
        return ParametersSet()

    def unregister(self, names: Sequence[str]) -> Event:  # noqa: ARG002
        return Unregistered()

    def examine_exit(self, event: Exited) -> Event:
        return event

    def watch(self, report: Callable[[Event], None]) -> threading.Event:  # noqa: ARG002
        return threading.Event()

    def view(self) -> GraphView:
        return EmptyView()


class EmptyView:
    """See `GraphView`. Nothing is known of nodes."""

    def __init__(self) -> None:
        self.received: dict[str, ReceivedMessages] = {}

    def look(self, topics: Collection[str]) -> RunGraph:  # noqa: ARG002
        return RunGraph({}, {}, {})

    def wait(self, seconds: float) -> None:
        time.sleep(seconds)

    def forget(self) -> None:
        self.received.clear()


def find_foreign(environment: Mapping[str, str]) -> ForeignMiddleware:
    """Return the middleware of a run of another launcher."""
    return ForeignMiddleware(graph_address(environment))
