"""From a plan to a run: what is left out, which programs there are, the master, and then the loop."""

from __future__ import annotations

import os
import shutil
import socket
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from ur.launchfile.plan.model import NodeSpec, ParamValue, Plan
from ur.launchfile.world import World
from ur.run.command import Program, find_programs
from ur.run.console import Console
from ur.run.debian import describe_install
from ur.run.happenings import Event, MasterAnswered, ParametersSet, SetupFailed, Unregistered
from ur.run.loop import run_loop
from ur.run.master import DEFAULT_PORT, Master, parse_master_uri
from ur.run.model import Limits, Unit
from ur.run.parameters import CommandParameters, check_sendable, plain_values, start_commands
from ur.run.places import is_local_address, make_home, make_run_folder, new_run_id
from ur.run.processes import ProcessHost
from ur.run.registry import RunEntry, make_run_name, read_birth, register_run, unregister_run
from ur.run.run import Run, WatchPlan
from ur.run.terminal import find_terminal, ignore_background_write
from ur.run.xml_rpc import Refused, Unanswered
from ur.source.diagnostic import Diagnostic, UserError, error

if TYPE_CHECKING:
    from ur.run.events import RunStarted
    from ur.run.timings import Timings

MASTER = "master"
ROSOUT = "/rosout"
VIEWERS = ("rviz", "image_view")  # packages whose nodes need a display
MASTER_WORKERS = 3  # rosmaster.master_api.NUM_WORKERS


@dataclass(frozen=True, slots=True)
class Options:
    """What the command line says beside the launch file. `base` and `variant` describe the selected robot."""

    limits: Limits = field(default_factory=Limits)
    force_screen: bool = False
    force_log: bool = False
    force_required: bool = False
    wait_for_master: bool = False
    port: int | None = None
    workers: int | None = None
    master_words: tuple[str, ...] = ()  # more options for rosmaster
    base: str = ""
    variant: str = ""
    viewer: socket.socket | None = None  # see ur.run.run.WatchPlan
    events: int | None = None
    timings: Timings | None = None
    call_started: Callable[[RunEntry], None] | None = None  # the run is detached: called once every node was started


def run_plan(plan: Plan, world: World, host: ProcessHost, console: Console, options: Options) -> int:
    """Run a plan without errors to its end and return the exit code.

    Raises UserError before anything is started: an executable that is missing, a node for another computer, a value
    that no parameter can hold, no master on the selected robot, no place for log files.
    """
    environment = dict(world.environment)
    nodes, notes = leave_out_viewers(plan.nodes, world, environment)
    for note in notes:
        console.warn(note)
    nodes = tuple(_forced(node, options) for node in nodes)
    problems = list(_remote_nodes(plan, nodes))
    programs, missing = find_programs(nodes, world, first_number=2)
    problems += missing
    if problems:
        raise UserError(*problems)
    check_sendable(plan.params)
    if sum(node.terminal for node in nodes) > 1:
        raise UserError(*_several_terminals(nodes))
    if options.call_started is not None:
        _refuse_terminals(nodes)

    master = _find_master(environment, options)
    run_id = _read_run_id(master, options, console)
    own_master = run_id is None
    if options.timings is not None:
        options.timings.mark("master asked")
    core = _core_programs(master, world, options) if own_master else ()
    environment["ROS_MASTER_URI"] = master.uri
    folder = make_run_folder(environment, run_id or (fresh := new_run_id()))
    home = make_home(environment)
    extra: dict[str, ParamValue] = {}
    if own_master:
        extra = {"/run_id": fresh, **_core_parameters(world, environment)}
        extra |= {"/ur/base_name": options.base, "/ur/variant": options.variant} if options.base else {}
    elif run_id == "":
        extra = {"/run_id": Path(folder).name}
    if not programs and not own_master:
        set_ = _try_parameters(plan, master, extra, start_commands(plan.params, environment))
        if isinstance(set_, SetupFailed):
            raise UserError(error(set_.reason, rule="setup-failed"))
        console.inform("parameters are set; there is no node to start")
        console.finish(1.0)
        return 0

    here = _register(plan, master, folder, environment, console, detached=options.call_started is not None)
    host.begin(environment, keep_terminal=any(node.terminal for node in nodes))
    terminal = find_terminal() if options.call_started is None else None
    ignore_background_write()
    _announce(console, master, own_master=own_master, folder=folder, nodes=len(programs))
    commands = start_commands(plan.params, environment)
    try:
        run = Run(
            programs=(*core, *programs),
            folder=folder,
            home=home,
            own_master=own_master,
            await_master=lambda: _await_master(master, options.limits.master),
            set_parameters=lambda: _try_parameters(plan, master, extra, commands),
            unregister=lambda: _unregister(master, [node.full_name for node in nodes]),
            limits=options.limits,
            master=master,
            timings=options.timings,
            watch=_plan_watch(here, nodes, options),
        )
        return run_loop(run, host, console, terminal)
    finally:
        commands.stop()
        unregister_run(here[0])


_Registered = tuple[RunEntry, socket.socket | None]


def _register(
    plan: Plan, master: Master, folder: str, environment: Mapping[str, str], console: Console, *, detached: bool
) -> _Registered:
    pid = os.getpid()
    title, name = make_run_name(plan.files, pid)
    entry = RunEntry(
        name, pid, read_birth(pid) or 0, title, master.uri, folder, time.time(), detached, socket.gethostname()
    )
    made = register_run(entry, environment, os.getuid())
    if made is not None:
        return made
    if detached:
        raise UserError(
            error(
                "no private folder for the run can be made, so nobody could reach it once it is detached",
                rule="bad-state-folder",
                help="XDG_STATE_HOME chooses another place",
            )
        )
    console.warn("this run is not listed by 'ur ps': no private folder for it can be made (XDG_STATE_HOME)")
    return entry, None


def _plan_watch(here: _Registered, nodes: tuple[NodeSpec, ...], options: Options) -> WatchPlan:
    entry, listener = here
    call = options.call_started

    def describe() -> RunStarted:
        from ur.run.events import RunStarted  # only for those who watch

        return RunStarted(
            run=entry.run,
            pid=entry.pid,
            title=entry.title,
            master_uri=entry.master_uri,
            log_folder=entry.log_folder,
            started=entry.started,
            detached=entry.detached,
            terminal=next((node.full_name for node in nodes if node.terminal), ""),
        )

    return WatchPlan(
        describe=describe,
        listener=listener,
        viewer=options.viewer,
        events=options.events,
        unattended=call is not None,
        call_started=None if call is None else lambda: call(entry),
    )


def _refuse_terminals(nodes: tuple[NodeSpec, ...]) -> None:
    problems = [
        error(
            f"{node.full_name} needs the terminal, which a detached run does not have",
            node.origin.span,
            rule="detached-terminal",
            help="leave --detach out, or this node: --except " + node.full_name,
        )
        for node in nodes
        if node.terminal
    ]
    if problems:
        raise UserError(*problems)


def leave_out_viewers(
    nodes: tuple[NodeSpec, ...], world: World, environment: Mapping[str, str]
) -> tuple[tuple[NodeSpec, ...], tuple[str, ...]]:
    """The nodes that can be shown here, and one line for each reason why others are left out."""
    viewers = [node for node in nodes if node.package in VIEWERS]
    if viewers and not environment.get("DISPLAY") and not environment.get("WAYLAND_DISPLAY"):
        left_out, notes = viewers, [f"no display: {_names(viewers)} left out"]
    else:
        left_out = [node for node in viewers if not _is_installed(node, world)]
        notes = [
            f"package {package} is not installed: {_names(nodes_of)} left out ({describe_install(package)})"
            for package in VIEWERS
            if (nodes_of := [node for node in left_out if node.package == package])
        ]
    return tuple(node for node in nodes if node not in left_out), tuple(notes)


def _names(nodes: Sequence[NodeSpec]) -> str:
    return ", ".join(node.full_name for node in nodes)


def _is_installed(node: NodeSpec, world: World) -> bool:
    try:
        return bool(world.find_executables(node.package, node.type))
    except LookupError:
        return False


def _forced(node: NodeSpec, options: Options) -> NodeSpec:
    if options.force_screen:
        node = replace(node, output="screen")
    if options.force_log:
        node = replace(node, output="log")
    return replace(node, required=True) if options.force_required and not node.respawn else node


def _remote_nodes(plan: Plan, nodes: tuple[NodeSpec, ...]) -> list[Diagnostic]:
    machines = {machine.name: machine for machine in plan.machines}
    local: dict[str, bool] = {}
    problems = []
    for node in nodes:
        machine = machines.get(node.machine or "")
        address = machine.address if machine else (node.machine or "")
        if address not in local:
            local[address] = is_local_address(address)
        if not local[address]:
            problems.append(
                error(
                    f"{node.full_name}: machine {node.machine!r} ({address}) is another computer, expected this one",
                    node.origin.span,
                    rule="remote-machine",
                    help="ur launch starts nodes on this computer only; roslaunch starts them over ssh",
                )
            )
    return problems


def _several_terminals(nodes: tuple[NodeSpec, ...]) -> list[Diagnostic]:
    names = [node for node in nodes if node.terminal]
    return [
        error(
            f"{node.full_name}: {names[0].full_name} has the terminal already, expected one such node",
            node.origin.span,
            rule="several-terminals",
        )
        for node in names[1:]
    ]


def _find_master(environment: Mapping[str, str], options: Options) -> Master:
    master = parse_master_uri(environment.get("ROS_MASTER_URI") or f"http://localhost:{DEFAULT_PORT}")
    if options.port is None:
        return master
    return parse_master_uri(f"http://{master.host}:{options.port}")


def _read_run_id(master: Master, options: Options, console: Console) -> str | None:
    """The run id of the master that is there, '' when it has none; None when we may start one."""
    told = False
    while True:
        try:
            return master.get_run_id() or ""
        except Unanswered as problem:  # noqa: PERF203 - asking again is the point
            if not options.wait_for_master:
                if is_local_address(master.host):
                    return None
                raise UserError(
                    error(
                        f"no ROS master answers at {master.uri}: {problem}",
                        rule="no-master",
                        help="is the robot on and in this network? 'ur use sim' selects the simulated robot",
                    )
                ) from None
            if not told:
                console.warn(f"waiting for the master at {master.uri}")
                console.finish(1.0)
                told = True
            time.sleep(0.1)


def _core_programs(master: Master, world: World, options: Options) -> tuple[Program, ...]:
    rosmaster = shutil.which("rosmaster", path=world.environment.get("PATH"))
    try:
        rosout = world.find_executables("rosout", "rosout")
    except LookupError:
        rosout = ()
    for found, package in ((rosmaster, "python3-rosmaster"), (rosout, "rosout")):
        if not found:
            raise UserError(
                error(
                    f"no ROS master answers at {master.uri}, and package {package}, which starts one, is not installed",
                    rule="no-master",
                    help=f"sudo apt-get install {package}",
                )
            )
    assert rosmaster is not None
    argv = (
        rosmaster,
        "--core",
        "-p",
        str(master.port),
        "-w",
        str(options.workers or MASTER_WORKERS),
        *options.master_words,
    )
    return (
        Program(Unit(MASTER, core=True, required=True), argv, log_name="master"),
        Program(
            Unit(ROSOUT, core=True, respawn=True),
            (rosout[0], "__name:=rosout"),
            (("ROS_NAMESPACE", None),),
            log_name="rosout-1",
        ),
    )


def _core_parameters(world: World, environment: Mapping[str, str]) -> dict[str, ParamValue]:
    # What roscore.xml sets by running `rosversion`, line breaks included.
    version = ""
    try:
        text = world.read_bytes(world.find_package("roslaunch") + "/package.xml").decode("utf-8", "replace")
        version = text.partition("<version>")[2].partition("</version>")[0].strip()
    except (LookupError, OSError):
        version = "<unknown>"
    return {"/rosdistro": environment.get("ROS_DISTRO", "Debian") + "\n", "/rosversion": version + "\n"}


def _announce(console: Console, master: Master, *, own_master: bool, folder: str, nodes: int) -> None:
    console.inform(f"ROS_MASTER_URI={master.uri}" + (", master started here" if own_master else ""))
    console.inform(f"{nodes} node{'' if nodes == 1 else 's'}, log files in {folder}")
    if not nodes:
        console.warn("there is no node to start; the master runs until Ctrl-C")


def _await_master(master: Master, limit: float) -> Event:
    end = time.monotonic() + limit
    while time.monotonic() < end:
        try:
            master.call("getPid")
        except (Unanswered, Refused):  # noqa: PERF203 - asking again is the point
            time.sleep(0.01)
        else:
            return MasterAnswered()
    return SetupFailed(f"the master at {master.uri} did not answer within {limit:g} s")


def _try_parameters(plan: Plan, master: Master, extra: Mapping[str, ParamValue], commands: CommandParameters) -> Event:
    try:
        _set_parameters(plan, master, extra, commands)
    except UserError as problem:
        return SetupFailed(str(problem))
    except (Unanswered, Refused, ValueError) as problem:
        return SetupFailed(f"parameters cannot be set on the master at {master.uri}: {problem}")
    return ParametersSet()


def _set_parameters(plan: Plan, master: Master, extra: Mapping[str, ParamValue], commands: CommandParameters) -> None:
    for each in plan.commands:
        if each.command == "dump":
            _dump_parameters(master, each.name, each.file or "")
        else:
            try:
                master.call("deleteParam", each.name)
            except Refused:
                continue  # not there
    values = plain_values(plan.params)
    printed = commands.collect()
    ordered = {spec.name: printed[spec.name] if spec.name in printed else values[spec.name] for spec in plan.params}
    master.set_parameters({**extra, **ordered}, plan.clear_params)


def _dump_parameters(master: Master, name: str, file: str) -> None:
    import yaml  # only for <rosparam command="dump">

    try:
        Path(file).write_text(yaml.safe_dump(master.call("getParam", name)), encoding="utf-8")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error(f"{file}: parameters cannot be written: {reason}", rule="bad-dump")) from None


def _unregister(master: Master, names: list[str]) -> Event:
    with suppress(Unanswered, Refused):  # a master that is gone has nothing registered
        master.remove_dead_nodes(names)
    return Unregistered()
