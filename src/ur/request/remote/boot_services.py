"""Installation and removal of a robot's boot services."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ur.robot.boot.units import (
    FOLDER,
    GUARD,
    MASTER,
    PREFIX,
    UnitFile,
    guard_units,
    is_unit_name,
    master_unit,
    program_unit,
)
from ur.robot.setup.change import Change
from ur.robot.setup.engine import apply_states
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.packages import WantedService
from ur.robot.setup.wanted import Wanted, WantedFile
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError, error


def check_name(name: str, help: str, *, master: bool = False) -> None:
    """Raise UserError, with the advice `help`, for an invalid name of a boot service; `master` permits that name."""
    if not is_unit_name(name) and not (master and name == MASTER):
        message = f"{name!r} is not a name for a boot service, expected lower case letters, digits, - and _"
        raise UserError(error(message, rule="bad-name", help=help))


def has_service(shell: Shell, name: str) -> bool:
    """Return whether a robot has a boot service of this name."""
    return not shell.run(quote("[", "-e", f"{FOLDER}/{PREFIX}{name}.service", "]")).code


def install_services(
    shell: Shell, user: str, name: str, line: str, report: Callable[[Change], None], *, master: bool = True
) -> int:
    """Install the master's service, and that of a command line unless it is ""; return the number of changes.

    With a command line come the units that guard the motors of its drivers. On ROS 2 there is no master. `report` is
    called with each change. The shell has to be root's, or has found how to use sudo. Raises UserError.
    """

    def make(facts: ComputerFacts) -> list[Wanted]:
        units = [master_unit(user, facts.home)] if master else []
        wanted: list[Wanted] = []
        if line:
            units.append(program_unit(name, line, user, facts.home, master=master))
            then = f"systemctl daemon-reload; systemctl try-restart {GUARD}.socket"
            guards = guard_units(user, facts.home)
            wanted += [WantedFile(GUARD, path, text, then=then) for path, text in guards.items()]
            wanted.append(WantedService(f"{GUARD} listens", f"{GUARD}.socket"))
        return wanted + [item for unit in units for item in _want(unit)]

    _, count = apply_states(shell, make, user, FactsRequest(user), root=True, report=report)
    return count


def remove_services(shell: Shell, names: Sequence[str]) -> tuple[list[str], bool]:
    """Stop and remove services, without names all; return a line for each removed one, and whether that succeeded."""
    patterns = " ".join(f"{FOLDER}/{PREFIX}{name}.service" for name in names or ["*"])
    script = (
        f'for f in {patterns}; do [ -e "$f" ] || continue; u=${{f##*/}}; '
        'systemctl disable --now "$u" 2>&1; rm -f "$f"; echo "$u: removed"; done; '
        f"ls {FOLDER}/{PREFIX}*.service >/dev/null 2>&1 || {{ systemctl disable --now {GUARD}.socket 2>&1; "
        f"rm -f {FOLDER}/{GUARD}.socket {FOLDER}/{GUARD}@.service; }}; systemctl daemon-reload"
    )
    done = shell.run(script, root=True)
    return [line for line in done.out.splitlines() if line.endswith(": removed")], done.code == 0


def _want(unit: UnitFile) -> list[Wanted]:
    service = f"{unit.service}.service"
    return [
        WantedFile(
            unit.service, unit.path, unit.text, then=f"systemctl daemon-reload; systemctl try-restart {service}"
        ),
        WantedService(f"{unit.service} runs", service),
    ]
