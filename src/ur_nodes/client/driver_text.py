"""The client that drives, as one line for a screen."""

import math
from dataclasses import dataclass
from typing import Literal

from ur_nodes.motion.lease.view import Conduct, LeaseView
from ur_nodes.navigation.goals.attendance import clock_time as clock_time

DriverRequest = Literal["take", "ask", "grant"]

_HINT = "d: take over, a: ask"


@dataclass(frozen=True, slots=True)
class DriverLine:
    """The line for a screen ('' for none), and whether the keys have no effect for that reason."""

    text: str = ""
    blocked: bool = False


def line_of(view: LeaseView | None, conduct: Conduct = "drive") -> DriverLine:
    """Return the line about the driver; without a lease it is empty."""
    if view is None:
        return DriverLine()
    return DriverLine(describe_driver(view, conduct), view.out_of_reach or not may_command(view, conduct))


def may_command(view: LeaseView, conduct: Conduct) -> bool:
    """Return whether this client's keys are to be sent: it drives, or the lease is free and it does not only watch."""
    return view.mine or (view.state == "free" and conduct != "watch")


def describe_silence(who: str, seconds: float) -> str:
    """Return the line about a computer or program that is silent; `seconds` is infinite before its first message."""
    return f"no word from {who} for {seconds:.1f} s" if math.isfinite(seconds) else f"no word from {who} yet"


def describe_driver(view: LeaseView, conduct: Conduct = "drive", robot: str = "the robot", hint: str = _HINT) -> str:
    """Return the line about the driver; empty while this client drives or may. `hint` names the keys that change it."""
    if view.out_of_reach:
        return describe_silence(robot, view.link_age)
    if view.mine:
        asking = view.asking[0] if view.asking else ""
        return f"{asking} asks to drive; y: hand over" if asking else ""
    if view.other and view.taken_by:
        return _with_hint(f"{view.taken_by} took over at {clock_time(view.taken_at or view.since)}", view, hint)
    if view.other:
        return _with_hint(f"{name_holder(view)} drives {robot} since {clock_time(view.since)}", view, hint)
    if view.state == "lost":
        return f"{describe_lost(view)}; d: take over"  # without the robot it fits 80 columns
    if view.state == "free" and conduct == "watch":
        return f"{view.note or f'no client drives {robot}'}; d: drive"
    return view.note if view.state == "free" else ""


def describe_lost(view: LeaseView, robot: str = "") -> str:
    """Describe the client that drove last and is out of reach."""
    until = f" until {clock_time(view.until)}" if view.until else ""
    return f"{name_holder(view)} drove{f' {robot}' if robot else ''}{until} and is out of reach"


def name_holder(view: LeaseView) -> str:
    """Return the name of the driving computer, with its program if that is known."""
    return f"{view.holder or 'another client'} ({view.program})" if view.program else view.holder or "another client"


def _with_hint(text: str, view: LeaseView, hint: str) -> str:
    return f"{text}; asked to hand over" if view.asks else f"{text}; {hint}"
