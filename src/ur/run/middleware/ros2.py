"""A domain of ROS 2 as the middleware of a run: there is no master, and each node gets its parameters in a file."""

import fcntl
import os
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.run.master.parameters import CommandParameters
from ur.run.middleware.facts import add_parameters, clear_facts, read_facts, write_facts
from ur.run.middleware.parameter_files import file_name, format_parameters
from ur.run.middleware.protocol import GraphView
from ur.run.options import RunOptions
from ur.run.process.command import UnitProgram
from ur.run.process.described import write_files
from ur.run.record.registry import RunEntry, list_runs, read_computer
from ur.run.supervisor.events import Event, Exited, ParametersSet, SetupFailed, Unregistered
from ur.source.diagnostic import UserError, user_error
from ur.system.ros import find_facts, graph_address, parameters_file

_SETTLED = 5.0  # s: a new process has its lock by then

Domain = TypeVar("Domain", bound="DomainMiddleware")


@dataclass(frozen=True, slots=True)
class DomainMiddleware:
    """See `Middleware`. `facts` is the file of settings for all nodes of the domain."""

    address: str
    own: bool
    run_id: str
    facts: str
    variables: Mapping[str, str]
    core: tuple[UnitProgram, ...] = ()
    logs: int = 1

    @property
    def environment(self) -> Mapping[str, str]:
        return {"UR_FACTS": self.facts}

    def describe(self) -> str:
        reach = self.variables.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")
        where = "on this computer only" if reach == "LOCALHOST" else f"discovery range {reach}"
        distro = self.variables.get("ROS_DISTRO", "").capitalize()
        return f"ROS 2 {distro}, ROS_DOMAIN_ID={self.variables.get('ROS_DOMAIN_ID') or '0'}, {where}"

    def arrange(
        self, programs: tuple[UnitProgram, ...], nodes: Sequence[NodeSpec], folder: str
    ) -> tuple[UnitProgram, ...]:
        return tuple(
            replace(
                program,
                argv=(  # without the names that roslaunch appends
                    *program.argv[: len(program.argv) - len(node.remaps) - 1],
                    *arguments_of(node, file_name(folder, node.full_name)),
                ),
                changes=node.env,
                names_log=False,
            )
            if program.files is None
            else write_files(program, folder)
            for program, node in zip(programs, nodes, strict=True)
        )

    def await_core(self, limit: float) -> Event:  # noqa: ARG002 - nothing is waited for
        return SetupFailed("ROS 2 has no master to wait for")

    def set_parameters(self, plan: Plan, folder: str, options: RunOptions, commands: CommandParameters) -> Event:
        try:
            printed = commands.collect()
            # Nodes that are given parameters one by one have them in their arguments
            own = format_parameters(plan, printed) if plan.launcher == "roslaunch" else {}
            for name, text in own.items():
                Path(file_name(folder, name)).write_text(text, encoding="utf-8")
            add_parameters(
                parameters_file(self.facts), {each.name: printed.get(each.name, each.value) for each in plan.params}
            )
            if self.own:
                write_facts(
                    self.facts, {"run_id": Path(folder).name, "base_name": options.base, "variant": options.variant}
                )
        except UserError as problem:
            return SetupFailed(str(problem))
        except OSError as problem:
            return SetupFailed(f"parameters cannot be written to {folder}: {(problem.strerror or '').lower()}")
        return ParametersSet()

    def unregister(self, names: Sequence[str]) -> Event:  # noqa: ARG002 - a node that has ended is in no graph
        if self.own and not list_others(self.variables):
            clear_facts(self.facts)
        return Unregistered()

    def examine_exit(self, event: Exited) -> Event:
        """See Middleware. Nodes of ROS 2 may share a name, so that none is ended by another."""
        return event

    def watch(self, report: Callable[[Event], None]) -> threading.Event:  # noqa: ARG002 - nothing can be lost
        return threading.Event()

    def view(self) -> GraphView:
        from ur.run.middleware.helper_view import HelperView  # only for those who wait

        return HelperView(self.variables)


def find_ros2(environment: Mapping[str, str], options: RunOptions) -> DomainMiddleware:
    """Find the domain of a run, and other runs in it. Raises UserError for an option that ROS 2 does not support."""
    return find_domain(DomainMiddleware, environment, options)


def find_domain(kind: type[Domain], environment: Mapping[str, str], options: RunOptions) -> Domain:
    """Find the domain as `find_ros2` does, for a class of middleware."""
    if options.port is not None:
        message = f"--port {options.port} chooses the port of a master, which ROS 2 does not have"
        raise user_error(message, rule="bad-options", help="ROS_DOMAIN_ID chooses the domain")
    clear_shared_memory()
    address = graph_address(environment)
    facts = find_facts(environment, address.rpartition("/")[2])
    own = not list_others(environment)
    if own:
        clear_facts(facts)
    return kind(address, own, "" if own else str(read_facts(facts).get("run_id", "")), facts, environment)


def clear_shared_memory(folder: Path = Path("/dev/shm")) -> None:  # noqa: S108 - where Fast DDS has it
    """Remove the files of Fast DDS that killed processes of this user have left.

    As in `fastdds shm clean`: their owner holds a lock on the file that ends in `_el` or `_sl`.
    """
    for lock in (*folder.glob("fastdds_*_el"), *folder.glob("fastdds_*_sl")):
        try:
            descriptor = os.open(lock, os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
        except OSError:
            continue  # it has ended, or belongs to another user
        try:
            facts = os.fstat(descriptor)
            if facts.st_uid == os.getuid() and time.time() - facts.st_mtime > _SETTLED:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                used = lock.name[:-3]
                for name in (used, f"sem.{used}_mutex", lock.name):
                    (folder / name).unlink(missing_ok=True)
        except OSError:  # it is in use
            pass
        finally:
            os.close(descriptor)


def list_others(environment: Mapping[str, str], own: int | None = None) -> list[RunEntry]:
    """Return this user's runs in an environment's domain, except those of process `own` (default: this process)."""
    address = graph_address(environment)
    runs = list_runs(environment, os.getuid(), read_computer())
    return [each for each in runs if each.master_uri == address and each.pid != (own or os.getpid())]


def arguments_of(node: NodeSpec, parameters: str) -> tuple[str, ...]:
    """Return the arguments after the node's own: name, namespace, remaps, and the file of its parameters."""
    words = ["--ros-args", "-r", f"__node:={node.name}"]
    if namespace := node.namespace.rstrip("/"):
        words += ["-r", f"__ns:={namespace}"]
    for source, target in node.remaps:
        words += ["-r", f"{_name_of(source)}:={_name_of(target)}"]
    return (*words, "--params-file", parameters)


def _name_of(name: str) -> str:
    """Convert a name to ROS 2: '~goal' becomes '~/goal'."""
    return f"~/{name[1:].lstrip('/')}" if name.startswith("~") else name
