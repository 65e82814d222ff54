"""Joining what runs already: nodes that would end others, and whoever drives the robot, before anything starts."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ur.launchfile.plan.model import Plan
from ur.request.options import Wishes
from ur.robot.selection import Selection

if TYPE_CHECKING:
    from ur.request.plan_files import Loaded
    from ur.run.record.registry import RunEntry
    from ur.run.remote.lease import Mode


@dataclass(frozen=True, slots=True)
class Joined:
    """A plan whose nodes have names that nobody has, without those that run already in the runs `owners`.

    `environment` is what its nodes on this computer learn of this run as a client.
    """

    plan: Plan
    environment: Mapping[str, str]
    owners: tuple[RunEntry, ...] = ()


def join(loaded: Loaded, words: Sequence[str], selection: Selection, wishes: Wishes, client: str) -> Joined | None:
    """Decide what starts beside what runs at the master already. `words` are the arguments of the command line.

    None: somebody else drives, and the person at the terminal does not want to go on. Raises UserError: a node that
    runs would end, all of them run already, or somebody else drives and nobody can be asked what to do.
    """
    plan, robot = loaded.plan, loaded.robot
    assert plan is not None
    owners: tuple[RunEntry, ...] = ()
    if not wishes.replace and plan.nodes:
        from ur.request.running import join_running

        plan, owners = join_running(loaded, words, selection, wishes)
    mode = wishes.mode
    if not selection.simulated:
        from ur.cli.launch import driving

        plan = driving.rename_taken(plan, robot, wishes)
        chosen = driving.choose_mode(wishes, selection.robot, plan.nodes, driving.computer_name())
        if chosen is None:
            return None
        mode = chosen
    return Joined(plan, _describe_client(client, mode, plan, selection, wishes), owners)


def _describe_client(client: str, mode: Mode, plan: Plan, selection: Selection, wishes: Wishes) -> Mapping[str, str]:
    """The variables that `ur_nodes.motion.lease.view` reads; none where nothing can be driven."""
    from ur.run.record.registry import make_run_name
    from ur.run.startup.node_selection import may_drive

    if selection.simulated and mode == "drive" and not wishes.unattended and not may_drive(plan.nodes):
        return {}
    title, _ = make_run_name(plan.files, 0)
    return {
        "UR_CLIENT": client,
        "UR_CLIENT_NAME": os.uname().nodename.partition(".")[0],
        "UR_PROGRAM": title.removeprefix("m_"),
        "UR_LEASE": mode,
        "UR_ATTENDED": "0" if wishes.unattended else "1",
    }
