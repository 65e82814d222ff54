"""Pauses of an exploration: while another client drives the robot, or its emergency stop is on."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ur_nodes.motion.lease.text import FREE, Lease

_OURS = ("", "idle", "navigation")
"""Names of the mux's active source while only navigation drives."""


@dataclass(frozen=True, slots=True)
class MuxMessages:
    """Messages of the mux, newest each. `own` is the client that had the lease when the exploration began.

    `foreign`: move_base pursues a goal of another program. `driven` is when another client drove last, s.
    """

    stopped: bool = False
    active: str = ""
    lease: Lease = FREE
    own: str | None = None
    foreign: bool = False
    driven: float | None = None


def note_time(drivers: MuxMessages, now: float) -> MuxMessages:
    """Remember that another client drives now, and on the first call who has the lease at the begin."""
    if drivers.own is None:
        drivers = replace(drivers, own=drivers.lease.client)
    return replace(drivers, driven=now) if _driver(drivers) else drivers


def reason_to_pause(drivers: MuxMessages, now: float, quiet: float) -> str:
    """Return the reason to pause; '' to continue. The pause ends `quiet` s after another client drove."""
    if drivers.stopped:
        return "the emergency stop is on; release it to go on"
    if who := _driver(drivers):
        return f"{who}; it goes on {quiet:g} s afterwards"
    if drivers.driven is not None and 0.0 <= now - drivers.driven < quiet:
        return f"another client drove the robot; it goes on in {quiet - (now - drivers.driven):.0f} s"
    return ""


def _driver(drivers: MuxMessages) -> str:
    """Name the other driver in a clause; '' when there is none."""
    if drivers.active not in _OURS:
        return f"the {drivers.active} drives"
    lease = drivers.lease
    if lease.state != "free" and lease.client != drivers.own:
        return f"{lease.name or lease.client[:8]} drives"
    return "the robot drives to the goal of another program" if drivers.foreign else ""
