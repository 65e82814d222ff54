"""From wanted states to done: gather the facts, plan, change, look again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce

from ur.robot.setup.change import Change
from ur.robot.setup.facts import Facts, Request, fact_script, parse_facts
from ur.robot.setup.wanted import Wanted
from ur.robot.ssh.shell import Shell
from ur.source.diagnostic import UserError, error

Make = Callable[[Facts], Sequence[Wanted]]


def gather(shell: Shell, request: Request, *, root: bool = False) -> Facts:
    """Ask a computer for facts, in one round trip. `root`: files that only root may read are wanted."""
    done = shell.run(fact_script(request), root=root)
    return parse_facts(request, done.out)


def look(shell: Shell, wanted: Sequence[Wanted], user: str, base: Request, *, root: bool) -> Facts:
    """The facts that these wanted states look at, and those of `base`."""
    return gather(shell, reduce(Request.__or__, [item.request(user) for item in wanted], base), root=root)


def plan_changes(wanted: Sequence[Wanted], facts: Facts) -> list[Change]:
    """What has to be changed, in order; empty when all is as wanted."""
    return [change for item in wanted if (change := item.plan(facts))]


def plan_undo(wanted: Sequence[Wanted], facts: Facts) -> list[Change]:
    """What takes everything back, last first."""
    return [change for item in reversed(wanted) if (change := item.undo(facts))]


def apply_change(shell: Shell, change: Change) -> None:
    """Run a change's commands. Raises UserError, which says what failed and what was said."""
    for command in change.commands:
        done = shell.run(command.script, root=command.root, stdin=command.stdin, timeout=command.timeout)
        if done.code:
            said = (done.err or done.out).strip().splitlines()
            reason = said[0] if said else f"exit code {done.code}"
            raise UserError(
                error(
                    f"{shell.place}: {change.title}: {reason}",
                    rule="failed-change",
                    help="mend that and run this again: it goes on where it stopped",
                )
            )


def bring_about(
    shell: Shell,
    make: Make,
    user: str,
    base: Request,
    *,
    root: bool,
    report: Callable[[Change], None],
) -> tuple[Facts, int]:
    """Make a computer as wanted; the facts afterwards and how many changes it took.

    `make` says what is wanted given the facts of `base`; `report` is told before each change. The computer is looked at
    again after each change, since one may make the next one possible. Raises UserError when a change fails or does not
    last.
    """
    made: list[Change] = []
    while True:
        wanted = make(gather(shell, base, root=root))
        facts = look(shell, wanted, user, base, root=root)
        change = next((change for item in wanted if (change := item.plan(facts))), None)
        if change is None:
            return facts, len(made)
        if change in made:
            raise UserError(
                error(
                    f"{shell.place}: {change.title}: changed, and still not as wanted",
                    rule="failed-change",
                    help="look at its log there (journalctl), then run this again",
                )
            )
        report(change)
        apply_change(shell, change)
        made.append(change)
