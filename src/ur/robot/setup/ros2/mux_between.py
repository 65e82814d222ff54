"""The mux between all programs and the base of a robot with ROS 2: installed, tested, and reverted."""

import time
from collections.abc import Callable, Mapping
from dataclasses import replace

from ur.robot.boot.units import FOLDER, PREFIX
from ur.robot.robot_file import ROBOT_FILE
from ur.robot.ros2.seen_graph import SeenGraph
from ur.robot.setup.change import Change
from ur.robot.setup.engine import apply_change, apply_states, gather_facts, plan_undo
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.packages import WantedService
from ur.robot.setup.robot_states import WantedRobot, base_request, robot_file
from ur.robot.setup.ros2.states import inspect_robot
from ur.robot.setup.ros2.take_over import (
    DROP_IN,
    LAUNCH_FILE,
    MARK,
    MUX_NODE,
    SUFFIX,
    TakeOver,
    find_driver,
    list_topics,
    mux_unit,
    plan_take_over,
)
from ur.robot.setup.wanted import Wanted, WantedFile
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import user_error_about

PATIENCE = 60.0  # s for a driver to restart
_MUX = f"{PREFIX}{MUX_NODE}.service"
_LIST = f"""\
for f in {FOLDER}/*.service.d/{DROP_IN} {LAUNCH_FILE}; do
  if grep -qs {quote("^" + MARK)} "$f"; then printf '\\036%s\\n' "$f"; cat "$f"; fi
done
"""


def take_over(shell: SshShell, robot: WantedRobot, report: Callable[[str], None]) -> tuple[WantedRobot, int]:
    """Install the mux between all programs and the base if its driver can be remapped.

    Returns the robot, whose base then subscribes to another topic, and the number of changes. Raises UserError if the
    driver did not subscribe to the other topic; then the change is reverted.
    """
    assert robot.ros2
    found = inspect_robot(shell)
    driver = find_driver(found, robot.ros2.commands)
    plan = plan_take_over(driver, read_unit(shell, driver.unit) if driver.unit else {})
    if isinstance(plan, str):
        report(f"{robot.ros2.commands} is not taken over: {plan}; programs can reach the base past the mux")
        return robot, 0
    user = shell.address.user
    request = base_request(user)

    def report_change(change: Change) -> None:
        report(change.title)

    files = _want_files(plan.unit, plan.files)
    _, count = apply_states(shell, lambda _: files, user, request, root=True, report=report_change)
    if count and not _wait_remapped(shell, plan):
        give_back(shell, report)
        raise user_error_about(
            shell.destination,
            f"the nodes of {plan.unit} take {', '.join(plan.topics)} also after they were remapped",
            rule="no-take-over",
            help="the unit is as before; remap the driver in its own launch file: docs/how-to/ros2.md",
        )
    ros2 = replace(robot.ros2, commands=robot.ros2.commands.removesuffix(SUFFIX) + SUFFIX)
    later = replace(robot, ros2=ros2)

    def make(facts: ComputerFacts) -> list[Wanted]:
        unit = mux_unit(robot.name, robot.base, robot.variant, ros2, user, facts.home)
        present = facts.file(str(ROBOT_FILE)).text
        reload = f"systemctl daemon-reload; systemctl try-restart {_MUX}"
        return [
            WantedFile("robot file", str(ROBOT_FILE), robot_file(later, present)),
            WantedFile("mux at boot", unit.path, unit.text, then=reload),
            WantedService("mux", _MUX),
        ]

    _, more = apply_states(shell, make, user, request, root=True, report=report_change)
    taken = ", ".join(f"{name} ({kind.rpartition('/')[2]})" for name, kind in driver.topics.items())
    report(f"the mux alone reaches the base; it takes over {taken}")
    return later, count + more


def give_back(shell: SshShell, report: Callable[[str], None]) -> int:
    """Revert the files that `take_over` has written; return the number of changes."""
    output = shell.run(_LIST).out
    parts = (part.partition("\n") for part in output.split("\x1e")[1:])
    texts = {path: text for path, _, text in parts}
    mux = shell.run(f"cat {FOLDER}/{_MUX} 2>/dev/null").out if texts else ""
    items: list[Wanted] = []
    for path, text in texts.items():
        unit = path.removeprefix(f"{FOLDER}/").removesuffix(f".d/{DROP_IN}")
        items += _want_files(unit if path.endswith(DROP_IN) else "", {path: text})
    if mux:
        shell.run(f"systemctl disable --now {_MUX}", root=True)
        items.append(WantedFile("mux at boot", f"{FOLDER}/{_MUX}", mux, then="systemctl daemon-reload"))
    user = shell.address.user
    changes = plan_undo(items, gather_facts(shell, items, user, FactsRequest(user), root=True)) if items else []
    for change in changes:
        report(f"{change.title}: taken back")
        apply_change(shell, change)
    return len(changes)


def read_unit(shell: Shell, unit: str) -> dict[str, str]:
    """Return the files of a unit by their paths."""
    done = shell.run(f"systemctl show -P FragmentPath -P DropInPaths {quote(unit)}")
    return {path: shell.run(f"cat {quote(path)}").out for path in done.out.split() if path.startswith("/")}


def is_remapped(graph: SeenGraph | None, plan: TakeOver) -> bool:
    """Return whether the base subscribes to the remapped topics, and to none of those that programs publish."""
    if graph is None:
        return False
    return all(list_topics(graph, name + SUFFIX) and not list_topics(graph, name) for name in plan.topics)


def _wait_remapped(shell: Shell, plan: TakeOver) -> bool:
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if is_remapped(inspect_robot(shell).graph, plan):
            return True
    return False


def _want_files(unit: str, files: Mapping[str, str]) -> list[Wanted]:
    then = f"systemctl daemon-reload; systemctl restart {quote(unit)}" if unit else ""
    return [
        WantedFile(
            f"remap of {unit}" if path.endswith(DROP_IN) else "launch file that remaps",
            path,
            text,
            then=then if path.endswith(DROP_IN) else "",
        )
        for path, text in files.items()
    ]
