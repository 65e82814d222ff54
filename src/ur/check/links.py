"""Symbolic links that lead out of what is checked: they are left out, since what they lead to is of another owner."""

from __future__ import annotations

import os
from collections.abc import Sequence

from ur.source.printable import printable

_CHECKED_SUFFIXES = (".launch", ".xml", ".test", ".yaml", ".yml")
_NAMED = 3  # links that a note names


class EscapingLinks:
    """Finds links that lead out of the package that holds them, and out of the file or folder that was asked for.

    A workspace may hold links to packages: those are packages of their own.
    """

    def __init__(self, asked_for: str) -> None:
        self._asked_for = os.path.realpath(asked_for)
        self.left_out: list[str] = []

    def leave_out(self, path: str, *, in_package: bool) -> bool:
        """Return whether a path is a link that leads out; noted in `left_out` if it would have been checked."""
        if not os.path.islink(path):  # noqa: PTH114 - for each file, and pathlib takes longer
            return False
        target = os.path.realpath(path)
        inside = target == self._asked_for or target.startswith(f"{self._asked_for.rstrip('/')}/")
        if inside or (not in_package and os.path.isfile(f"{target}/package.xml")):  # noqa: PTH113 - likewise
            return False
        if path.endswith(_CHECKED_SUFFIXES) or os.path.isdir(target):  # noqa: PTH112 - likewise
            self.left_out.append(path)
        return True


def describe_left_out(left_out: Sequence[str]) -> str | None:
    """One line about links and one about unreadable folders that were left out; None when there is neither."""
    links = [path for path in left_out if os.path.islink(path)]  # noqa: PTH114 - these are texts
    folders = [path for path in left_out if path not in links]
    lines = []
    if links:
        lead = "1 link leads out of" if len(links) == 1 else f"{len(links)} links lead out of"
        lines.append(_describe(links, f"{lead} what is checked"))
    if folders:
        lines.append(_describe(folders, f"{len(folders)} folder{'' if len(folders) == 1 else 's'} cannot be read"))
    return "\n".join(lines) or None


def _describe(paths: Sequence[str], subject: str) -> str:
    names = ", ".join(os.path.relpath(path) for path in paths[:_NAMED])
    more = f" and {len(paths) - _NAMED} more" if len(paths) > _NAMED else ""
    return printable(f"note: {subject} and {'is' if len(paths) == 1 else 'are'} left out: {names}{more}")
