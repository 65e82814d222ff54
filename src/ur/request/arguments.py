"""Command lines of verbs that take launch files: names of packages and files, and arguments `NAME:=VALUE`.

Every verb splits them here, and passes `Argument` values on. roslaunch's rules about valid arguments are in
`ur.launchfile.plan.names.read_assignments`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

ASSIGN = ":="


class Argument(NamedTuple):
    """An argument of a launch file; its text is that of the command line."""

    name: str
    value: str

    def __str__(self) -> str:
        return f"{self.name}{ASSIGN}{self.value}"


def parse_argument(text: str) -> Argument | None:
    """Split `NAME:=VALUE` at its first `:=`; None for a text without one."""
    name, assigned, value = text.partition(ASSIGN)
    return Argument(name, value) if assigned else None


def split_argv(argv: Sequence[str]) -> tuple[list[str], tuple[Argument, ...]]:
    """Separate names (of packages, files, nodes) from arguments, each in their order."""
    names: list[str] = []
    arguments: list[Argument] = []
    for text in argv:
        argument = parse_argument(text)
        if argument is None:
            names.append(text)
        else:
            arguments.append(argument)
    return names, tuple(arguments)


def values_of(arguments: Iterable[Argument]) -> dict[str, str]:
    """Return values by name; for a name that is given twice, the last one."""
    return {each.name: each.value for each in arguments}
