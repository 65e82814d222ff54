"""Commands from text, and their arguments with limits. Angles are in degrees here and in radians everywhere else."""

import math
import shlex
from dataclasses import dataclass
from typing import cast

from ur.maps.names import PLACE_NAME, PLACE_RULE
from ur.source.diagnostic import UserError, user_error
from ur.source.printable import printable
from ur.source.suggest import did_you_mean
from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.mux import MuxRequest
from ur_nodes.client.patrol_text import LONGEST_WAIT, MOST_PLACES, PatrolAction


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
    return user_error(message, rule="bad-command", help=help)


def error_line(problem: UserError) -> str:
    """Return a UserError as one line, with its help."""
    return "; ".join(d.message + (f" ({d.help})" if d.help else "") for d in problem.diagnostics)


@dataclass(frozen=True, slots=True)
class Go:
    """Drive to a pose in the map: m, m, rad; without an angle any heading is accepted."""

    x: float
    y: float
    yaw: float | None = None


@dataclass(frozen=True, slots=True)
class GoToWaypoint:
    """Drive to a waypoint."""

    name: str


@dataclass(frozen=True, slots=True)
class DrivePatrol:
    """Start a patrol of waypoints, or pause, resume or end it. `wait` s at each; `loop`: again and again."""

    action: PatrolAction
    names: tuple[str, ...] = ()
    loop: bool = False
    wait: float = 1.0


@dataclass(frozen=True, slots=True)
class Remember:
    """Save the place of the robot as a waypoint."""

    name: str


@dataclass(frozen=True, slots=True)
class Forget:
    """Delete a waypoint."""

    name: str


@dataclass(frozen=True, slots=True)
class SetPose:
    """Set the estimated pose of the robot: m, m, rad."""

    x: float
    y: float
    yaw: float


@dataclass(frozen=True, slots=True)
class ListPlaces:
    """Show the waypoints."""


@dataclass(frozen=True, slots=True)
class CancelGoal:
    """Cancel the goal."""


@dataclass(frozen=True, slots=True)
class AskLease:
    """Take over, ask to drive, or hand over to the asking client."""

    request: DriverRequest


@dataclass(frozen=True, slots=True)
class AskMux:
    """Emergency stop of everything that drives, or the end of it."""

    request: MuxRequest


@dataclass(frozen=True, slots=True)
class Relocalise:
    """Search for the robot on the whole map."""


@dataclass(frozen=True, slots=True)
class StoreMap:
    """Save the map that is being made."""


@dataclass(frozen=True, slots=True)
class StoreRecording:
    """Save what has happened."""


@dataclass(frozen=True, slots=True)
class Help:
    """Show the commands."""


@dataclass(frozen=True, slots=True)
class Follow:
    """Start or stop following the robot."""


@dataclass(frozen=True, slots=True)
class SwitchTheme:
    """Change between dark and light colours."""


@dataclass(frozen=True, slots=True)
class Quit:
    """End the program."""


AtOnce = Remember | Forget | ListPlaces | CancelGoal | SetPose | Relocalise | Follow | SwitchTheme | Help
Awaited = Go | GoToWaypoint | DrivePatrol | AskLease | AskMux | StoreMap | StoreRecording
"""Commands that wait for other computers or programs."""

Command = AtOnce | Awaited | Quit

USAGE: dict[str, tuple[str, str]] = {
    # command: how it is written, what it does
    "g": ("g X Y [ANGLE]", "drive to this place (m, m, degrees)"),
    "m": ("m NAME", "drive to a waypoint"),
    "patrol": ("patrol [loop] NAME ...", "drive to waypoints in turn (wait=S at each); patrol pause, resume, end"),
    "s": ("s or x", "stop: cancel the goal"),
    "e": ("e or Space", "emergency stop for every client"),
    "r": ("r", "release the emergency stop"),
    "w": ("w NAME", "save the robot's place as a waypoint"),
    "l": ("l", "list the waypoints"),
    "d": ("d NAME", "delete a waypoint"),
    "i": ("i X Y ANGLE", "set the robot's estimated pose"),
    "global": ("global", "search for the robot on the whole map"),
    "save": ("save", "save the map that is being made"),
    "n": ("n", "save what happened: the black box of the robot writes a file"),
    "drive": ("drive", "take over: drive from this computer"),
    "ask": ("ask", "ask the driving client to hand over"),
    "give": ("give", "hand over to the client that asks"),
    "?": ("?", "show this help"),
    "q": ("q", "quit; cancels the goal sent from here"),
}
MAP_USAGE: dict[str, tuple[str, str]] = {
    "f": ("f", "follow the robot, or stop following"),
    "t": ("t", "dark or light colours"),
}
"""Commands that only a terminal with a map has."""

NO_MAPPING = "no map is being made, expected a mapping program as 'ur run make_map'"
"""The answer to `save` elsewhere."""

_PLAIN: dict[str, Command] = {
    "l": ListPlaces(),
    "s": CancelGoal(),
    "drive": AskLease("take"),
    "ask": AskLease("ask"),
    "give": AskLease("grant"),
    "e": AskMux("stop"),
    "r": AskMux("release"),
    "global": Relocalise(),
    "save": StoreMap(),
    "n": StoreRecording(),
    "f": Follow(),
    "t": SwitchTheme(),
    "?": Help(),
    "q": Quit(),
}
_NAMED: dict[str, type[GoToWaypoint] | type[Remember] | type[Forget]] = {"m": GoToWaypoint, "w": Remember, "d": Forget}
_ALIASES = {"go": "g", "goto": "m", "move": "m", "list": "l", "stop": "s", "help": "?", "quit": "q", "exit": "q"}
_ALIASES |= {"emergency": "e", "release": "r", "x": "s", "cancel": "s", "take": "drive"}
_ALIASES |= {"follow": "f", "theme": "t"}
_ALL_USAGE = USAGE | MAP_USAGE
_LEAST_TYPO = 4  # letters: shorter ones are near to everything


def parse_command(line: str) -> Command | None:
    """Parse a line; None for a blank line or a `#` comment. Raises UserError."""
    first, *given = split_line(line) or [""]
    if not first:
        return None
    word = _ALIASES.get(first.lower(), first)
    if word not in _ALL_USAGE:
        near = did_you_mean(first, [*_ALL_USAGE, *_ALIASES]) if len(first) >= _LEAST_TYPO else None
        if near:
            raise bad_command_error(f"unknown command {printable(first)!r}", f"did you mean {near!r}?")
        raise bad_command_error(
            f"unknown command {printable(first)!r}, expected g X Y, m NAME, s, e, ...", "? lists all"
        )
    if word in _PLAIN:
        check_count(word, _ALL_USAGE[word][0], given, 0, 0)
        return _PLAIN[word]
    if word == "g":
        check_count(word, _ALL_USAGE[word][0], given, 2, 3)
        x, y, *angle = (read_number(text, _ALL_USAGE[word][0]) for text in given)
        return Go(x, y, math.radians(angle[0]) if angle else None)
    if word == "i":
        check_count(word, _ALL_USAGE[word][0], given, 3, 3)
        x, y, degrees = (read_number(text, _ALL_USAGE[word][0]) for text in given)
        return SetPose(x, y, math.radians(degrees))
    if word == "patrol":
        return _parse_patrol(given)
    if len(given) > 1:
        name = " ".join(given)
        raise bad_command_error(
            f"unexpected {printable(given[1])!r}, expected: {_ALL_USAGE[word][0]}", f'{word} "{printable(name)}"'
        )
    check_count(word, _ALL_USAGE[word][0], given, 1, 1)
    name = check_name(given[0])
    return _NAMED[word](name)


def _parse_patrol(given: list[str]) -> DrivePatrol:
    check_count("patrol", _ALL_USAGE["patrol"][0], given, 1, MOST_PLACES + 2)
    if given in (["pause"], ["resume"], ["end"]):
        return DrivePatrol(cast("PatrolAction", given[0]))
    loop, wait, names = False, 1.0, list(given)
    while names and (names[0] == "loop" or names[0].startswith("wait=")):
        option = names.pop(0)
        if option == "loop":
            loop = True
        else:
            wait = read_number(option.removeprefix("wait="), _ALL_USAGE["patrol"][0])
    if not 0.0 <= wait <= LONGEST_WAIT:
        raise bad_command_error(f"wait={wait:g}: expected seconds from 0 to {LONGEST_WAIT:g}")
    check_count("patrol", _ALL_USAGE["patrol"][0], names, 1, MOST_PLACES)
    return DrivePatrol("start", tuple(check_name(name) for name in names), loop, wait)
