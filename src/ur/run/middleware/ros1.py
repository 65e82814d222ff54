"""A master of ROS 1 as the middleware of a run."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, ParamValue, Plan
from ur.launchfile.world import World
from ur.run.master.client import Master
from ur.run.master.local_master import await_master, find_master_programs, roscore_parameters
from ur.run.master.monitor import start_watch
from ur.run.master.parameters import CommandParameters
from ur.run.master.search import find_master, read_run_id
from ur.run.master.upload import remove_registrations, upload_parameters
from ur.run.middleware.protocol import GraphView
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.run.process.command import UnitProgram
from ur.run.supervisor.events import Event, Exited


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
        from ur.run.join.eviction import examine_exit  # only where a node has ended by itself

        return examine_exit(event, self.master)

    def watch(self, report: Callable[[Event], None]) -> threading.Event:
        return start_watch(self.master, report)

    def view(self) -> GraphView:
        from ur.run.middleware.master_view import MasterView  # only for those who wait

        return MasterView(self.master)


def find_ros1(environment: Mapping[str, str], world: World, options: RunOptions, console: Console) -> MasterMiddleware:
    """Find the master of a run, and the programs that start one if none runs. Raises UserError."""
    master = find_master(environment, options)
    run_id = read_run_id(master, options, console)
    if run_id is not None:
        return MasterMiddleware(master, False, run_id, (), {})
    programs = find_master_programs(master, world, options)
    return MasterMiddleware(master, True, "", programs, roscore_parameters(world, environment))
