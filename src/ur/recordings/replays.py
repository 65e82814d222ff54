"""Replays that run on this computer: the commands that they take, as datagrams of a socket in a folder of the user."""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal, get_args

from ur.recordings.datagrams import send_to_all
from ur.source.user_folders import user_folder

MOST_BYTES = 200
"""Bytes of a command."""

CommandName = Literal["pause", "play", "speed", "jump", "back", "ahead"]


@dataclass(frozen=True, slots=True)
class ReplayCommand:
    """A command; `value` is the speed, a position in s, or the length of a jump in s."""

    name: CommandName
    value: float = 0.0


def sockets_folder(environment: Mapping[str, str]) -> str:
    """Return the folder of the sockets."""
    return f"{user_folder('XDG_STATE_HOME', environment)}/ur/replay"


def write_command(command: ReplayCommand) -> bytes:
    """Return a command as a datagram."""
    return f"{command.name} {command.value:.9g}".encode()


def read_command(data: bytes) -> ReplayCommand | None:
    """Parse a datagram; None if it is no command."""
    name, _, text = data.decode("utf-8", "replace").partition(" ")
    with suppress(ValueError):
        value = float(text or 0)
        if name in get_args(CommandName) and math.isfinite(value):
            return ReplayCommand(name, value)  # type: ignore[arg-type]
    return None


def send_command(command: ReplayCommand, environment: Mapping[str, str]) -> int:
    """Send a command to the replays of this user; return the number of those that take it. Never waits."""
    return send_to_all(sockets_folder(environment), write_command(command))
