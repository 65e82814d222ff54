"""Attendance of goals: a goal is pursued, held or cancelled depending on the client that drives (the mux's lease).

A goal belongs to a client, its attendant: the one that its id names (see `goal_claim`), else the holder of the lease.
While the attendant is there the robot drives. When the mux has lost it, the robot stops and holds the goal; when it is
back the goal goes on. When another client drives, the goal is cancelled. A goal that
names no client goes on while no client holds the lease, or while the holder is lost already when it arrives: it is of a
script or RViz without any program of ours.

`step_attendance` has no clock; times are in s of a steady clock unless stated otherwise.
"""

import time
from dataclasses import dataclass, replace
from enum import Enum

from ur_nodes.motion.lease.text import FREE, LEASE_TIMEOUT, Lease
from ur_nodes.navigation.goals.goal_claim import Claim, ReceivedChallenges, age_of_answer, lag_of_answer

LATEST = 1.0
"""Seconds: a goal that answers an older challenge arrived late."""


@dataclass(frozen=True, slots=True)
class AttendanceSettings:
    """Times in s.

    `grace`: how long the attendant may be lost; the mux counts it for the holder of the lease. `limit`: how long a
    goal is held before it is cancelled, 0: for ever.
    """

    grace: float = LEASE_TIMEOUT
    limit: float = 600.0


class Act(Enum):
    """An action for a goal; the value is the goal's state for programs that show it."""

    DRIVE = "driving"
    HOLD = "held"
    CANCEL = "cancelled"


@dataclass(frozen=True, slots=True)
class GoalVerdict:
    """The action for a goal now, and its reason as text for people."""

    act: Act
    text: str = ""


@dataclass(frozen=True, slots=True)
class Attendance:
    """The state of one goal. `client` is '' while it has no owner; `claimed`: its id named the client.

    `attended`: the client wants it to be held when the client is lost. `present`: the client has held the lease since
    the goal arrived.
    """

    client: str = ""
    name: str = ""
    claimed: bool = False
    attended: bool = True
    present: bool = False
    absent_since: float | None = None
    held_since: float | None = None

    @property
    def unattended(self) -> bool:
        """Return whether the goal belongs to no client."""
        return not self.client


def refuse_goal(claim: Claim | None, lease: Lease | None, challenges: ReceivedChallenges, now: float) -> str:
    """Return the reason why a goal is refused; '' when it is accepted. `lease` is None where the mux has none."""
    if claim is None:
        return ""
    if lease is not None and lease.state == "held" and lease.client != claim.client:
        return f"{name_of_driver(lease)} drives since {clock_time(lease.since)}"
    if lease is not None and lease.state == "lost" and lease.client != claim.client:
        until = f" until {clock_time(lease.until)}" if lease.until else ""
        return f"{name_of_driver(lease)} drove{until} and is out of reach, take over first"
    age = age_of_answer(challenges, claim.answer, now)
    if age is not None and age <= LATEST:
        return ""
    lag = age if age is not None else lag_of_answer(challenges, claim.answer, now)
    return f"the goal arrived late{'' if lag is None else f' ({lag:.1f} s)'}, send it again"


def attend_goal(claim: Claim | None, challenges: ReceivedChallenges, now: float) -> Attendance:
    """Return the attendance of a goal that was just accepted; its client may be absent since it sent the goal."""
    age = age_of_answer(challenges, claim.answer, now) if claim else None
    since = None if age is None else now - age
    return Attendance(client=claim.client, claimed=True, absent_since=since) if claim else Attendance()


def step_attendance(
    attendance: Attendance, lease: Lease | None, silence: float | None, settings: AttendanceSettings, now: float
) -> tuple[Attendance, GoalVerdict]:
    """Decide what to do with a goal now. `silence`: seconds since the mux's last challenge, None when it sends none."""
    lease = lease or FREE
    attendance = _adopt(attendance, lease)
    if lease.state == "held" and attendance.client and lease.client != attendance.client:
        return attendance, GoalVerdict(Act.CANCEL, f"{name_of_driver(lease)} took over")
    absence = _find_absence(attendance, lease, silence, settings, now)
    if absence is not None:
        attendance = replace(attendance, absent_since=absence.since)
        if attendance.held_since is None:
            if now - absence.since < absence.patience:
                return attendance, GoalVerdict(Act.DRIVE)
            attendance = replace(attendance, held_since=now)
        return _hold(attendance, absence.why, settings, now)
    present = attendance.present or lease.state == "held"
    return replace(attendance, absent_since=None, held_since=None, present=present), GoalVerdict(Act.DRIVE)


def name_of_driver(lease: Lease) -> str:
    """Return the display name of the computer that has the lease."""
    return lease.name or lease.client[:8]


def clock_time(since: float) -> str:
    """Format Unix seconds as hours and minutes of this computer's time zone."""
    return time.strftime("%H:%M", time.localtime(since))


@dataclass(frozen=True, slots=True)
class _Absence:
    """The time at which the attendant was lost, the reason, and how long (s) the robot continues."""

    since: float
    why: str
    patience: float = 0.0


def _adopt(attendance: Attendance, lease: Lease) -> Attendance:
    """Assign a goal without a client to the client that drives, or to none if no client drives.

    A goal that arrives while the holder is lost was not sent by the holder, so it belongs to none, too.
    """
    if lease.state == "free":
        forgotten = not attendance.claimed and attendance.held_since is None
        return replace(attendance, client="", name="", attended=True) if forgotten else attendance
    if lease.client == attendance.client or (attendance.unattended and lease.state == "held"):
        return replace(attendance, client=lease.client, name=name_of_driver(lease), attended=lease.attended)
    return attendance


def _find_absence(
    attendance: Attendance, lease: Lease, silence: float | None, settings: AttendanceSettings, now: float
) -> _Absence | None:
    if silence is not None and silence >= settings.grace:
        return _Absence(now - silence, "no word from the mux")
    if attendance.unattended or not attendance.attended:
        return None
    ours, since, why = lease.client == attendance.client, attendance.absent_since, f"no word from {_who(attendance)}"
    if ours and lease.state == "held":
        return None
    proven = attendance.claimed and not attendance.present  # by the answer in its id: it is back, or was a moment ago
    if not ours or proven:
        return _Absence(now if since is None else since, why, settings.grace)
    return _Absence(now - settings.grace if since is None else since, why)  # the mux has waited that long


def _hold(attendance: Attendance, why: str, settings: AttendanceSettings, now: float) -> tuple[Attendance, GoalVerdict]:
    assert attendance.held_since is not None
    held = now - attendance.held_since
    if settings.limit and held > settings.limit:
        return attendance, GoalVerdict(Act.CANCEL, f"held for {settings.limit:g} s: {why}")
    away = now - (attendance.held_since if attendance.absent_since is None else attendance.absent_since)
    return attendance, GoalVerdict(Act.HOLD, f"held: {why} for {away:.0f} s")


def _who(attendance: Attendance) -> str:
    return attendance.name or "the program that sent the goal"
