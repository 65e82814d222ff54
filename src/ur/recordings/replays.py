"""Replays that run on this computer: commands and states, as datagrams of a socket in a folder of the user."""

import socket
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from ur.recordings.datagrams import send_to_all
from ur.source.foreign.json_values import BadJsonError, read_json, write_json
from ur.source.user_folders import user_folder

MOST_BYTES = 200
"""Bytes of a command."""

SLOWEST, FASTEST = 0.01, 100.0
_MOST_STATE = 1000  # bytes
_PATIENCE = 1.0  # s

CommandName = Literal["state", "pause", "play", "speed", "jump", "back", "ahead"]


@dataclass(frozen=True, slots=True)
class ReplayCommand:
    """A command; `value` is the speed, a position in s, or the length of a jump in s. `state` changes nothing."""

    name: CommandName
    value: float = 0.0


@dataclass(frozen=True, slots=True)
class ReplayState:
    """A position in seconds, the length of the recording, and the speed; `playing` is False while it is paused."""

    position: float
    length: float
    speed: float
    playing: bool
    ended: bool

    @property
    def doing(self) -> Literal["ended", "playing", "paused"]:
        """Return what the replay does, for people."""
        return "ended" if self.ended else "playing" if self.playing else "paused"


def sockets_folder(environment: Mapping[str, str]) -> str:
    """Return the folder of the sockets."""
    return f"{user_folder('XDG_STATE_HOME', environment)}/ur/replay"


def read_command(data: bytes) -> ReplayCommand | None:
    """Parse a datagram; None if it is no command."""
    with suppress(BadJsonError):
        return read_json(data, ReplayCommand, MOST_BYTES)
    return None


def describe_state(state: ReplayState) -> str:
    """Describe a state, for example `paused at 3.0 of 120.0 s, speed 1`."""
    return f"{state.doing} at {state.position:.1f} of {state.length:.1f} s, speed {state.speed:g}"


def ask_replay(command: ReplayCommand, environment: Mapping[str, str]) -> ReplayState | None:
    """Send a command to the replays of this user; return the state after it, None where no replay runs."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as client:
        client.bind("")  # an address that the replay answers to
        client.settimeout(_PATIENCE)
        if send_to_all(sockets_folder(environment), write_json(command).encode(), client):
            with suppress(TimeoutError, BadJsonError):
                return read_json(client.recv(_MOST_STATE), ReplayState)
    return None
