"""The screen of keyboard_drive, as lines with ANSI colours of the terminal's own palette."""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass

from ur_nodes.teleop.keyboard.drive import DriveState, motion_of
from ur_nodes.teleop.mux.driver_text import DriverLine
from ur_nodes.teleop.mux.emergency import MuxView, describe_emergency

_BOLD, _DIM, _REVERSE, _ALARM, _GREEN, _CYAN, _YELLOW, _OFF = (
    "\x1b[1m",
    "\x1b[2m",
    "\x1b[7;1m",
    "\x1b[31;7;1m",
    "\x1b[32m",
    "\x1b[36m",
    "\x1b[33m",
    "\x1b[0m",
)
_COLOURS = re.compile(r"\x1b\[[0-9;]*m")
_PLAIN_HELP = (
    "keyboard drive: u i o j l m , . drive while held; q z w x e c change speeds; "
    "space: emergency stop; r: release it; Ctrl-C: quit"
)
NO_LEASE = DriverLine()
_BAR = 20
_WIDE = 66  # columns for the whole screen
_NO_LIMIT = 1000.0  # m/s, rad/s: the node's default, for a base whose limits nobody gave
_OWN = "keyboard"  # what the mux calls this source
_PADS = (("u", "i", "o"), ("j", "k", "l"), ("m", ",", "."))
_ARROWS = (("", "up", ""), ("left", "space", "right"), ("", "down", ""))
_GLYPHS = {"up": "↑", "down": "↓", "left": "←", "right": "→", "space": "■"}
_SPEED_HELP = ("q / z   both speeds, up or down 10 %", "w / x   forward speed", "e / c   turning speed")


@dataclass(frozen=True, slots=True)
class Link:
    """The topic of the commands: its full name and its number of subscribers."""

    topic: str
    listeners: int


def draw_drive_screen(
    state: DriveState, link: Link, mux: MuxView, columns: int, rows: int, driver: DriverLine = NO_LEASE
) -> list[str]:
    """At most `rows` lines that fit `columns`, most important first when there is little room.

    `driver` says who else drives, and that the robot is out of reach.
    """
    if columns < _WIDE or rows < 18:
        return [_fit(line, columns) for line in _small_screen(state, link, mux, driver, columns, rows)][:rows]
    lines = [
        "",
        f"  {_BOLD}{_CYAN}keyboard drive{_OFF}   {_listeners(link)}",
        "",
        *_keys(state, columns),
        "",
        _speed_line("forward", state.speed, state.settings.speed_limit, "m/s"),
        _speed_line("turning", state.turn, state.settings.turn_limit, "rad/s"),
        "",
        *(f"  {line}" for line in _wrap(_motion_line(state, mux, driver), columns - 2)),
        *(f"  {line}" for note in _notes(state, link, mux, driver) for line in _wrap(note, columns - 2)),
        "",
        f"  {_DIM}{_stop_help(state)}{_OFF}",
        f"  {_DIM}space: emergency stop, whoever drives; r: release it; other keys stop{_OFF}",
        f"  {_DIM}Shift: sideways, if the base can; Ctrl-C: quit{_OFF}",
    ]
    return [_fit(line, columns) for line in lines][:rows]


def _small_screen(
    state: DriveState, link: Link, mux: MuxView, driver: DriverLine, columns: int, rows: int
) -> list[str]:
    """The same for little room: state, notes and how to stop first, then keys and speeds while there is room."""
    notes = [line for note in _notes(state, link, mux, driver) for line in _wrap(note, columns)]
    head = [*_wrap(_motion_line(state, mux, driver), columns), *notes]
    foot = ["space: emergency stop   r: release", "Ctrl-C: quit"]
    keys = ["", *(line.strip() for line in _keys(state, 0)), "", f"q/z w/x e/c: {_speeds(state)}"]
    if len(head) + len(keys) + len(foot) <= rows:
        return [*head, *keys, *foot]
    return [*head, "", *foot] if len(head) + 3 <= rows else [*head, *foot]


def _wrap(line: str, columns: int) -> list[str]:
    """A line in pieces that fit, each with the colours at the line's beginning."""
    bare = _COLOURS.sub("", line)
    if len(bare) <= columns:
        return [line]
    start = re.match(f"(?:{_COLOURS.pattern})*", line)
    return [f"{start[0] if start else ''}{piece}{_OFF}" for piece in textwrap.wrap(bare.strip(), max(columns, 1))]


def describe_drive(state: DriveState, link: Link, mux: MuxView, driver: DriverLine = NO_LEASE) -> list[str]:
    """Lines without colours for a terminal that cannot draw: what the keys do, and what has to be known now."""
    lines = (
        _PLAIN_HELP,
        _motion_line(state, mux, driver),
        *_notes(state, link, mux, driver),
        "speeds: " + _speeds(state),
    )
    return [_COLOURS.sub("", line) for line in lines]


def _speeds(state: DriveState) -> str:
    return f"{state.speed:.2f} m/s {state.turn:.2f} rad/s"


def _keys(state: DriveState, columns: int) -> list[str]:
    lines = []
    for row in range(3):
        pad = " ".join(_cap(state, name) for name in _PADS[row])
        arrows = " ".join(_cap(state, name) for name in _ARROWS[row])
        speeds = f"   {_DIM}{_SPEED_HELP[row]}{_OFF}" if columns >= 72 else ""
        lines.append(f"    {pad}   {arrows}{speeds}")
    return lines


def _cap(state: DriveState, name: str) -> str:
    if not name:
        return "   "
    down = name in state.held or name.upper() in state.held or {",": "<", ".": ">"}.get(name) in state.held
    return f"{_REVERSE if down else _BOLD} {_GLYPHS.get(name, name)} {_OFF}"


def _speed_line(name: str, value: float, limit: float, unit: str) -> str:
    most = f" of {limit:g}" if limit < _NO_LIMIT else ""
    full = round(_BAR * min(1.0, value / limit)) if limit > 0 else 0
    return f"  {name}  {_GREEN}{'━' * full}{_OFF}{_DIM}{'━' * (_BAR - full)}{_OFF}  {value:.2f}{most} {unit}"


def _motion_line(state: DriveState, mux: MuxView, driver: DriverLine) -> str:
    if alarm := describe_emergency(mux, "r lets the robot drive again"):
        return f"{_ALARM} {alarm} {_OFF}"
    if not state.moving:
        return f"{_DIM}■ stopped{_OFF}"
    if driver.blocked:
        return f"{_YELLOW}■ not driving{_OFF}"
    motion = motion_of(state)
    aside = f"  {motion.y:+.2f} m/s to the left" if motion.y else ""
    return f"{_GREEN}{_BOLD}▲ driving{_OFF}   {motion.x:+.2f} m/s  {motion.yaw:+.2f} rad/s{aside}"


def _notes(state: DriveState, link: Link, mux: MuxView, driver: DriverLine) -> list[str]:
    note = driver.text or state.note
    if not note and not link.listeners:
        note = f"no subscriber on {link.topic}; is the robot running?"
    elif not note and mux.stopped is None:
        note = "no cmd_vel_mux: space stops this program only, nobody else who drives"
    elif not note and mux.active not in ("", _OWN):
        note = f"{mux.active} drives" + (", with priority over these keys" if state.moving else "")
    return [f"{_YELLOW}{note}{_OFF}"]


def _listeners(link: Link) -> str:
    who = "1 subscriber" if link.listeners == 1 else f"{link.listeners} subscribers"
    return f"{_DIM}{link.topic} · {who}{_OFF}"


def _stop_help(state: DriveState) -> str:
    if state.reports_release:
        return "hold a key to drive; the robot stops when you let go; keys add up"
    seconds = state.settings.key_timeout or state.first_hold
    return f"hold a key to drive; the robot stops soon after you let go ({seconds:.1f} s after a tap)"


def _fit(line: str, columns: int) -> str:
    """Cut to the width, not counting colour sequences."""
    shown, out, at = 0, [], 0
    while at < len(line) and shown < columns:
        if line[at] == "\x1b":
            end = line.index("m", at) + 1
            out.append(line[at:end])
            at = end
        else:
            out.append(line[at])
            shown += 1
            at += 1
    return "".join(out) + _OFF
