"""What base the selected robot is, from whoever knows: its parameter server, the selection, or its own file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from ur.request.environment import environment_changes
from ur.robot.robot_file import RobotFile, load_robot_file
from ur.robot.selection import Selection

BASE_NAME = "/ur/base_name"
VARIANT = "/ur/variant"
_PATIENCE = 1.0  # s

Facts = tuple[str, str]
"""A base and its variant ('' is the plain one)."""


def know_base(
    selection: Selection,
    environment: Mapping[str, str],
    *,
    ask: Callable[[str], Facts | None] | None = None,
    robot_file: Callable[[], RobotFile | None] = load_robot_file,
) -> Selection:
    """The selection with the base and variant of its robot, as far as somebody knows them; `ask` is `read_facts`.

    A robot that runs knows best: what its parameter server says goes before a simulated robot that is only selected. A
    base that was selected together with a real robot stays. On the robot itself its file is read where no master runs.
    """
    from ur.request.plan_files import is_this_computer

    ask = ask or read_facts
    environment = dict(environment)
    if selection.base and not selection.simulated:
        return selection
    facts = ask((environment | environment_changes(selection, environment))["ROS_MASTER_URI"])
    if facts is not None:
        return replace(selection, base=facts[0], variant=facts[1])
    if selection.base or not is_this_computer(selection.robot):
        return selection
    found = robot_file()
    return replace(selection, base=found.base, variant=found.variant) if found else selection


def read_facts(master_uri: str) -> Facts | None:
    """`/ur/base_name` and `/ur/variant` from a parameter server. None: nobody answers there, or they are not set."""
    from ur.run.master.client import Master, parse_master_uri
    from ur.run.master.xml_rpc import Refused, Unanswered
    from ur.source.diagnostic import UserError

    try:
        asked = parse_master_uri(master_uri)
        master = Master(asked.uri, asked.host, asked.port, _PATIENCE)
        base, variant = master.call_many([("getParam", (BASE_NAME,)), ("getParam", (VARIANT,))])
    except (Unanswered, Refused, UserError, ValueError, TypeError):
        return None
    if not isinstance(base, str) or not base:
        return None
    return base, variant if isinstance(variant, str) else ""
