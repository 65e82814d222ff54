"""A change to a computer: what will be different, and the commands that make it so. Values, made by pure functions."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import unified_diff

from ur.robot.ssh.secret import Secret


@dataclass(frozen=True, slots=True)
class ChangeScript:
    """One shell script. Run to its end, or killed anywhere, it leaves nothing half written.

    With `fetches` it fetches packages: it runs with the variables of a proxy where the computer needs one. `log` is a
    file there that grows while it runs.
    """

    script: str
    root: bool = False
    stdin: str | Secret = ""
    timeout: float = 60.0
    fetches: bool = False
    log: str = ""


@dataclass(frozen=True, slots=True)
class Change:
    """A change of one item to its wanted state. `difference` is for people: a unified diff or a few words.

    `note` is a word on why it may take long.
    """

    title: str
    difference: str
    commands: tuple[ChangeScript, ...]
    note: str = ""


def show_difference(path: str, before: str | None, after: str | None) -> str:
    """A unified diff, as `diff -u` prints it, without a context larger than two lines."""
    lines = unified_diff(
        (before or "").splitlines(),
        (after or "").splitlines(),
        path if before is not None else "/dev/null",
        path if after is not None else "/dev/null",
        n=2,
        lineterm="",
    )
    return "\n".join(lines)
