"""Services that fail: failed units, and boot services of a robot that restart again and again."""

from collections.abc import Iterator

from ur.robot.boot.units import PREFIX
from ur.robot.doctor.findings import Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.ssh.shell import quote

KEPT = ("ssh.service", "avahi-daemon.service", "chrony.service")


def check_services(where: Where, side: Side) -> Iterator[Finding]:
    """Check for failed units; on this computer, only those that robots need."""
    for unit in side.failing:
        boot = unit.name.removesuffix(".service").removeprefix(PREFIX) if unit.name.startswith(PREFIX) else ""
        if where == "local" and not boot and unit.name not in KEPT:
            continue
        last = f"; its last output: {' / '.join(unit.last)}" if unit.last else ""
        if boot:
            yield Finding(
                "failing-boot-service",
                f"{side.name}: {unit.name}, started at boot, has ended and is started again "
                f"(so far {unit.restarts} times){last}",
                f"fix the program and install it again (ur boot install); its output: journalctl -u {unit.name}; "
                "or remove it:",
                (FixCommand("local", f"ur boot remove --robot {quote(side.name)} {quote(boot)}"),),
            )
        else:
            name = quote(unit.name)
            yield Finding(
                "failed-service",
                f"{side.name}: {unit.name} failed{last}",
                f"its output: journalctl -u {unit.name}",
                (FixCommand(where, f"systemctl restart {name} || systemctl reset-failed {name}", root=True),),
            )


RULES: tuple[Rule, ...] = (
    SideRule(
        {
            "failing-boot-service": "a program that is started at boot ends again and again",
            "failed-service": "a service of the robot failed",
        },
        check_services,
    ),
)
