"""Rules of the doctor by subject: problems of one computer, or between two. Pure functions of what was observed."""

from ur.robot.doctor.findings import ComputerPair, Finding
from ur.robot.doctor.rules import devices, drivers, environment, login, machine, names, network, packages, ros2
from ur.robot.doctor.rules.registry import Rule, SideRule
from ur.robot.doctor.side import Side

# The most fundamental rules first: later findings often follow from earlier ones.
RULES: tuple[Rule, ...] = (
    *names.RULES,
    *login.RULES,
    *network.RULES,
    *environment.RULES,
    *machine.RULES,
    *devices.RULES,
    *drivers.RULES,
    *packages.RULES,
    *ros2.RULES,
)
KINDS = {kind: meaning for rule in RULES for kind, meaning in rule.kinds.items()}
OBSERVE = {name: script for rule in RULES for name, script in rule.observe.items()}

__all__ = ["KINDS", "OBSERVE", "RULES", "diagnose", "diagnose_alone"]


def diagnose(pair: ComputerPair) -> list[Finding]:
    """Return all findings about two computers; empty if no problem is found."""
    found: list[Finding] = []
    for rule in RULES:
        if rule.ros1 and pair.remote.only_ros2:
            continue
        if isinstance(rule, SideRule):
            found += [finding for where, side, _ in pair.sides() for finding in rule.check(where, side)]
        else:
            found += rule.check(pair)
    return found


def diagnose_alone(side: Side, *, simulation: bool = False) -> list[Finding]:
    """Return all findings about this computer alone; with `simulation`, those that concern a simulated robot."""
    rules = [rule for rule in RULES if isinstance(rule, SideRule) and (rule.simulation or not simulation)]
    return [finding for rule in rules if not (rule.ros1 and side.only_ros2) for finding in rule.check("local", side)]
