"""Symbolic links that lead outside of the checked folder: they are left out, since their targets have another owner."""

import os
from collections.abc import Sequence

from ur.source.printable import printable

_CHECKED_SUFFIXES = (".launch", ".xml", ".py", ".test", ".yaml", ".yml")
_NAMED = 3  # links that a note names


class EscapingLinks:
    """Finds links that lead outside of their package, and outside of the requested file or folder.

    A workspace may contain links to packages: those count as separate packages.
    """

    def __init__(self, asked_for: str) -> None:
        self._asked_for = os.path.realpath(asked_for)
        self.left_out: list[str] = []

    def leave_out(self, path: str, *, in_package: bool) -> bool:
        """Return whether a path is a link that leads outside; record it in `left_out` if it would have been checked."""
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
    """Return one line about omitted links and one about unreadable folders; None if there is neither."""
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
