"""The selected robot's base, from its parameter server, the selection, or robot.yaml."""

import os
import socket
from collections.abc import Callable, Iterable, Mapping

from ur.request.environment import environment_changes
from ur.request.launch_request import Report
from ur.robot.robot_file import RobotFile, load_robot_file
from ur.robot.selection import Selection
from ur.source.arguments import Argument
from ur.system.ros import find_facts, graph_address, read_domain

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
    """Return the selection with the base and variant of its robot, if known; `ask` is `read_facts`.

    The parameter server of a running robot takes precedence over a selected simulated robot. A base that was selected
    together with a real robot stays. On the robot itself, its file is read if no master runs.
    """
    from ur.request.plan_files import is_this_computer

    ask = ask or read_facts
    environment = dict(environment)
    if selection.base and not selection.simulated:
        return selection
    facts = ask(graph_address(environment | environment_changes(selection, environment)))
    if facts is not None:
        return selection._replace(base=facts[0], variant=facts[1])
    if selection.base or not is_this_computer(selection.robot):
        return selection
    found = robot_file()
    return selection._replace(base=found.base, variant=found.variant) if found else selection


def read_facts(master_uri: str) -> Facts | None:
    """Read `/ur/base_name` and `/ur/variant` from a parameter server; None without an answer, or if they are unset."""
    if (domain := read_domain(master_uri)) is not None:
        return _read_run_facts(master_uri, domain)
    from ur.run.master.client import Master, parse_master_uri
    from ur.run.master.xml_rpc import CallRefused, Unanswered
    from ur.source.diagnostic import UserError

    try:
        asked = parse_master_uri(master_uri)
        master = Master(asked.uri, asked.host, asked.port, _PATIENCE)
        base, variant = master.call_many([("getParam", (BASE_NAME,)), ("getParam", (VARIANT,))])
    except (Unanswered, CallRefused, UserError, ValueError, TypeError):
        return None
    if not isinstance(base, str) or not base:
        return None
    return base, variant if isinstance(variant, str) else ""


def _read_run_facts(address: str, domain: str) -> Facts | None:
    """Return the facts of the runs in a domain of ROS 2, if there are any."""
    from ur.run.middleware.facts import read_facts as read_file
    from ur.run.record.registry import list_runs, read_computer

    if not any(each.master_uri == address for each in list_runs(os.environ, os.getuid(), read_computer())):
        return None
    found = read_file(find_facts(os.environ, domain))
    base, variant = found.get("base_name"), found.get("variant")
    return (base, variant) if isinstance(base, str) and base and isinstance(variant, str) else None


def know_robot(
    selected: Selection, environment: Mapping[str, str], arguments: Iterable[Argument], report: Report
) -> Selection:
    """Return the selection of a launch, as `know_base` does, for the robot whose master is set. Raises UserError.

    Reports a ROS_MASTER_URI that the user has set, and a running base that is not the selected one.
    """
    followed = _follow_master(selected, environment, report)
    known = know_base(followed, environment)
    if followed.base not in ("", known.base) and not any(each.name == "robot_base" for each in arguments):
        message = f"the robot that runs already is a {known.base}: the selection {followed} is not used"
        report("warning", message)
    return known


def _follow_master(selected: Selection, environment: Mapping[str, str], report: Report) -> Selection:
    changes = environment_changes(selected, environment)
    if selected.simulated or changes.get("ROS_VERSION") == "2":  # ROS 2 has no master
        return selected
    from ur.robot.master_choice import follow_master

    uri = changes.get("ROS_MASTER_URI", environment.get("ROS_MASTER_URI", ""))
    robot = follow_master(selected, uri, socket.gethostname())
    if robot.robot != selected.robot:
        report("warning", f"ROS_MASTER_URI={uri} was set by hand: using {robot} with that master, not {selected}")
    return robot
