"""The arguments of a command: words, numbers and names, with their limits, and the errors about them."""

import math
import shlex

from ur.maps.names import PLACE_NAME, PLACE_RULE
from ur.source.diagnostic import UserError, error
from ur.source.printable import printable


def split_line(line: str) -> list[str]:
    """Return the arguments of a line without its comment; quotes hold a name with blanks together. Raises UserError."""
    try:
        return shlex.split(line, comments=True)
    except ValueError:
        raise bad_command_error(f"{printable(line)!r} has an opening quote without a closing one") from None


def check_count(word: str, usage: str, given: list[str], least: int, most: int) -> None:
    """Raise UserError if there are fewer than `least` or more than `most` arguments."""
    if len(given) < least:
        raise bad_command_error(f"{word!r} {_count(given)}, expected: {usage}")
    if len(given) > most:
        raise bad_command_error(f"unexpected {printable(given[most])!r}, expected: {usage}")


def _count(given: list[str]) -> str:
    return f"needs more than {printable(' '.join(given))!r}" if given else "needs arguments"


def read_number(text: str, usage: str) -> float:
    """Read a finite number. Raises UserError."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or abs(value) > 1e6:
        raise bad_command_error(f"{printable(text)!r} is not a number, expected: {usage}")
    return value


def check_name(name: str) -> str:
    """Check the name of a waypoint, and return it. Raises UserError.

    People who edit the file may use any text.
    """
    if not PLACE_NAME.fullmatch(name):
        raise bad_command_error(f"{printable(name)!r} is not a valid name, expected {PLACE_RULE}")
    return name


def bad_command_error(message: str, help: str | None = None) -> UserError:
    """Return a UserError about a typed command."""
    return UserError(error(message, rule="bad-command", help=help))


def error_line(problem: UserError) -> str:
    """Return a UserError as one line, with its help."""
    return "; ".join(d.message + (f" ({d.help})" if d.help else "") for d in problem.diagnostics)
