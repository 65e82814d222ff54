"""Replays that run on this computer: the commands that they take, as datagrams of a socket in a folder of the user."""

from __future__ import annotations

import math
import os
import socket
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal, get_args

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
    """The folder of the sockets."""
    return f"{user_folder('XDG_STATE_HOME', environment)}/ur/replay"


def write_command(command: ReplayCommand) -> bytes:
    """A command as it is sent."""
    return f"{command.name} {command.value:.9g}".encode()


def read_command(data: bytes) -> ReplayCommand | None:
    """A command that has arrived; None for anything else."""
    name, _, text = data.decode("utf-8", "replace").partition(" ")
    with suppress(ValueError):
        value = float(text or 0)
        if name in get_args(CommandName) and math.isfinite(value):
            return ReplayCommand(name, value)  # type: ignore[arg-type]
    return None


def send_command(command: ReplayCommand, environment: Mapping[str, str]) -> int:
    """Send a command to the replays of this user; the number of those that take it. Never waits."""
    folder = sockets_folder(environment)
    try:
        names = os.listdir(folder)  # noqa: PTH208 - pathlib is not worth its import here
    except OSError:
        return 0
    taken = 0
    for name in names:
        path = f"{folder}/{name}"
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
            sender.setblocking(False)
            try:
                sender.sendto(write_command(command), path)
                taken += 1
            except ConnectionRefusedError:  # its node was killed
                with suppress(OSError):
                    os.unlink(path)  # noqa: PTH108 - likewise
            except OSError:
                pass  # it ends
    return taken
