"""The one calm screen of the keyboard driver, as lines with ANSI colours of the terminal's own palette."""

from __future__ import annotations

from dataclasses import dataclass

from ur_nodes.teleop.drive import DriveState, motion_of
from ur_nodes.teleop.emergency import MuxView, describe_emergency

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
_BAR = 20
_OWN = "keyboard"  # what the mux calls this source
_PADS = (("u", "i", "o"), ("j", "k", "l"), ("m", ",", "."))
_ARROWS = (("", "up", ""), ("left", "space", "right"), ("", "down", ""))
_GLYPHS = {"up": "↑", "down": "↓", "left": "←", "right": "→", "space": "■"}
_SPEED_HELP = ("q / z   both speeds, 10 % at a time", "w / x   forward speed", "e / c   turning speed")


@dataclass(frozen=True, slots=True)
class Link:
    """Where the commands go: the topic's full name and how many listen."""

    topic: str
    listeners: int


def draw_drive_screen(state: DriveState, link: Link, mux: MuxView, columns: int, rows: int) -> list[str]:
    """At most `rows` lines that fit `columns`, most important first when there is little room."""
    if columns < 40 or rows < 14:
        short = (_motion_line(state, mux), *_notes(state, link, mux), "", "space: emergency stop", "Ctrl-C ends")
        return [_fit(line, columns) for line in short][:rows]
    lines = [
        "",
        f"  {_BOLD}{_CYAN}keyboard drive{_OFF}   {_listeners(link)}",
        "",
        *_keys(state, columns),
        "",
        _speed_line("forward", state.speed, state.settings.speed_limit, "m/s"),
        _speed_line("turning", state.turn, state.settings.turn_limit, "rad/s"),
        "",
        f"  {_motion_line(state, mux)}",
        *(f"  {note}" for note in _notes(state, link, mux)),
        "",
        f"  {_DIM}{_stop_help(state)}{_OFF}",
        f"  {_DIM}space: emergency stop, for all who drive; r ends it; k or any other key: stand{_OFF}",
        f"  {_DIM}with shift sideways, where the base can; Ctrl-C ends{_OFF}",
    ]
    return [_fit(line, columns) for line in lines][:rows]


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
    full = round(_BAR * min(1.0, value / limit)) if limit > 0 else 0
    return f"  {name}  {_GREEN}{'━' * full}{_OFF}{_DIM}{'━' * (_BAR - full)}{_OFF}  {value:.2f} of {limit:g} {unit}"


def _motion_line(state: DriveState, mux: MuxView) -> str:
    if alarm := describe_emergency(mux, "r lets the robot drive again"):
        return f"{_ALARM} {alarm} {_OFF}"
    if not state.moving:
        return f"{_DIM}■ standing still{_OFF}"
    motion = motion_of(state)
    aside = f"  {motion.y:+.2f} m/s to the left" if motion.y else ""
    return f"{_GREEN}{_BOLD}▲ driving{_OFF}   {motion.x:+.2f} m/s  {motion.yaw:+.2f} rad/s{aside}"


def _notes(state: DriveState, link: Link, mux: MuxView) -> list[str]:
    note = state.note
    if not note and not link.listeners:
        note = f"nobody listens to {link.topic} yet: is the robot running?"
    elif not note and mux.stopped is None:
        note = "no mux is there: space stops these keys only, not others who drive"
    elif not note and mux.active not in ("", _OWN):
        note = f"{mux.active} drives" + (", and goes before these keys" if state.moving else "")
    return [f"{_YELLOW}{note}{_OFF}"]


def _listeners(link: Link) -> str:
    who = "1 listener" if link.listeners == 1 else f"{link.listeners} listeners"
    return f"{_DIM}{link.topic} · {who}{_OFF}"


def _stop_help(state: DriveState) -> str:
    if state.reports_release:
        return "hold a key to drive: let go and the robot stops; keys add up"
    seconds = state.settings.key_timeout or state.first_hold
    return f"hold a key to drive: it stops soon after you let go ({seconds:.1f} s after a tap)"


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
