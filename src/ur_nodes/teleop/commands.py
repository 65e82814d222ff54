"""The command line: text to commands. Angles are in degrees here and in radians everywhere else."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean
from ur_nodes.teleop.emergency import Wish


@dataclass(frozen=True, slots=True)
class Go:
    """Drive to a place in the map: m, m, rad; without an angle, arrive facing the way one came."""

    x: float
    y: float
    yaw: float | None = None


@dataclass(frozen=True, slots=True)
class GoTo:
    """Drive to a waypoint."""

    name: str


@dataclass(frozen=True, slots=True)
class Remember:
    """Call this place by a name."""

    name: str


@dataclass(frozen=True, slots=True)
class Forget:
    """Drop a waypoint."""

    name: str


@dataclass(frozen=True, slots=True)
class SetPose:
    """Tell the localiser where the robot is: m, m, rad."""

    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class ListPlaces:
    """Show the waypoints."""


@dataclass(frozen=True, slots=True)
class Stop:
    """Cancel the goal."""


@dataclass(frozen=True, slots=True)
class AskMux:
    """Emergency stop of everything that drives, or the end of it."""

    wish: Wish


@dataclass(frozen=True, slots=True)
class Relocalise:
    """Have the localiser look for the robot everywhere."""


@dataclass(frozen=True, slots=True)
class Help:
    """Show the commands."""


@dataclass(frozen=True, slots=True)
class Quit:
    """End the program."""


Command = Go | GoTo | Remember | Forget | SetPose | ListPlaces | Stop | AskMux | Relocalise | Help | Quit

USAGE: dict[str, tuple[str, str]] = {
    # word: how it is written, what it does
    "g": ("g X Y [ANGLE]", "go there (m, m, degrees)"),
    "m": ("m NAME", "go to a waypoint"),
    "w": ("w NAME", "remember this place as a waypoint"),
    "l": ("l", "list the waypoints"),
    "d": ("d NAME", "drop a waypoint"),
    "s": ("s", "stop: cancel the goal"),
    "e": ("e", "emergency stop, whoever drives (or Space)"),
    "r": ("r", "release: end of the emergency"),
    "i": ("i X Y ANGLE", "tell the robot where it is"),
    "global": ("global", "let the robot find out where it is"),
    "?": ("?", "help"),
    "q": ("q", "quit"),
}
_PLAIN: dict[str, Command] = {
    "l": ListPlaces(),
    "s": Stop(),
    "e": AskMux("stop"),
    "r": AskMux("release"),
    "global": Relocalise(),
    "?": Help(),
    "q": Quit(),
}
_NAMED: dict[str, type[GoTo] | type[Remember] | type[Forget]] = {"m": GoTo, "w": Remember, "d": Forget}
_ALIASES = {"go": "g", "goto": "m", "move": "m", "list": "l", "stop": "s", "help": "?", "quit": "q", "exit": "q"}
_ALIASES |= {"emergency": "e", "release": "r"}
_NAME = re.compile(r"[\w][\w.-]{0,39}\Z")


def parse_command(line: str) -> Command | None:
    """The command of a line; None for a blank one or a `#` comment. Raises UserError: the value, what was expected."""
    words = line.split("#", 1)[0].split()
    if not words:
        return None
    word, given = words[0], words[1:]
    word = _ALIASES.get(word.lower(), word)
    if word not in USAGE:
        near = did_you_mean(word, [*USAGE, *_ALIASES])
        hint = f"did you mean {near!r}?" if near else "? lists the commands"
        raise bad_command_error(f"{word!r} is not a command, expected one of {', '.join(USAGE)}", hint)
    if word in _PLAIN:
        _check_count(word, given, 0, 0)
        return _PLAIN[word]
    if word == "g":
        _check_count(word, given, 2, 3)
        x, y, *angle = (_number(word, text) for text in given)
        return Go(x, y, math.radians(angle[0]) if angle else None)
    if word == "i":
        _check_count(word, given, 3, 3)
        x, y, degrees = (_number(word, text) for text in given)
        return SetPose(x, y, math.radians(degrees))
    _check_count(word, given, 1, 1)
    name = _check_name(word, given[0])
    return _NAMED[word](name)


def error_line(problem: UserError) -> str:
    """A UserError in one line, its help included."""
    return "; ".join(d.message + (f" ({d.help})" if d.help else "") for d in problem.diagnostics)


def _check_count(word: str, given: list[str], least: int, most: int) -> None:
    if len(given) < least:
        raise bad_command_error(f"{word!r} with {_count(given)}, expected: {USAGE[word][0]}")
    if len(given) > most:
        raise bad_command_error(f"{given[most]!r} is too much, expected: {USAGE[word][0]}")


def _count(given: list[str]) -> str:
    return "nothing behind it" if not given else f"only {' '.join(given)!r} behind it"


def _number(word: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or abs(value) > 1e6:
        raise bad_command_error(f"{text!r} is not a number, expected: {USAGE[word][0]}")
    return value


def _check_name(word: str, name: str) -> str:
    if not _NAME.match(name):
        raise bad_command_error(
            f"{name!r} is not a name, expected: {USAGE[word][0]}, with up to 40 letters, digits, '_', '-' and '.' in it"
        )
    return name


def bad_command_error(message: str, help: str | None = None) -> UserError:
    """A UserError about what was typed."""
    return UserError(error(message, rule="bad-command", help=help))
