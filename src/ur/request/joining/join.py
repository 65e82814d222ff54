"""Joining of running nodes before the start: nodes that would end others, and the client that drives."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ur.launchfile.plan.specs import Plan
from ur.system.ros import NONE, graph_address, read_domain

if TYPE_CHECKING:
    from ur.request.options import Report
    from ur.request.plan_files import LoadedPlan
    from ur.run.record.registry import RunEntry
    from ur.run.remote.lease import Mode


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
        from ur.request.joining.running import join_running

        plan, owners = join_running(loaded, report)
    mode = options.mode
    if selection is not None and not simulated:
        from ur.request.joining.driving import choose_mode, computer_name, rename_taken

        plan = rename_taken(plan, loaded.robot, report)
        chosen = choose_mode(options, selection.robot, plan.nodes, computer_name())
        if chosen is None:
            return None
        mode = chosen
    environment = describe_client(client, mode, plan, simulated=simulated, unattended=options.unattended)
    return Joined(plan, environment, owners)


def describe_client(client: str, mode: Mode, plan: Plan, *, simulated: bool, unattended: bool) -> Mapping[str, str]:
    """Return the variables that `ur_nodes.motion.lease.view` reads; empty if no node can drive."""
    from ur.run.record.registry import describe_user, make_run_name, read_computer
    from ur.run.startup.node_selection import may_drive

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
