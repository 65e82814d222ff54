"""The screen of keyboard_drive, as lines with ANSI colours of the terminal's own palette."""

import re
import textwrap
from dataclasses import dataclass

from ur.source.ansi import BOLD, CYAN, DIM, GREEN, RED, RESET, REVERSE, STYLE, YELLOW, cut_styled, strip_styles
from ur_nodes.client.driver_text import DriverLine
from ur_nodes.client.mux import MuxView, describe_emergency, describe_obstacles
from ur_nodes.teleop.keyboard.drive import DriveState, motion_of

_PLAIN_HELP = (
    "keyboard drive: u i o j l m , . drive while held; q z w x e c change speeds; "
    "space: emergency stop; r: release it; g: obstacle stop on or off; n: save what happened; Ctrl-C: quit"
)
NO_LEASE = DriverLine()
_BAR = 20
_WIDE = 66  # columns for the whole screen
_BELOW_MAP = 5  # lines
_NARROWEST_MAP, _LOWEST_MAP = 30, 8
_NO_LIMIT = 1000.0  # m/s, rad/s: the node's default, for a base without known limits
_OWN = "keyboard"  # what the mux calls this source
_PADS = (("u", "i", "o"), ("j", "k", "l"), ("m", ",", "."))
_ARROWS = (("", "up", ""), ("left", "space", "right"), ("", "down", ""))
_GLYPHS = {"up": "↑", "down": "↓", "left": "←", "right": "→", "space": "■"}
_SPEED_HELP = ("q / z   both speeds, up or down 10 %", "w / x   forward speed", "e / c   turning speed")


@dataclass(frozen=True, slots=True)
class CommandTopic:
    """The topic of the commands: its full name and its number of subscribers."""

    topic: str
    subscribers: int


def draw_drive_screen(
    state: DriveState, link: CommandTopic, mux: MuxView, columns: int, rows: int, driver: DriverLine = NO_LEASE
) -> list[str]:
    """Return at most `rows` lines that fit `columns`; on a small screen only the most important ones.

    `driver` is the line about another driver, or about a robot out of reach.
    """
    if columns < _WIDE or rows < 18:
        return [cut_styled(line, columns) for line in _small_screen(state, link, mux, driver, columns, rows)][:rows]
    lines = [
        "",
        f"  {BOLD}{CYAN}keyboard drive{RESET}   {_subscribers(link)}",
        "",
        *_keys(state, columns),
        "",
        _speed_line("forward", state.speed, state.settings.speed_limit, "m/s"),
        _speed_line("turning", state.turn, state.settings.turn_limit, "rad/s"),
        "",
        *(f"  {line}" for line in _wrap(_motion_line(state, mux, driver), columns - 2)),
        *(f"  {line}" for note in _notes(state, link, mux, driver) for line in _wrap(note, columns - 2)),
        "",
        f"  {DIM}{_stop_help(state)}{RESET}",
        f"  {DIM}space: emergency stop for every client; r: release it; other keys stop{RESET}",
        f"  {DIM}g: obstacle stop on or off; Shift: sideways{RESET}",
        f"  {DIM}n: save what happened, for 'ur replay'; Ctrl-C: quit{RESET}",
    ]
    return [cut_styled(line, columns) for line in lines][:rows]


def map_room(columns: int, rows: int) -> tuple[int, int]:
    """Return columns and rows of the map above the lines about the drive; 0, 0 if the screen is too small."""
    free = rows - _BELOW_MAP
    return (columns, free) if columns >= _NARROWEST_MAP and free >= _LOWEST_MAP else (0, 0)


def draw_map_screen(
    state: DriveState,
    link: CommandTopic,
    mux: MuxView,
    columns: int,
    map_lines: list[str],
    driver: DriverLine = NO_LEASE,
) -> list[str]:
    """Return the lines of a map, as many as `map_room` has returned, and the state of the drive below them."""
    notes = [line for note in _notes(state, link, mux, driver) for line in _wrap(note, columns)]
    map_lines = map_lines[: len(map_lines) - len(notes) + 1]  # a long note covers the lower edge of the map
    below = [
        _motion_line(state, mux, driver),
        *notes,
        f"{DIM}{_speeds(state)}  arrows, u i o j l m , .: drive  q z w x e c: speeds{RESET}",
        f"{DIM}space: emergency stop  r: release  g: obstacle stop  Ctrl-C: end and save{RESET}",
        f"{DIM}s: save the map  n: save what happened{RESET}",
    ]
    return [*map_lines, *(cut_styled(line, columns) for line in below)]


def _small_screen(
    state: DriveState, link: CommandTopic, mux: MuxView, driver: DriverLine, columns: int, rows: int
) -> list[str]:
    """Return lines for a small screen: state, notes and the key that stops first, then keys and speeds if they fit."""
    notes = [line for note in _notes(state, link, mux, driver) for line in _wrap(note, columns)]
    head = [*_wrap(_motion_line(state, mux, driver), columns), *notes]
    foot = ["space: emergency stop   r: release", "n: save what happened   Ctrl-C: quit"]
    keys = ["", *(line.strip() for line in _keys(state, 0)), "", f"q/z w/x e/c: {_speeds(state)}"]
    if len(head) + len(keys) + len(foot) <= rows:
        return [*head, *keys, *foot]
    return [*head, "", *foot] if len(head) + 3 <= rows else [*head, *foot]


def _wrap(line: str, columns: int) -> list[str]:
    """Wrap a line into pieces that fit, each with the colours at the line's beginning."""
    bare = strip_styles(line)
    if len(bare) <= columns:
        return [line]
    start = re.match(f"(?:{STYLE.pattern})*", line)
    return [f"{start[0] if start else ''}{piece}{RESET}" for piece in textwrap.wrap(bare.strip(), max(columns, 1))]


def describe_drive(state: DriveState, link: CommandTopic, mux: MuxView, driver: DriverLine = NO_LEASE) -> list[str]:
    """Return lines without colours for a terminal that cannot draw: the keys, and the state of the drive."""
    lines = (
        _PLAIN_HELP,
        _motion_line(state, mux, driver),
        *_notes(state, link, mux, driver),
        "speeds: " + _speeds(state),
    )
    return [strip_styles(line) for line in lines]


def _speeds(state: DriveState) -> str:
    return f"{state.speed:.2f} m/s {state.turn:.2f} rad/s"


def _keys(state: DriveState, columns: int) -> list[str]:
    lines = []
    for row in range(3):
        pad = " ".join(_cap(state, name) for name in _PADS[row])
        arrows = " ".join(_cap(state, name) for name in _ARROWS[row])
        speeds = f"   {DIM}{_SPEED_HELP[row]}{RESET}" if columns >= 72 else ""
        lines.append(f"    {pad}   {arrows}{speeds}")
    return lines


def _cap(state: DriveState, name: str) -> str:
    if not name:
        return "   "
    down = name in state.held or name.upper() in state.held or {",": "<", ".": ">"}.get(name) in state.held
    return f"{REVERSE + BOLD if down else BOLD} {_GLYPHS.get(name, name)} {RESET}"


def _speed_line(name: str, value: float, limit: float, unit: str) -> str:
    most = f" of {limit:g}" if limit < _NO_LIMIT else ""
    full = round(_BAR * min(1.0, value / limit)) if limit > 0 else 0
    return f"  {name}  {GREEN}{'━' * full}{RESET}{DIM}{'━' * (_BAR - full)}{RESET}  {value:.2f}{most} {unit}"


def _motion_line(state: DriveState, mux: MuxView, driver: DriverLine) -> str:
    if alarm := describe_emergency(mux, "r lets the robot drive again"):
        return f"{RED}{REVERSE}{BOLD} {alarm} {RESET}"
    if not state.moving:
        return f"{DIM}■ stopped{RESET}"
    if driver.blocked:
        return f"{YELLOW}■ not driving{RESET}"
    motion = motion_of(state)
    aside = f"  {motion.y:+.2f} m/s to the left" if motion.y else ""
    return f"{GREEN}{BOLD}▲ driving{RESET}   {motion.x:+.2f} m/s  {motion.yaw:+.2f} rad/s{aside}"


def _notes(state: DriveState, link: CommandTopic, mux: MuxView, driver: DriverLine) -> list[str]:
    note = driver.text or state.note
    if not note and not link.subscribers:
        note = f"no subscriber on {link.topic}; is the robot running?"
    elif not note and mux.stopped is None:
        note = "no cmd_vel_mux: space stops this program only, no other client"
    elif not note and mux.active not in ("", _OWN):
        note = f"{mux.active} drives" + (", with priority over these keys" if state.moving else "")
    if obstacles := describe_obstacles(mux, "; g turns it on"):
        note = f"{note}; {obstacles}" if note else obstacles
    return [f"{YELLOW}{note}{RESET}"]


def _subscribers(link: CommandTopic) -> str:
    who = "1 subscriber" if link.subscribers == 1 else f"{link.subscribers} subscribers"
    return f"{DIM}{link.topic} · {who}{RESET}"


def _stop_help(state: DriveState) -> str:
    if state.reports_release:
        return "hold a key to drive; the robot stops when you let go; keys add up"
    seconds = state.settings.key_timeout or state.first_hold
    return f"hold a key to drive; the robot stops soon after you let go ({seconds:.1f} s after a tap)"
