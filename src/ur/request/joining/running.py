"""Launches beside running nodes at the master: join their runs, start the missing nodes, replace none."""

from __future__ import annotations

import os
import socket
import sys
import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import ExitStack
from typing import TYPE_CHECKING

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.request.launch_request import LaunchOptions, LaunchRequest, Report
from ur.run.join.decision import (
    Definition,
    Held,
    decide,
    define_nodes,
    find_free_names,
    find_localisers,
    leave_out,
    read_claims,
)
from ur.run.join.lock import MasterLock, lock_master
from ur.run.master.client import parse_master_uri
from ur.run.paths import is_local_address
from ur.run.record.registry import RunEntry, describe_user, list_runs, make_run_name, read_computer
from ur.run.startup.node_selection import may_drive
from ur.source.arguments import Argument
from ur.source.data_classes import dataclass, replace
from ur.source.diagnostic import Diagnostic, UserError, error, user_error
from ur.system.ros import NONE, graph_address, read_domain

if TYPE_CHECKING:
    from ur.request.plan_files import LoadedPlan
    from ur.run.join.decision import Decision
    from ur.run.remote.lease import Mode, RobotLease

_ANSWERS: Mapping[str, Mode | None] = {"w": "watch", "a": "ask", "t": "take", "q": None}
_LOST_ANSWERS: Mapping[str, Mode | None] = {"w": "watch", "t": "take", "q": None}


def computer_name() -> str:
    """Return the name of this computer as others see it."""
    return socket.gethostname().partition(".")[0]


def rename_taken(plan: Plan, robot: str, report: Report) -> Plan:
    """Rename nodes of this computer whose name a node on another computer has, and report it.

    `robot` is the machine of the nodes that start on the robot.
    """
    address = graph_address(os.environ)
    if read_domain(address) is not None:
        return plan
    from ur.run.remote.names import choose_names, describe_names, find_taken, rename_nodes

    master = parse_master_uri(address)
    ours = [node.full_name for node in plan.nodes if not robot or node.machine != robot]
    names = choose_names(ours, computer_name(), lambda wanted: find_taken(wanted, master, is_local_address))
    for line in describe_names(names):
        report("info", line)
    return rename_nodes(plan, names)


def choose_mode(
    options: LaunchOptions,
    robot: str,
    nodes: Sequence[NodeSpec],
    name: str,
    ask: Callable[[str], str] | None = None,
    read: Callable[[str], RobotLease] | None = None,
) -> Mode | None:
    """Choose the mode on a robot; None if the user at the terminal cancels.

    A driver that is out of range still has the lease, since its run continues; taking over requires a decision of the
    user. Raises UserError if another client drives, no option sets the mode, and there is no terminal.
    """
    if options.mode != "drive" or not may_drive(nodes):
        return options.mode
    from ur.run.remote.lease import belongs_to_other, describe_lease, read_lease  # only with a robot
    from ur.run.remote.own_clients import clients_folder, list_clients

    lease = (read or read_lease)(graph_address(os.environ))
    computer = describe_user(read_computer(), os.getuid())
    if not belongs_to_other(lease, name, computer, list_clients(clients_folder(os.environ, os.getuid()))):
        return "drive"
    if ask is None and (options.detach or options.json or not (sys.stdin.isatty() and sys.stderr.isatty())):
        raise refuse(lease, robot)
    return ask_mode(describe_lease(lease, robot, time.time()), ask or _ask, lost=lease.state == "lost")


def ask_mode(description: str, ask: Callable[[str], str], *, lost: bool = False) -> Mode | None:
    """Ask until the answer is one of those offered; the end of the input means to quit.

    If the driver is `lost`, asking it for the lease is not offered, since it would not answer.
    """
    answers = _LOST_ANSWERS if lost else _ANSWERS
    question = f"{description}\n  [w]atch, {'' if lost else '[a]sk to drive, '}[t]ake over, [q]uit? "
    while True:
        try:
            answer = ask(question).strip().lower()
        except EOFError:
            return None
        if answer[:1] in answers:
            return answers[answer[:1]]
        *first, last = answers
        question = f"  expected {', '.join(first)} or {last}: "


def refuse(lease: RobotLease, robot: str) -> UserError:
    """Return the error that another client drives the robot, or drove it and is out of range."""
    from ur.run.remote.lease import describe_lease

    return user_error(
        f"{describe_lease(lease, robot, time.time())}, expected a robot that no client drives",
        rule="robot-is-driven",
        help="add --watch or --take-over" if lease.state == "lost" else "add --watch, --ask or --take-over",
    )


def _ask(question: str) -> str:
    sys.stderr.write(question)
    sys.stderr.flush()
    line = sys.stdin.readline()
    if not line:
        raise EOFError
    return line


_WORLDS = "/n_simulator/worlds/"
_STOP_SECONDS = 10.0
_ROBOT_ARGUMENTS = {"robot_base": 0, "robot_variant": 1}  # indexes into the result of `read_facts`


def lock_launch(options: LaunchOptions, stack: ExitStack, report: Report) -> MasterLock:
    """Lock out other launches of this user at the same master, until `stack` closes or the lock is released.

    A robot's share of a run, and a launch of a master alone, do not wait for other launches.
    """
    if options.part is not None or options.core:
        return MasterLock()
    uri = find_master_uri(options)
    return stack.enter_context(lock_master(uri, os.environ, os.getuid(), lambda text: report("info", text)))


def find_master_uri(options: LaunchOptions) -> str:
    """Return the address of the master of a launch, or of its domain of ROS 2."""
    uri = graph_address(os.environ)
    return uri if options.port is None or read_domain(uri) else f"http://{parse_master_uri(uri).host}:{options.port}"


def follow_world(request: LaunchRequest) -> LaunchRequest:
    """Add the world of the running simulated robot, if the arguments do not set it."""
    options = request.options
    if options.part is not None or options.core or request.values.keys() & {"world", "world_file"}:
        return request
    names = [name for entry in _list_runs(find_master_uri(options)) if (name := _find_world(entry))]
    if not names or "world" not in request.files.declared:
        return request
    return request.add_arguments([Argument("world", names[0])])


def refuse_second_master() -> None:
    """Raise UserError if a launch of a master alone is useless: one is already running, or ROS 2 has none."""
    from ur.run.master.xml_rpc import Unanswered

    if read_domain(uri := graph_address(os.environ)) is not None:
        raise user_error("--core starts a master; ROS 2 has none", rule="bad-options", help="ur run PROGRAM")
    master = parse_master_uri(uri)
    try:
        master.get_run_id()
    except Unanswered:
        return
    raise user_error(
        f"--core: a master runs already at {master.uri}", rule="second-master", help="ur ps", subject=master.uri
    )


def join_running(loaded: LoadedPlan, report: Report) -> tuple[Plan, tuple[RunEntry, ...]]:
    """Return the plan without running nodes, and the runs of this user on this computer that it joins.

    Raises UserError if a node would end, two nodes would publish the same transform, the running robot differs from the
    requested one, or every node of this computer is already running.
    """
    plan, robot = loaded.plan, loaded.robot
    assert plan is not None
    ours = [node.full_name for node in plan.nodes if not robot or node.machine != robot]
    uri = find_master_uri(loaded.request.options)
    entries = {entry.run: entry for entry in _await_stopping(_list_runs(uri), report)}
    selection = loaded.request.selection
    _check_localisers(plan, ours, entries.values())
    held = _find_held(ours, entries.values(), uri, elsewhere=selection is not None and not selection.simulated)
    if not held:
        return plan, ()
    from ur.run.remote.names import rename_nodes

    decision = decide(plan, held)
    _check_refused(decision, declares_bring_up="bring_up" in loaded.request.files.declared)
    _check_arguments(loaded, decision, uri)
    if decision.joined and len(decision.joined) == len(ours):
        raise _explain_nothing_left(decision)
    owners = tuple(entries[run] for run in dict.fromkeys(each.run for each in decision.joined) if run)
    for line in describe_join(decision):
        report("info", line)
    _await_owners(owners, report)
    names = find_free_names(
        [each.name for each in decision.renamed], [*ours, *(name for entry in owners for name in _list_nodes(entry))]
    )
    for each in decision.renamed:
        where = f"in run {each.run}" if each.run else "already"
        report("info", f"{each.name} runs {where}, so this one is called {names[each.name]}")
    return rename_nodes(leave_out(plan, decision), names), owners


def describe_join(decision: Decision) -> list[str]:
    """Describe the joined runs: 'joining the robot that m_wander.7952 started'."""
    lines = [
        f"joining the robot that {run} started" if run else "joining the robot that runs already"
        for run in dict.fromkeys(each.run for each in decision.base)
    ]
    for run in dict.fromkeys(each.run for each in decision.used):
        names = ", ".join(each.name for each in decision.used if each.run == run)
        lines.append(f"using {names} of {run}")
    return lines


def _list_runs(uri: str) -> list[RunEntry]:
    runs = list_runs(os.environ, os.getuid(), read_computer())
    if not runs:
        return []
    from ur.run.remote.names import is_same_master

    return [entry for entry in runs if is_same_master(entry.master_uri, uri)]


def _await_stopping(entries: Sequence[RunEntry], report: Report) -> list[RunEntry]:
    """Wait for stopping runs to end, within a time limit; return the runs that continue."""
    left = []
    for entry in entries:
        from ur.run.remote.local_runs import is_stopping, wait_exit

        if is_stopping(entry):
            report("info", f"waiting for the end of {entry.run}, which is stopping")
            if wait_exit(entry, time.monotonic() + _STOP_SECONDS):
                continue
        left.append(entry)
    return left


def _find_world(entry: RunEntry) -> str:
    claims = read_claims(entry.folder)
    path = next((file for name in claims.base if (file := claims.nodes.get(name, {}).get("param world_file", ""))), "")
    name = path.rpartition(_WORLDS)[2].removesuffix(".yaml")
    return name if _WORLDS in path and "/" not in name else path


def _find_held(names: Collection[str], entries: Iterable[RunEntry], uri: str, *, elsewhere: bool) -> list[Held]:
    """Return the nodes, of these, that are running; with `elsewhere`, without those of other computers."""
    found: dict[str, tuple[str, Definition | None]] = {}
    for entry in entries:
        claims = read_claims(entry.folder)
        running = _list_nodes(entry)
        found |= {name: (entry.run, claims.nodes.get(name)) for name in names if name in running}
    rest = [name for name in names if name not in found]
    found |= dict.fromkeys(_find_foreign(rest, uri, elsewhere=elsewhere), ("", None))
    return [Held(name, *facts) for name, facts in found.items()]


def _list_nodes(entry: RunEntry) -> frozenset[str]:
    from ur.run.clients.client import RunUnreachable, connect_run
    from ur.run.remote.local_runs import list_nodes

    try:
        connect_run(entry.folder).close()
    except RunUnreachable:
        return frozenset()
    return list_nodes(entry) or frozenset(read_claims(entry.folder).nodes)


def _find_foreign(names: Sequence[str], uri: str, *, elsewhere: bool) -> list[str]:
    from ur.run.master.xml_rpc import CallRefused, Unanswered

    if not names or read_domain(uri) is not None:  # ROS 2 ends no node for another of its name
        return []
    master = replace(parse_master_uri(uri), timeout=1.0)
    try:
        live = master.find_live_nodes(names)
    except (Unanswered, CallRefused, ValueError, TypeError):
        return []
    if not live or not elsewhere:
        return live
    from ur.run.remote.names import find_taken

    away = find_taken(live, master, is_local_address)
    return [name for name in live if name not in away]


def _check_localisers(plan: Plan, ours: Collection[str], entries: Iterable[RunEntry]) -> None:
    planned = find_localisers(define_nodes([node for node in plan.nodes if node.full_name in ours], plan.params))
    problems = []
    for entry in entries if planned else ():
        running = find_localisers(read_claims(entry.folder).nodes)
        alive = _list_nodes(entry) if running else frozenset()
        problems += [
            error(
                f"{name.strip('/')} of {entry.run} publishes {frames[0]} -> {frames[1]} already, and so would "
                f"{own.strip('/')}; expected one of them for a robot",
                rule="node-runs-already",
                help=f"'ur stop {entry.run}' ends it; --replace starts {own.strip('/')} beside it",
                subject=name,
            )
            for own, wanted in planned.items()
            for name, frames in running.items()
            if name in alive and name != own and frames[1] == wanted[1]
        ]
    if problems:
        raise UserError(*problems)


def _check_refused(decision: Decision, *, declares_bring_up: bool) -> None:
    problems: list[Diagnostic] = []
    for run in dict.fromkeys(each.run for each in decision.refused):
        names = [each.name for each in decision.refused if each.run == run]
        of = f" of run {run}" if run else ", which 'ur' has not started here,"
        stop = f"'ur stop {run}' ends it" if run else f"'rosnode kill {' '.join(names)}' ends what runs"
        leave = " ".join(f"--except {name}" for name in names)
        also = ", bring_up:=false leaves the robot out" if declares_bring_up and decision.base else ""
        problems.append(
            error(
                f"{', '.join(names)}{of} would end, expected nodes that do not run yet",
                rule="node-runs-already",
                help=f"{stop}; {leave} leaves out what runs{also}; --replace starts it anyway, as roslaunch does",
            )
        )
    if problems:
        raise UserError(*problems)


def _check_arguments(loaded: LoadedPlan, decision: Decision, uri: str) -> None:
    """Raise UserError for an argument that the running robot contradicts."""
    if not decision.base or not loaded.request.arguments:
        return
    run = next((each.run for each in decision.base if each.run), "")
    robot = f"the robot that {run} started" if run else "the robot that runs already"
    stop = f"'ur stop {run}' ends that robot" if run else "stop that robot first"
    problems = [
        error(
            f"{argument!r} is not possible: {robot} has {name} {value!r}",
            rule="robot-runs-already",
            help=f"{stop}; to join it leave {argument} out, or give bring_up:=false",
            subject=argument,
        )
        for argument, name, value in _list_misfits(loaded, decision, uri)
    ]
    if problems:
        raise UserError(*problems)


def _list_misfits(loaded: LoadedPlan, decision: Decision, uri: str) -> list[tuple[str, str, str]]:
    from ur.launchfile.load import load_plan
    from ur.request.bases.robot_facts import read_facts
    from ur.request.plan_files import texts
    from ur.run.join.decision import find_misfits

    assert loaded.plan is not None
    files = loaded.request.files
    facts = read_facts(uri)
    found = []
    varied = {}
    for given in loaded.request.arguments:
        text = str(given)
        if given.name in _ROBOT_ARGUMENTS:
            if facts is not None and facts[_ROBOT_ARGUMENTS[given.name]] != given.value:
                found.append((text, given.name, facts[_ROBOT_ARGUMENTS[given.name]]))
            continue
        rest = [each for each in texts(loaded.arguments) if each != text]
        # Left out it has its default, which may be what was given; with one more digit it is another text or number.
        changes = (rest, [*rest, f"{text}0"])
        varied[text] = [load_plan(files.paths, more, files.world, parsed=files.parsed) for more in changes]
    if found:
        return found
    misfits: dict[str, tuple[str, str, str]] = {}
    for each in find_misfits(loaded.plan, decision, varied):
        value = each.value.rpartition("/")[2] if _WORLDS in each.value else each.value
        name = each.item.removeprefix("param ")
        misfits.setdefault(each.argument, (each.argument, f"{each.node}/{name}", value))
    return list(misfits.values())


def _explain_nothing_left(decision: Decision) -> UserError:
    runs = [run for run in dict.fromkeys(each.run for each in decision.joined) if run]
    names = ", ".join(each.name for each in decision.joined)
    if not runs:
        message = f"{names} run already, expected a node to start"
        return user_error(message, rule="node-runs-already", help="rosnode list", subject=names)
    return user_error(
        f"all nodes of this launch file already run in {', '.join(runs)}: {names}",
        rule="node-runs-already",
        help=f"'ur attach {runs[0]}' shows it, 'ur stop {runs[0]}' ends it; --replace starts it anew",
    )


def _await_owners(owners: Iterable[RunEntry], report: Report) -> None:
    from ur.run.join.owner import await_owner

    for entry in owners:
        if not await_owner(entry, lambda text: report("info", text)):
            raise user_error(
                f"{entry.run} has ended, or has not started, while this program was to join it",
                rule="run-gone",
                help="ur ps --ended; then start this program again",
                subject=entry.run,
            )


@dataclass(frozen=True, slots=True)
class Joined:
    """A plan whose nodes have free names, without those that are already running in the runs `owners`.

    `environment` are the variables that describe this run as a client to its nodes on this computer.
    """

    plan: Plan
    environment: Mapping[str, str]
    owners: tuple[RunEntry, ...] = ()


def join(loaded: LoadedPlan, client: str, report: Report) -> Joined | None:
    """Decide which nodes start beside those that are already running at the master. `client` is the id of this run.

    None: another client drives, and the user cancels. Raises UserError if a running node would end, all nodes are
    already running, or another client drives and there is no terminal.
    """
    plan, options, selection = loaded.plan, loaded.request.options, loaded.request.selection
    assert plan is not None
    simulated = selection is None or selection.simulated
    owners: tuple[RunEntry, ...] = ()
    if read_domain(graph_address(os.environ)) == NONE:
        from ur.run.middleware.one_process import refuse_second_run

        refuse_second_run(os.environ)
    elif not options.replace and plan.nodes:
        plan, owners = join_running(loaded, report)
    mode = options.mode
    if selection is not None and not simulated:
        plan = rename_taken(plan, loaded.robot, report)
        chosen = choose_mode(options, selection.robot, plan.nodes, computer_name())
        if chosen is None:
            return None
        mode = chosen
    environment = describe_client(client, mode, plan, simulated=simulated, unattended=options.unattended)
    return Joined(plan, environment, owners)


def describe_client(client: str, mode: Mode, plan: Plan, *, simulated: bool, unattended: bool) -> Mapping[str, str]:
    """Return the variables that `ur_nodes.motion.lease.view` reads; empty if no node can drive."""
    if simulated and mode == "drive" and not unattended and not may_drive(plan.nodes):
        return {}
    title, _ = make_run_name(plan.files, 0)
    return {
        "UR_CLIENT": client,
        "UR_CLIENT_NAME": os.uname().nodename.partition(".")[0],
        "UR_COMPUTER": describe_user(read_computer(), os.getuid()),
        "UR_PROGRAM": title.removeprefix("m_"),
        "UR_LEASE": mode,
        "UR_ATTENDED": "0" if unattended else "1",
    }
