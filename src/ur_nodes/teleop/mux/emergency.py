"""The emergency stop of a mux and the source that drives, as user interfaces see them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

from ur_nodes.teleop.terminal.keys import Key, KeyEvent

MuxRequest = Literal["stop", "release"]

EMERGENCY_KEYS: dict[str, MuxRequest] = {"space": "stop", "r": "release"}

_IDLE = "idle"


@dataclass(frozen=True, slots=True)
class MuxView:
    """The newest state of the mux.

    `stopped` is None while no mux publishes it; `active` is the source that drives, empty for none; `asked` is what
    was asked of it and not answered yet; `problem` is why the last request failed, from `describe_refusal`.
    """

    stopped: bool | None = None
    active: str = ""
    asked: MuxRequest | None = None
    problem: str = ""


class Emergency(Protocol):
    """A mux that can be asked to stop. No call blocks; what came of it is in later views."""

    def view(self) -> MuxView:
        """Return the newest state."""

    def ask(self, request: MuxRequest) -> None:
        """Stop everything that drives, or release the emergency stop."""


def mux_request_of(event: KeyEvent) -> MuxRequest | None:
    """Return the request to the mux that a key makes; None for any other key."""
    if not isinstance(event, Key) or event.action != "press" or event.ctrl:
        return None
    return EMERGENCY_KEYS.get(event.name)


def view_of(connected: bool, stopped: bool | None, active: str, asked: MuxRequest | None, problem: str) -> MuxView:
    """The view of a mux: its last state counts only while it exists."""
    if not connected:
        return MuxView(asked=asked, problem=problem)
    return MuxView(stopped, "" if active == _IDLE else active, asked, problem)


def describe_refusal(request: MuxRequest, reason: str) -> str:
    """Describe a request to the mux that had no effect, for `MuxView.problem`."""
    return f"{'NOT STOPPED' if request == 'stop' else 'not released'}: {reason}"


def describe_emergency(view: MuxView, release: str) -> str:
    """Describe an emergency in one line, empty when there is none. `release` describes how an emergency is ended."""
    if view.problem:
        return view.problem
    if view.stopped:
        return f"EMERGENCY STOP: {release}"
    if view.asked == "stop":
        return "emergency stop requested, no answer yet"
    return ""
