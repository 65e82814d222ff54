"""Command lines of commands that take launch files: names of packages and files, and arguments `NAME:=VALUE`.

Every command splits them here, once, and passes values on. roslaunch's rules about valid arguments are in
`ur.launchfile.plan.names.read_assignments`.
"""

from collections.abc import Iterable
from typing import NamedTuple

_ASSIGN = ":="
_LONGEST = 100_000  # characters: shlex takes the square of their number, here 0.2 s


def split_words(text: str) -> list[str]:
    """Return the words of a command line as a shell would. Raises ValueError, also for one that is too long."""
    if len(text) > _LONGEST:
        raise ValueError(f"More than {_LONGEST:,} characters")
    import shlex  # for most command lines it would only cost time

    return shlex.split(text)


class Argument(NamedTuple):
    """An argument of a launch file; its text is that of the command line."""

    name: str
    value: str

    def __str__(self) -> str:
        return f"{self.name}{_ASSIGN}{self.value}"


class CommandLine(NamedTuple):
    """Names (of packages, files, nodes) and arguments, each in their order; without options."""

    names: tuple[str, ...] = ()
    arguments: tuple[Argument, ...] = ()

    @property
    def argv(self) -> tuple[str, ...]:
        """Return the words: the names first."""
        return (*self.names, *map(str, self.arguments))

    @property
    def values(self) -> dict[str, str]:
        """Return the values of the arguments by name."""
        return values_of(self.arguments)


def parse_argument(text: str) -> Argument | None:
    """Split `NAME:=VALUE` at its first `:=`; None for a text without one."""
    name, assigned, value = text.partition(_ASSIGN)
    return Argument(name, value) if assigned else None


def split_argv(argv: Iterable[str]) -> CommandLine:
    """Separate names from arguments."""
    parsed = [(text, parse_argument(text)) for text in argv]
    return CommandLine(
        tuple(text for text, argument in parsed if argument is None),
        tuple(argument for _, argument in parsed if argument is not None),
    )


def values_of(arguments: Iterable[Argument]) -> dict[str, str]:
    """Return values by name; for a name that is given twice, the last one."""
    return {each.name: each.value for each in arguments}
