"""What a mux says of emergencies and of who drives, as programs for people see it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

Wish = Literal["stop", "release"]

_IDLE = "idle"


@dataclass(frozen=True, slots=True)
class MuxView:
    """What is known of the mux now.

    `stopped` is None while no mux says anything; `active` is the source that drives, empty for none; `asked` is what
    was asked of it and not answered yet; `problem` is why what was asked last did not happen, from `say_problem`.
    """

    stopped: bool | None = None
    active: str = ""
    asked: Wish | None = None
    problem: str = ""


class Emergency(Protocol):
    """A mux that can be asked to stop. No call blocks; what came of it is in later views."""

    def view(self) -> MuxView:
        """What is known now."""

    def ask(self, wish: Wish) -> None:
        """Stop everything that drives, or let it drive again."""


def view_of(connected: bool, stopped: bool | None, active: str, asked: Wish | None, problem: str) -> MuxView:
    """The view of a mux: what it told counts only as long as it is there."""
    if not connected:
        return MuxView(asked=asked, problem=problem)
    return MuxView(stopped, "" if active == _IDLE else active, asked, problem)


def say_problem(wish: Wish, reason: str) -> str:
    """Why what was asked of the mux did not happen, for `MuxView.problem`."""
    return f"{'NOT STOPPED' if wish == 'stop' else 'not released'}: {reason}"


def describe_emergency(view: MuxView, release: str) -> str:
    """What people have to know, in one line: empty when there is nothing. `release` says how an emergency is ended."""
    if view.problem:
        return view.problem
    if view.stopped:
        return f"EMERGENCY STOP: {release}"
    if view.asked == "stop":
        return "emergency stop: asked for, no answer yet"
    return ""
