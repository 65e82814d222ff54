"""Clocks: tf rejects data whose timestamps seem to be in the past or the future."""

from collections.abc import Iterator

from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import PairRule, Rule, SideRule
from ur.robot.doctor.side import Side

CLOCK_SECONDS = 0.5  # the typical tolerance of tf
# Just after its start, chrony steps the clock by itself (makestep 1 3); later it needs a command.
STEP = "systemctl restart chrony && { chronyc waitsync 15 0.3 0 1 || chronyc makestep; }"


def check_offset(pair: ComputerPair) -> Iterator[Finding]:
    """Check whether the clocks disagree."""
    if abs(pair.offset) > CLOCK_SECONDS:
        by = f"{abs(pair.offset):.1f} s {'ahead of' if pair.offset > 0 else 'behind'}"
        yield Finding(
            "clock-offset",
            f"the clock of {pair.remote.name} is {by} the one of {pair.local.name}",
            "where it takes its time from: chronyc sources",
            (FixCommand("remote", STEP, root=True, safe=True),),
        )


def check_daemon(where: Where, side: Side) -> Iterator[Finding]:
    """Check for a running clock synchronisation."""
    state = side.active.get("chrony.service")
    if side.only_ros2 and side.active.get("systemd-timesyncd.service") == "active":
        return  # as in Ubuntu
    if state not in ("active", None) and not any(unit.name == "chrony.service" for unit in side.failing):
        installed = not side.packages or "chrony" in side.packages
        line = "systemctl enable --now chrony" if installed else "apt-get install -y chrony"
        yield Finding(
            "no-time-synchronisation",
            f"{side.name}: chrony does not run, so its clock drifts"
            + (", and robots without internet get no time from it" if where == "local" else ""),
            commands=(FixCommand(where, line, root=True, safe=True),),
        )


RULES: tuple[Rule, ...] = (
    PairRule({"clock-offset": "the clocks differ, and tf refuses data"}, check_offset),
    SideRule({"no-time-synchronisation": "nothing keeps a clock right"}, check_daemon),
)
