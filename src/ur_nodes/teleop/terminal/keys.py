"""Decode what a terminal sends into events: plain bytes, ANSI sequences, and the kitty keyboard protocol.

The protocol: https://sw.kovidgoyal.net/kitty/keyboard-protocol/. Release events of letters need "report all keys as
escape codes" (8) beside "report event types" (2); 4 adds the shifted key, so that `<` is known without a layout table.
"""

import re
from dataclasses import dataclass
from typing import Literal

Action = Literal["press", "repeat", "release"]

KITTY_FLAGS = 1 | 2 | 4 | 8
"""Flags requested from the terminal: disambiguate, event types, alternate keys, all keys as escape codes."""

KITTY_RELEASE_FLAGS = 2 | 8
"""Flags that must be in force for every key to report its release."""

_ESCAPE = 0x1B
_CSI = re.compile(rb"\x1b\[([0-?]*)([ -/]*)([@-~])")
_CSI_PART = re.compile(rb"\x1b\[[0-?]*[ -/]*\Z")
_LETTERS = {"A": "up", "B": "down", "C": "right", "D": "left", "H": "home", "F": "end"}
_CODES = {9: "tab", 13: "enter", 27: "escape", 32: "space", 127: "backspace"}
_KEYPAD = {57417: "left", 57418: "right", 57419: "up", 57420: "down", 57414: "enter"}
_ACTIONS: dict[str, Action] = {"1": "press", "2": "repeat", "3": "release"}
_PRIVATE = range(57344, 63744)  # the protocol's numbers for keys that have no character: shift, F13, ...


@dataclass(frozen=True, slots=True)
class Key:
    """A key: its character, or a name such as `up`, `space`, `enter`, `escape`. Shift is in the character."""

    name: str
    action: Action = "press"
    ctrl: bool = False


@dataclass(frozen=True, slots=True)
class KittyFlags:
    """The terminal's answer to `CSI ? u`: the flags in force. Doubles as a sign of life."""

    flags: int


@dataclass(frozen=True, slots=True)
class FocusLost:
    """Another window has the keyboard now: releases will not be reported."""


KeyEvent = Key | KittyFlags | FocusLost


def leaves_view(event: KeyEvent) -> bool:
    """Return whether a key leaves a screen on which nothing is typed: q, Escape or Ctrl-C."""
    return isinstance(event, Key) and (event.name in ("q", "Q", "escape") or (event.name == "c" and event.ctrl))


def decode_keys(data: bytes, *, final: bool = False) -> tuple[tuple[KeyEvent, ...], bytes]:
    """Decode the events in `data`; return them and the bytes of an incomplete sequence.

    Give the rest back in front of what comes next. With `final` nothing more will come soon: a lone ESC is the key,
    other incomplete bytes are dropped. Sequences that mean nothing here are skipped; no input raises.
    """
    events: list[KeyEvent] = []
    at = 0
    while at < len(data):
        found, size = _decode_one(data[at : at + 64], final)
        if size == 0:
            return tuple(events), data[at:]
        if found is not None:
            events.append(found)
        at += size
    return tuple(events), b""


def _decode_one(data: bytes, final: bool) -> tuple[KeyEvent | None, int]:
    """Decode the event at the start of `data` (None: skip it) and its size in bytes (0: incomplete)."""
    if data[0] == _ESCAPE:
        if match := _CSI.match(data):
            return _decode_csi(match[1].decode(), match[3].decode()), match.end()
        incomplete = len(data) < 64 and (len(data) == 1 or data == b"\x1bO" or _CSI_PART.match(data) is not None)
        if incomplete and not final:
            return None, 0
        if len(data) == 1:
            return Key("escape"), 1
        if data[1:2] == b"O" and len(data) > 2:
            name = _LETTERS.get(chr(data[2]))
            return (Key(name) if name else None), 3
        if incomplete:
            return None, len(data)
        return None, 2  # alt and a key: not one of ours, and must not count as the key alone
    if data[0] < 0x20 or data[0] == 0x7F:
        return _control(data[0]), 1
    lead = data[0]
    size = 1 if lead < 0x80 else 2 if 0xC2 <= lead < 0xE0 else 3 if 0xE0 <= lead < 0xF0 else 4 if lead < 0xF5 else 1
    if len(data) < size:
        return None, len(data) if final else 0
    try:
        text = data[:size].decode()
    except UnicodeDecodeError:
        return None, 1
    return Key("space" if text == " " else text), size


def _decode_csi(parameters: str, last: str) -> KeyEvent | None:
    if last == "u" and parameters.startswith("?"):
        return KittyFlags(int(parameters[1:])) if parameters[1:].isdigit() else None
    if last == "O" and not parameters:
        return FocusLost()
    if last not in "u" and last not in _LETTERS:
        return None
    fields = [field.split(":") for field in parameters.split(";")]
    modifiers = fields[1] if len(fields) > 1 else ["1"]
    held = int(modifiers[0]) - 1 if modifiers[0].isdigit() else 0
    action = _ACTIONS.get(modifiers[1] if len(modifiers) > 1 else "1")
    name = _LETTERS.get(last) or _name_of_code(fields[0], shift=bool(held & 1))
    if name is None or action is None or held & 2:
        return None
    return Key(name, action, ctrl=bool(held & 4))


def _name_of_code(codes: list[str], *, shift: bool) -> str | None:
    if not codes[0].isdigit():
        return None
    code = int(codes[0])
    if code in _CODES or code in _KEYPAD:
        return _CODES.get(code) or _KEYPAD.get(code)
    if code in _PRIVATE or code > 0x10FFFF or code < 32:
        return None
    if shift and len(codes) > 1 and codes[1].isdigit() and 32 < int(codes[1]) <= 0x10FFFF:
        return chr(int(codes[1]))
    return chr(code).upper() if shift else chr(code)


def _control(byte: int) -> KeyEvent | None:
    if byte in (0x0A, 0x0D):
        return Key("enter")
    if byte in _CODES:
        return Key(_CODES[byte])
    return Key(chr(byte + 0x60), ctrl=True) if 1 <= byte <= 26 else None
