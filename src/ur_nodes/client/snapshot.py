"""The interface between user interfaces and a navigating robot: snapshots and requests."""

import math
from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.mux import MuxRequest, MuxView
from ur_nodes.client.patrol_text import PatrolAction, PatrolRoute, PatrolStatus
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.lease.view import Conduct, LeaseView

ROBOT = "the robot"
"""The name of what is silent when the whole robot is."""
_LITTLE = 0.3  # m: a deviation of the pose that is not worth a word


class LastGoalState(Enum):
    """The state of the last goal; the value is its text for users."""

    NONE = "no goal"
    WAITING = "sent"
    DRIVING = "driving"
    HELD = "held"
    UNKNOWN = "unknown"
    REACHED = "reached"
    STOPPED = "stopped"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class GoalReport:
    """The last goal, its number (0: none was sent yet), its state, and why when it failed, is held or has stopped.

    Of a goal that was reached, `text` says how far off the robot may be, where that is much.
    `any_heading`: the sender has asked for no heading, so that of `pose` means nothing.
    `recoveries`: how often navigation has freed the robot on the way, where it reports that.
    `UNKNOWN`: the robot is silent; the goal is neither over nor known to be driven to.
    """

    number: int = 0
    pose: Pose2 | None = None
    state: LastGoalState = LastGoalState.NONE
    text: str = ""
    any_heading: bool = False
    recoveries: int = 0

    @property
    def over(self) -> bool:
        """True once the goal has ended."""
        return self.state in (LastGoalState.NONE, LastGoalState.REACHED, LastGoalState.STOPPED, LastGoalState.FAILED)


def describe_recoveries(report: GoalReport) -> str:
    """Describe the recoveries of an active goal; '' for none."""
    count = 0 if report.over else report.recoveries
    return f"{count} {'recovery' if count == 1 else 'recoveries'}" if count else ""


def describe_doubt(spread: float | None) -> str:
    """Describe how far a robot may be from where it thinks it is, from the deviation (m); '' where that is little."""
    return f"up to {2.0 * spread:.1f} m off, the map shows no place nearer" if spread and spread > _LITTLE else ""


@dataclass(frozen=True, slots=True)
class Silence:
    """Nothing was received from `who` for `seconds`, although it sent messages before."""

    who: str
    seconds: float


@dataclass(frozen=True, eq=False)
class RobotSnapshot:
    """The state of the robot at one moment, in the map frame; None for what is not known.

    `scan` and `path` are (n, 2) in m; `speed` m/s and `turn` rad/s; `spread` the localiser's standard deviation in m;
    `missing` names what is waited for, for users; `silence` a sender that has fallen silent; `lost` the localiser's
    words while the robot is not where it was thought to be, else empty; `patrol` is None where no node drives patrols.
    """

    grid: Grid | None = None
    pose: Pose2 | None = None
    scan: NDArray[np.float64] | None = None
    path: NDArray[np.float64] | None = None
    goal: GoalReport = field(default_factory=GoalReport)
    speed: float = 0.0
    turn: float = 0.0
    spread: float | None = None
    lost: str = ""
    missing: tuple[str, ...] = ()
    mux: MuxView = field(default_factory=MuxView)
    lease: LeaseView = field(default_factory=LeaseView)
    conduct: Conduct = "drive"
    silence: Silence | None = None
    patrol: PatrolStatus | None = None


class NavigationClient(Protocol):
    """A robot that drives to goals. No call blocks; the result is in later snapshots."""

    def snapshot(self) -> RobotSnapshot:
        """Return the newest state."""

    def go(self, pose: Pose2, *, any_heading: bool = False) -> int:
        """Drive to a place, which replaces the last goal. Returns the goal's number in `GoalReport`.

        Raises UserError when it cannot be sent in time.
        """

    def request_lease(self, request: DriverRequest) -> None:
        """Request the lease, or release it."""

    def ask_patrol(self, action: PatrolAction, route: PatrolRoute) -> str:
        """Ask the robot to start, pause, resume or end a patrol; return the request's id, which the answer names.

        Raises UserError without a patrol node.
        """

    def stop(self) -> None:
        """Cancel the goal of any client."""

    def ask_mux(self, request: MuxRequest) -> None:
        """Request an emergency stop or its release."""

    def set_pose(self, pose: Pose2) -> None:
        """Set the estimated pose of the robot."""

    def relocalise(self) -> None:
        """Search for the robot on the whole map. Raises UserError when the localiser does not offer that."""


def distance_left(snapshot: RobotSnapshot) -> float | None:
    """Return the distance from the robot to the goal along the path, m; straight if there is no path to this goal."""
    goal, pose, path = snapshot.goal.pose, snapshot.pose, snapshot.path
    if goal is None or pose is None:
        return None
    here = np.array([pose.x, pose.y])
    straight = math.hypot(goal.x - pose.x, goal.y - pose.y)
    if path is None or len(path) < 2 or math.hypot(path[-1, 0] - goal.x, path[-1, 1] - goal.y) > 0.5:
        return straight
    nearest = int(np.argmin(np.sum((path - here) ** 2, axis=1)))
    rest = path[nearest:]
    return float(np.sum(np.hypot(*np.diff(rest, axis=0).T))) if len(rest) > 1 else straight


def heading_there(pose: Pose2 | None, x: float, y: float) -> float:
    """Return the yaw of a goal that asks for none, as upstream needs one: the direction from here to there."""
    if pose is None or math.hypot(x - pose.x, y - pose.y) < 0.05:
        return pose.yaw if pose else 0.0
    return math.atan2(y - pose.y, x - pose.x)


def format_pose(pose: Pose2, *, any_heading: bool = False) -> str:
    """Format a pose as the command `g` takes it, `1.20 3.40 90`; with `any_heading` without the angle."""
    x, y = format_number(pose.x, 2), format_number(pose.y, 2)
    return f"{x} {y}" if any_heading else f"{x} {y} {format_number(math.degrees(pose.yaw), 0)}"


def format_number(value: float, digits: int) -> str:
    """Format a number with `digits` decimals, never as negative zero."""
    return f"{round(value, digits) + 0.0:.{digits}f}"
