"""The exploration's clients of navigation's action and of the mux."""

import uuid
from dataclasses import dataclass, replace

from ur_nodes.exploration.explorer_step import ExploreSettings, GoalEnd
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.lease.text import FREE, Lease, read_lease
from ur_nodes.ports.actions import Goal, GoalState
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Silent
from ur_nodes.ports.values import Result, StampedPose

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


class ExplorationNavigation:
    """Sends goals, one at a time."""

    def __init__(self, node: Node, settings: ExploreSettings) -> None:
        self._node = node
        self._settings = settings
        self._drivers = MuxMessages()
        self._number = 0
        self._goal = ""
        self._end: GoalEnd | None = None
        self._alive = False
        self._start = f"{node.name}-{uuid.uuid4().hex[:8]}-"  # of our goals' ids
        self._goals = node.follow_goals(settings.navigation, self)
        node.subscribe(f"{settings.mux}/stopped", bool, self._on_stopped, Quality.LATCHED)
        node.subscribe(f"{settings.mux}/active", str, self._on_active, Quality.LATCHED)
        node.subscribe(f"{settings.mux}/lease", str, self._on_lease, Quality.LATCHED)

    def ready(self) -> bool:
        """Return whether the action server is available."""
        return self._alive and self._goals.servers() > 0

    def pause(self, now: float) -> str:
        """Return the reason why the robot must not be driven now; '' if it may."""
        self._drivers = note_time(self._drivers, now)
        return reason_to_pause(self._drivers, now, self._settings.quiet)

    def send(self, pose: Pose2) -> None:
        """Drive to a pose; it replaces the last goal."""
        self._number += 1
        self._goal, self._end = f"{self._start}{self._number}", None
        self._goals.send(Goal(self._goal, StampedPose(self._node.now(), self._settings.map_frame, pose)))

    def cancel(self) -> None:
        """Cancel the goal."""
        goal, self._goal, self._end = self._goal, "", None
        if goal:
            self._goals.cancel(goal)

    def pop_end(self) -> GoalEnd | None:
        """Return the result of the goal, once."""
        end, self._end = self._end, None
        return end

    def clear(self) -> None:
        """Clear the obstacles of the costmaps."""
        self._node.call(f"{self._settings.navigation}/clear_costmaps", Silent(), self._note_cleared)

    def on_states(self, states: tuple[GoalState, ...]) -> None:
        self._alive = True
        foreign = any(each.open and not each.id.startswith(self._start) for each in states)
        self._drivers = replace(self._drivers, foreign=foreign)

    def on_goal_end(self, state: GoalState) -> None:
        if not self._goal or state.id != self._goal:
            return
        self._goal = ""
        if state.state == "cancelled":  # by another client: look who drives
            self._drivers = replace(self._drivers, driven=self._node.now() / SECOND)
        else:
            self._end = GoalEnd(state.state == "succeeded", state.text)

    def _note_cleared(self, result: Result) -> None:
        if not result.success:
            self._node.log.warn(f"the costmaps are not cleared: {result.text}")

    def _on_stopped(self, stopped: bool) -> None:
        self._drivers = replace(self._drivers, stopped=stopped)

    def _on_active(self, active: str) -> None:
        self._drivers = replace(self._drivers, active=active)

    def _on_lease(self, text: str) -> None:
        lease = read_lease(text)
        if lease is not None:
            self._drivers = replace(self._drivers, lease=lease)
