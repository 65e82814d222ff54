"""Reasons that keep a program from driving, and the end of its goal, read from snapshots."""

from __future__ import annotations

from ur_nodes.client.driver_text import describe_driver, describe_silence
from ur_nodes.client.mux import describe_emergency
from ur_nodes.client.script.errors import Lost, Refused, TakenOver
from ur_nodes.client.snapshot import LastGoalState, RobotSnapshot


def find_hindrance(snapshot: RobotSnapshot, *, started: bool = True) -> Lost | Refused | TakenOver | None:
    """Return the reason that keeps a program from driving. `started`: it drives already."""
    lease = snapshot.lease
    if snapshot.silence is not None:
        return Lost(describe_silence(snapshot.silence.who, snapshot.silence.seconds))
    if snapshot.mux.stopped:
        return Refused("the emergency stop is on, expected it to be released first")
    if lease.other or lease.lost_by_other:
        text = describe_driver(lease, hint="it has to let go first").removesuffix("; d: take over")
        return TakenOver(text) if started else Refused(text)
    return None


def is_settled(snapshot: RobotSnapshot, goal: int, patience: float) -> bool:
    """Return whether to stop waiting: the goal of this number is over, held, or replaced.

    A robot that is silent for longer than `patience` (s) is not waited for either.
    """
    report, silence = snapshot.goal, snapshot.silence
    lost = silence is not None and silence.seconds > patience
    return lost or report.number != goal or report.over or report.state is LastGoalState.HELD


def judge_goal(snapshot: RobotSnapshot, goal: int) -> Lost | Refused | TakenOver | None:
    """Return None if the goal of this number was reached, else the error that describes its end."""
    report = snapshot.goal
    if report.number == goal and report.state is LastGoalState.REACHED:
        return None
    if snapshot.lease.other or report.number != goal:
        driver = describe_driver(snapshot.lease, hint="this program's goal has ended")
        return TakenOver(driver or "another client has sent a goal")
    if snapshot.silence is not None and not report.over and report.state is not LastGoalState.HELD:
        return Lost(describe_silence(snapshot.silence.who, snapshot.silence.seconds))
    return Refused(report.text or f"the goal was {report.state.value}")


def list_events(snapshot: RobotSnapshot) -> tuple[str, ...]:
    """Return the reasons that keep this program from driving now, as lines for users."""
    silence = describe_silence(snapshot.silence.who, snapshot.silence.seconds) if snapshot.silence else ""
    emergency = describe_emergency(snapshot.mux, "it is to be released first")
    driver = describe_driver(snapshot.lease, snapshot.conduct, hint="it has to let go first")
    return tuple(each for each in (silence, emergency, driver) if each)
