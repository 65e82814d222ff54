"""Inputs and outputs of a control step of the navigator, and its settings."""

from dataclasses import dataclass
from enum import Enum

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.planning.legs import Leg
from ur_nodes.navigation.planning.path_geometry import Points
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.recovery import Behaviour
from ur_nodes.navigation.steering.rollout import RolloutState
from ur_nodes.navigation.steering.speed_profile import DriveVelocity


class NavigatorPhase(Enum):
    """The activity of the navigator."""

    IDLE = "idle"
    PLANNING = "planning"
    DRIVING = "driving"
    TURNING = "turning"
    RECOVERING = "recovering"
    MAKING_ROOM = "making room"
    BACKING_OFF = "backing off"


class Ending(Enum):
    """The result of a goal that was not cancelled."""

    REACHED = "reached"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class NavigatorSettings:
    """Tolerances in m and rad; patience and periods in s, with the meaning of move_base's parameters.

    `planner_period` 0 plans again only when needed; `progress_timeout` is how long the robot may be
    commanded to move without moving; `progress_distance` forgets past recoveries.
    """

    period: float = 0.1
    xy_tolerance: float = 0.1
    yaw_tolerance: float = 0.05
    planner_period: float = 0.0
    planner_patience: float = 5.0
    controller_patience: float = 5.0
    people_patience: float = 30.0
    trouble_patience: float = 5.0
    recovery_enabled: bool = True
    progress_timeout: float = 10.0
    progress_distance: float = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class PlanAnswer:
    """The result of planning: `path` (n, 2) in the map, or None and the reason; `hopeless` when a retry cannot help.

    `legs` are those of a path that is not driven in one go, `last_turn` (rad) the turn on the spot at its end.
    """

    path: Points | None
    reason: str = ""
    hopeless: bool = False
    legs: tuple[Leg, ...] = ()
    last_turn: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class NavigatorInputs:
    """The inputs of one control step.

    `motion` is in the odometry frame, `odom` the pose of the map in that frame, `local` the surroundings of the robot
    in that frame. `trouble` is the reason why the robot must not move, '' when it may. `path_blocked`: the map with all
    obstacles shows an obstacle on the path that is being followed. `speed_mask`: percentages of the speed limit, on the
    map. `share` (0 to 1) of all speeds is allowed by the client that limits the robot. `contact` is how something that
    the lidar does not see has stopped the robot in this step; it is marked already. `beside`: such a mark is near.
    """

    now: float
    motion: RolloutState | None
    odom: Pose2
    local: LocalObstacles | None
    answer: PlanAnswer | None = None
    trouble: str = ""
    path_blocked: bool = False
    speed_mask: Grid | None = None
    share: float = 1.0
    contact: str = ""
    beside: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class NavigatorOutputs:
    """The outputs of a step.

    A command or silence; whether to plan (from the robot's place to the goal), and with care, as the path
    could not be followed, after it has `waited` so long (s) for people; what to clear; an ending with a text. `ahead`
    (t, 3) in the odometry frame are the poses that the local planner predicts; `log` is for the log.
    """

    command: DriveVelocity | None = None
    plan: bool = False
    careful: bool = False
    waited: float = 0.0
    clear: Behaviour | None = None
    ending: Ending | None = None
    text: str = ""
    ahead: Points | None = None
    log: str = ""
