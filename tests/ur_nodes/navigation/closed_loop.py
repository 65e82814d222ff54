"""A kinematic robot in a grid world that closes the loop round the navigator: no ROS, no clock."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from tests.ur_nodes.scans import FakeScan

from ur_nodes.costmap.costmap import LETHAL, Costmap, Inflation
from ur_nodes.costmap.footprint import Footprint, footprint_of_outline
from ur_nodes.costmap.layers import UsedRanges, beams_of_scan
from ur_nodes.costmap.map_costmap import MapCostmap
from ur_nodes.costmap.rolling_costmap import RollingCostmap
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.navigator import Navigator
from ur_nodes.navigation.navigator_step import Ending, NavigatorInputs, NavigatorSettings, PlanAnswer
from ur_nodes.navigation.plan_request import PlanRequest, answer_request
from ur_nodes.navigation.planning.global_plan import PlanSettings, path_is_free
from ur_nodes.navigation.planning.outline_motions import Steering
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.recovery import Behaviour
from ur_nodes.navigation.steering.rollout import RolloutState
from ur_nodes.navigation.steering.speed_profile import AT_REST, SpeedLimits

STAGE = (
    (0.20, 0.15),
    (0.16, 0.19),
    (-0.16, 0.19),
    (-0.20, 0.15),
    (-0.20, -0.15),
    (-0.16, -0.19),
    (0.16, -0.19),
    (0.20, -0.15),
)
MAGNI = ((0.13, 0.205), (-0.28, 0.205), (-0.28, -0.205), (0.13, -0.205))
LONG = ((0.495, 0.335), (-0.495, 0.335), (-0.495, -0.335), (0.495, -0.335))
ORIGIN = Pose2(0.0, 0.0, 0.0)
ODOM = Pose2(0.7, -0.4, 0.3)  # where the map is in the odometry frame
LIMITS = SpeedLimits(0.5, 1.0, 1.0, 3.0)


def two_rooms() -> Grid:
    """Two rooms of 3 m x 4 m, joined by a door of 0.9 m; (0, 0) is in the middle of the left one."""
    values = np.zeros((84, 124), np.int8)
    values[[0, 1, -2, -1]] = 100
    values[:, [0, 1, -2, -1]] = 100
    values[:, 61:63] = 100
    values[50:68, 61:63] = 0
    return Grid(values, 0.05, Pose2(-1.6, -2.1, 0.0))


@dataclass(frozen=True, slots=True)
class Drive:
    """How a drive went."""

    ending: Ending | None
    text: str
    seconds: float
    length: float
    pose: Pose2
    touched: bool
    logged: tuple[str, ...]
    speeds: NDArray[np.float64]
    trace: NDArray[np.float64]
    plans: int


@dataclass
class ClosedLoop:
    """The robot of `outline` starts at `pose` in a world; `hidden` are cells (bool) that the map does not show."""

    grid: Grid
    pose: Pose2 = ORIGIN
    outline: tuple[tuple[float, float], ...] = STAGE
    limits: SpeedLimits = LIMITS
    settings: NavigatorSettings = field(default_factory=NavigatorSettings)
    plan_settings: PlanSettings = field(default_factory=PlanSettings)
    scaling: float = 25.0
    error: float = 0.0
    seed: int = 1
    odom: Pose2 = ODOM
    keep_out: Grid | None = None
    speed_mask: Grid | None = None
    share: Callable[[Pose2], float] = lambda _: 1.0

    def __post_init__(self) -> None:
        self.footprint: Footprint = footprint_of_outline(self.outline, self.grid.resolution, 0.01)
        self.bare = footprint_of_outline(self.outline, self.grid.resolution / 2)
        self.plan_settings = replace(self.plan_settings, room=self.footprint.circumscribed + self.grid.resolution)
        inflation = Inflation(self.footprint.inscribed, 0.55, self.scaling)
        self.global_costs = MapCostmap(self.grid, UsedRanges(2.5, 3.0), inflation, lethal=65, track_unknown=True)
        self.global_costs.forbid(self.keep_out)
        self.local_costs = RollingCostmap(4.0, self.grid.resolution, UsedRanges(2.5, 3.0), inflation)
        self.world = self.grid.values >= 65
        self.navigator = Navigator(self.settings, self.limits, self.footprint)
        self.now = 0.0
        self.command = AT_REST
        self.random = np.random.default_rng(self.seed)

    def add_obstacle(self, x: float, y: float, size: float) -> None:
        """A square box that the map does not know."""
        rows, columns = np.indices(self.world.shape)
        centres = self.grid.points_of_cells(np.stack((rows, columns), axis=-1))
        self.world |= (abs(centres[..., 0] - x) < size / 2) & (abs(centres[..., 1] - y) < size / 2)

    def drive(
        self,
        goal: Pose2,
        seconds: float = 200.0,
        obstacles: Iterable[tuple[float, float, float]] = (),
        *,
        any_heading: bool = False,
    ) -> Drive:
        """Pursue a goal until it ends or time is up."""
        for obstacle in obstacles:
            self.add_obstacle(*obstacle)
        self.navigator.start(goal, self.now, any_heading=any_heading)
        began, length, touched, plans, logged = self.now, 0.0, False, 0, []
        speeds, trace = [], []
        answer: PlanAnswer | None = None
        while self.now - began < seconds:
            before = self.pose
            self._scan()
            motion = RolloutState(self.odom.compose(self.pose), *self.command)
            path = self.navigator.path
            blocked = path is not None and not path_is_free(self.global_costs.costmap, path)
            out = self.navigator.step(
                NavigatorInputs(
                    self.now,
                    motion,
                    self._odom_of_map(),
                    LocalObstacles(self.local_costs.occupied()),
                    answer,
                    "",
                    blocked,
                    self.speed_mask,
                    self.share(self.pose),
                )
            )
            answer = None
            if out.log:
                logged.append(out.log)
            if out.clear:
                keep = self.pose if out.clear is Behaviour.CLEAR_FAR else None
                self.global_costs.clear(keep, 3.0)
                self.local_costs.clear(self.odom.compose(self.pose) if keep else None, 3.0)
            if out.plan:
                plans += 1
                answer = self._plan(goal)
            self.command = out.command or AT_REST
            self._move(0.1)
            self.now += 0.1
            speeds.append(self.command)
            trace.append(self.pose)
            length += math.hypot(self.pose.x - before.x, self.pose.y - before.y)
            touched = touched or self._touches()
            if out.ending is not None:
                break
        return Drive(
            out.ending,
            out.text,
            self.now - began,
            length,
            self.pose,
            touched,
            tuple(logged),
            np.array(speeds),
            np.array(trace),
            plans,
        )

    def _odom_of_map(self) -> Pose2:
        if self.error == 0.0:
            return self.odom
        return self.odom.compose(Pose2(*self.random.normal(0.0, (self.error, self.error, self.error / 4)).tolist()))

    def _plan(self, goal: Pose2) -> PlanAnswer:
        costs, start = self.global_costs, (self.pose.x, self.pose.y)
        request = PlanRequest(
            0, start, (goal.x, goal.y), costs.costmap, costs.static, yaw=self.pose.yaw, heading=goal.yaw
        )
        return answer_request(
            request,
            self.plan_settings,
            self.footprint,
            Steering(self.limits.radius, sideways=self.limits.lateral > 0.0, bend=self.limits.bend),
        )

    def _scan(self) -> None:
        angles = np.arange(360) * math.tau / 360 - math.pi
        x, y, yaw = self.pose
        directions = np.stack((np.cos(angles + yaw), np.sin(angles + yaw)), -1)
        ranges = np.full(360, math.inf)
        for steps in np.array_split(np.arange(0.02, 5.0, 0.02), 8):  # by pieces: most rays end early
            flying = np.flatnonzero(np.isinf(ranges))
            cells = self.grid.cells_of_points((x, y) + steps[None, :, None] * directions[flying, None])
            inside = self.grid.contains(cells)
            cells[~inside] = 0
            hit = self.world[cells[..., 0], cells[..., 1]] | ~inside
            ends = hit.any(axis=1)
            ranges[flying[ends]] = steps[hit[ends].argmax(axis=1)]
        ranges += self.random.normal(0.0, 0.01, 360)
        beams = beams_of_scan(FakeScan(ranges, 0.12, 5.0), inf_is_valid=True)
        self.global_costs.update(self.pose, beams)
        here = self.odom.compose(self.pose)
        if self.global_costs.zones is not None:
            self.local_costs.overlay(here, self.global_costs.zones, self.odom)
        self.local_costs.update(here, here, beams)

    def _move(self, dt: float) -> None:
        v, w, left = self.command
        for _ in range(4):
            c, s = math.cos(self.pose.yaw + w * dt / 8), math.sin(self.pose.yaw + w * dt / 8)
            self.pose = Pose2(
                self.pose.x + (v * c - left * s) * dt / 4,
                self.pose.y + (v * s + left * c) * dt / 4,
                self.pose.yaw + w * dt / 4,
            )

    def _touches(self) -> bool:
        costs = Costmap(
            np.where(self.world, np.uint8(LETHAL), np.uint8(0)).astype(np.uint8), self.grid.resolution, self.grid.origin
        )
        c, s = math.cos(self.pose.yaw), math.sin(self.pose.yaw)
        points = self.bare.samples @ np.array(((c, s), (-s, c))) + (self.pose.x, self.pose.y)
        return bool((costs.costs_at(points) == LETHAL).any())
