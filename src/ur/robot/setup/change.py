"""A change to a computer: the difference, and the scripts that make it. Values, made by pure functions."""

from dataclasses import dataclass
from difflib import unified_diff

from ur.robot.ssh.secret import Secret


@dataclass(frozen=True, slots=True)
class ChangeScript:
    """One shell script. Run to its end, or killed at any point, it leaves no half-written file.

    With `fetches` it downloads packages: it runs with the variables of a proxy if the computer needs one. `log` is a
    file on the computer that grows while the script runs.
    """

    script: str
    root: bool = False
    stdin: str | Secret = ""
    timeout: float = 60.0
    fetches: bool = False
    log: str = ""


@dataclass(frozen=True, slots=True)
class Change:
    """A change of one item to its wanted state.

    `difference` is for display: a unified diff or a few words. `note` is a remark about a long duration.
    """

    title: str
    difference: str
    commands: tuple[ChangeScript, ...]
    note: str = ""


def show_difference(path: str, before: str | None, after: str | None) -> str:
    """Return a unified diff, as `diff -u` prints it, with a context of at most two lines."""
    lines = unified_diff(
        (before or "").splitlines(),
        (after or "").splitlines(),
        path if before is not None else "/dev/null",
        path if after is not None else "/dev/null",
        n=2,
        lineterm="",
    )
    return "\n".join(lines)
