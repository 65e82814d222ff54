"""Taking back what the set-up has written to the firmware of a Raspberry Pi."""

from __future__ import annotations

from collections.abc import Callable

from ur.robot.setup.change import Change
from ur.robot.setup.engine import apply_change, gather_facts, plan_undo
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.raspberry_pi import header
from ur.robot.ssh.shell import Shell


def take_back_header(
    shell: Shell,
    user: str,
    report: Callable[[str], None],
    look: Callable[..., ComputerFacts] = gather_facts,
    apply: Callable[[Shell, Change], None] = apply_change,
) -> int:
    """Give the header back to Bluetooth and the console, without its I2C bus; return the number of changes.

    The base does not matter: the set-up may have been for another one. Raises UserError.
    """
    base = FactsRequest(user, files=header.FILES)
    items = header.want_header(look(shell, (), user, base, root=True), header.BEHIND)
    changes = plan_undo(items, look(shell, items, user, base, root=True))
    for change in changes:
        report(f"{change.title}: taken back" + (f", {change.note}" if change.note else ""))
        apply(shell, change)
    return len(changes)
