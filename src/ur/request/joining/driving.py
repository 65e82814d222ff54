"""Mode of a run if another client drives the selected robot: from the options, or from the user at the terminal."""

import os
import socket
import sys
import time
from collections.abc import Callable, Mapping, Sequence

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.request.launch_request import LaunchOptions, Report
from ur.run.master.client import parse_master_uri
from ur.run.paths import is_local_address
from ur.run.record.registry import describe_user, read_computer
from ur.run.remote.lease import Mode, RobotLease, belongs_to_other, describe_lease, read_lease
from ur.run.remote.names import choose_names, describe_names, find_taken, rename_nodes
from ur.run.remote.own_clients import clients_folder, list_clients
from ur.run.startup.node_selection import may_drive
from ur.source.diagnostic import UserError, error
from ur.system.ros import graph_address, read_domain

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
    read: Callable[[str], RobotLease] = read_lease,
) -> Mode | None:
    """Choose the mode on a robot; None if the user at the terminal cancels.

    A driver that is out of range still has the lease, since its run continues; taking over requires a decision of the
    user. Raises UserError if another client drives, no option sets the mode, and there is no terminal.
    """
    if options.mode != "drive" or not may_drive(nodes):
        return options.mode
    lease = read(graph_address(os.environ))
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
    return UserError(
        error(
            f"{describe_lease(lease, robot, time.time())}, expected a robot that no client drives",
            rule="robot-is-driven",
            help="add --watch or --take-over" if lease.state == "lost" else "add --watch, --ask or --take-over",
        )
    )


def _ask(question: str) -> str:
    sys.stderr.write(question)
    sys.stderr.flush()
    line = sys.stdin.readline()
    if not line:
        raise EOFError
    return line
