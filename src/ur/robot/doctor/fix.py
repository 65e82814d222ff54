"""Fixes of findings: run their commands, and inspect the computers again until the fixes take effect."""

import fcntl
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path

from ur.robot.doctor.findings import Finding, FixCommand
from ur.robot.ssh.shell import Shell
from ur.source.diagnostic import UserError

FIX_SECONDS = 600.0  # packages may have to be downloaded
ATTEMPTS = 3  # names need a moment until all computers resolve them


def list_safe(findings: Sequence[Finding]) -> list[tuple[str, FixCommand]]:
    """List the commands that can do no harm, each with the rule of its finding."""
    return [(finding.rule, each) for finding in findings for each in finding.commands if each.safe]


def run_fix(command: FixCommand, local: Shell, remote: Shell, lock: Path) -> str:
    """Run a command on its computer, and describe the result.

    A command on this computer holds the file `lock`, so that other doctors wait.
    """
    shell = local if command.where == "local" else remote
    try:
        with _hold(lock) if command.where == "local" else nullcontext():
            done = shell.run(command.line, root=command.root, timeout=FIX_SECONDS)
    except UserError as problem:
        return f"failed: {problem}"
    reported = (done.err or done.out).strip().splitlines()
    return "done" if done.code == 0 else f"failed: {reported[-1] if reported else done.code}"


def inspect_until_fixed(
    before: Sequence[Finding], inspect: Callable[[], list[Finding]], pause: Callable[[], None]
) -> list[Finding]:
    """Return the findings after fixes; fixable ones are inspected again for some time, with a `pause` in between."""
    fixed = {finding.rule for finding in before if finding.fixable}
    left = inspect()
    for _ in range(ATTEMPTS - 1):
        if not any(finding.rule in fixed for finding in left):
            break
        pause()
        left = inspect()
    return left


@contextmanager
def _hold(lock: Path) -> Iterator[None]:
    lock.parent.mkdir(parents=True, exist_ok=True)
    with lock.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield
