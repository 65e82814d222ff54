"""From a map that grows to goals, and to the end of the exploration. Knows no ROS and no clock; time comes in."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ur_nodes.exploration.memory import Memory
from ur_nodes.exploration.reasons import Reason, at, explain_unreachable
from ur_nodes.exploration.search.choice import Weights, choose_viewpoint
from ur_nodes.exploration.search.corners import CornerSettings, Places, sort_corners
from ur_nodes.exploration.search.floor import Floor, read_floor
from ur_nodes.exploration.search.frontiers import Frontier, find_frontiers, unknown_behind
from ur_nodes.exploration.search.viewpoints import DISTANCES, Viewpoint, find_viewpoint, next_viewpoint
from ur_nodes.exploration.status import State, Status
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

_SAME_GOAL = 0.4  # m: a place nearer than this to the present goal is not worth a new one
_EXPLAINED_FOR = 10.0  # s
_NEWS = 0.5  # m2 of floor that the map must grow by to count as progress


@dataclass(frozen=True, slots=True)
class ExplorerSettings:
    """Lengths in m, times in s. `radius` of the robot; `room`: goals have so much, where they can, to turn there.

    `settle`: how long there must be nothing left before the end. `patience`: how long frontiers that failed are waited
    for. `attempts` at a frontier that navigation gave up. `corners`: frontiers that come last, or are left out.
    """

    radius: float
    room: float = 0.25
    smallest_frontier: float = 0.3
    progress_timeout: float = 30.0
    settle: float = 4.0
    patience: float = 15.0
    attempts: int = 2
    weights: Weights = field(default_factory=Weights)
    corners: CornerSettings = field(default_factory=CornerSettings)


@dataclass(frozen=True, slots=True, eq=False)
class Inputs:
    """The present state of the world. `version` grows with each map; `obstacles` as `read_floor` takes them.

    `ended`: the goal has ended since the last step; None: it has not. `paused`: why the robot must not be driven.
    """

    now: float
    grid: Grid
    version: int
    robot: Pose2
    obstacles: NDArray[np.floating] | None = None
    ended: GoalEnd | None = None
    paused: str = ""


@dataclass(frozen=True, slots=True)
class GoalEnd:
    """The end of a goal: reached, or not and why."""

    reached: bool
    text: str = ""


@dataclass(frozen=True, slots=True)
class Outputs:
    """Commands for navigation. `goal`: drive there, in place of what was pursued; `cancel` it; `clear` the costmaps."""

    status: Status
    goal: Pose2 | None = None
    cancel: bool = False
    clear: bool = False
    frontiers: tuple[Frontier, ...] = ()
    blocked: tuple[Frontier, ...] = ()


@dataclass(frozen=True, slots=True)
class _Pursuit:
    """A viewpoint that is driven to. `nearest` (m) is the shortest way left so far, at the time `progressed`."""

    viewpoint: Viewpoint
    nearest: float
    progressed: float


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """Frontiers of one map: those that can be looked at, and why the others cannot."""

    floor: Floor
    viewpoints: tuple[Viewpoint, ...]
    blocked: tuple[tuple[Frontier, Reason], ...]


class Explorer:
    """Explores one map. Call `step` again and again; deterministic."""

    def __init__(self, settings: ExplorerSettings) -> None:
        self._settings = settings
        self._memory = Memory()
        self._pursuit: _Pursuit | None = None
        self._view: _View | None = None
        self._version = -1
        self._began: float | None = None
        self._empty_since: float | None = None
        self._lost_since: float | None = None
        self._explained: tuple[tuple[float, tuple[float, float], Reason], ...] = ()
        self._cleared = False
        self._retried = False
        self._way = 0.0
        self._known, self._way_of_news = 0.0, 0.0  # m2 at the last progress, and the way until then
        self._last: Pose2 | None = None

    def step(self, inputs: Inputs) -> Outputs:
        """Decide what to do now. After a status that has ended there is nothing more to do."""
        self._measure(inputs)
        if inputs.paused:
            had, self._pursuit, self._empty_since = self._pursuit, None, None
            return Outputs(self._status("paused", inputs, reason=inputs.paused), cancel=had is not None)
        if inputs.ended is not None:
            self._take_end(inputs.ended)
        cancel = self._check_progress(inputs)
        if inputs.version != self._version or inputs.ended is not None or cancel or self._pursuit is None:
            self._look(inputs)
        view = self._view
        assert view is not None
        if not view.floor.reachable.any():
            return self._escape(inputs, cancel)
        self._lost_since = None
        return self._choose(inputs, view, cancel)

    @property
    def floor(self) -> Floor | None:
        """The floor of the newest map that was looked at."""
        return self._view.floor if self._view else None

    def stop(self, reason: str, now: float) -> Status:
        """The status when somebody ends the exploration."""
        return self._describe("stopped", now, reason)

    # -- events ----------------------------------------------------------------------------------------------------

    def _measure(self, inputs: Inputs) -> None:
        if self._began is None:
            self._began = inputs.now
        if self._last is not None:
            self._way += math.hypot(inputs.robot.x - self._last.x, inputs.robot.y - self._last.y)
        self._last = inputs.robot

    def _take_end(self, end: GoalEnd) -> None:
        pursuit, self._pursuit = self._pursuit, None
        if pursuit is None:
            return
        place = pursuit.viewpoint.frontier.place
        if end.reached:
            self._memory = self._memory.look(place, self._view.floor if self._view else None)
            return
        reason = Reason("failed", place, f"at {at(place)}: {end.text or 'navigation gave up'}")
        self._memory = self._memory.fail(place, reason, self._view.floor if self._view else None)

    def _check_progress(self, inputs: Inputs) -> bool:
        """Give the goal up when the robot gets no nearer; return whether it is to be cancelled."""
        pursuit = self._pursuit
        if pursuit is None:
            return False
        pose = pursuit.viewpoint.pose
        left = math.hypot(pose.x - inputs.robot.x, pose.y - inputs.robot.y)
        if self._view is not None and self._view.floor.contains(np.array(pursuit.viewpoint.cell)):
            way = self._way_left(pursuit.viewpoint)
            left = way if math.isfinite(way) else left
        if left < pursuit.nearest - 0.1:
            self._pursuit = replace(pursuit, nearest=left, progressed=inputs.now)
            return False
        if inputs.now - pursuit.progressed < self._settings.progress_timeout:
            return False
        self._take_end(GoalEnd(reached=False, text=f"no progress for {self._settings.progress_timeout:g} s"))
        return True

    def _way_left(self, viewpoint: Viewpoint) -> float:
        assert self._view is not None
        floor = self._view.floor
        row, column = floor.cell(viewpoint.pose.x, viewpoint.pose.y)
        return float(floor.distance[row, column]) if floor.contains(np.array((row, column))) else math.inf

    # -- the map ---------------------------------------------------------------------------------------------------

    def _look(self, inputs: Inputs) -> None:
        settings = self._settings
        self._version = inputs.version
        floor = read_floor(inputs.grid, inputs.robot, settings.radius, inputs.obstacles)
        self._memory = self._memory.refresh(floor)
        if floor.known > self._known + _NEWS:
            self._known, self._way_of_news = floor.known, self._way
        seen: list[Viewpoint] = []
        blocked: list[tuple[Frontier, Reason]] = []
        for frontier in find_frontiers(floor, settings.smallest_frontier):
            refused = self._memory.refused(frontier)
            if refused is not None:
                blocked.append((frontier, refused))
                continue
            looks = self._memory.find(frontier.place).looks
            viewpoint = next_viewpoint(floor, frontier, looks, settings.room)
            if viewpoint is not None:
                seen.append(viewpoint)
            elif looks and find_viewpoint(floor, frontier, DISTANCES[1]) is not None:
                reason = Reason("unseen", frontier.place, f"at {at(frontier.place)} the lidar sees nothing")
                blocked.append((frontier, reason))
            else:
                blocked.append((frontier, self._explain(inputs, floor, frontier)))
        self._view = _View(floor, tuple(seen), tuple(blocked))

    def _explain(self, inputs: Inputs, floor: Floor, frontier: Frontier) -> Reason:
        """Explain a frontier that nothing leads to; for some seconds the explanation is kept, as it takes a search."""
        for at_time, place, reason in self._explained:
            if math.dist(place, frontier.place) < 0.3 and inputs.now - at_time < _EXPLAINED_FOR:
                return reason
        reason = explain_unreachable(floor, frontier, inputs.grid.values >= 65)
        recent = (each for each in self._explained if inputs.now - each[0] < _EXPLAINED_FOR)
        self._explained = (*recent, (inputs.now, frontier.place, reason))
        return reason

    # -- decisions -------------------------------------------------------------------------------------------------

    def _choose(self, inputs: Inputs, view: _View, cancel: bool) -> Outputs:
        pursuit = self._pursuit
        kept = pursuit.viewpoint.frontier.place if pursuit else None
        places = self._places(view)
        weights = self._settings.weights
        best = choose_viewpoint(view.floor, places.now, replace(weights, keep=weights.keep + self._idle_way), kept)
        if best is None:
            return self._finish(inputs, view, cancel)
        self._empty_since = None
        frontiers = tuple(each.frontier for each in places.ahead)
        blocked = (*(frontier for frontier, _ in view.blocked), *(each.frontier for each in places.left_out))
        status = self._status("exploring", inputs)
        if (
            pursuit is not None
            and _near(pursuit.viewpoint.pose, best.pose)
            and math.isfinite(self._way_left(pursuit.viewpoint))
        ):
            self._pursuit = replace(pursuit, viewpoint=replace(pursuit.viewpoint, frontier=best.frontier))
            return Outputs(status, cancel=False, frontiers=frontiers, blocked=blocked)
        self._pursuit = _Pursuit(best, best.way, inputs.now)
        return Outputs(status, goal=best.pose, frontiers=frontiers, blocked=blocked)

    def _places(self, view: _View) -> Places:
        kept = self._pursuit.viewpoint.frontier.place if self._pursuit else None
        return sort_corners(view.viewpoints, view.floor.known, self._settings.corners, kept, self._idle_way)

    @property
    def _idle_way(self) -> float:
        """The way (m) since the map last grew. The longer it is, the more the robot keeps to where it drives.

        Gains change with each map: it could turn back and forth between two places for ever.
        """
        return self._way - self._way_of_news

    def _finish(self, inputs: Inputs, view: _View, cancel: bool) -> Outputs:
        """Nothing is left to look at: wait for a moment, try again what failed, then end."""
        cancel = cancel or self._pursuit is not None
        self._pursuit = None
        if self._empty_since is None:
            self._empty_since = inputs.now
        waited = inputs.now - self._empty_since
        retriable = [reason for _, reason in view.blocked if reason.kind in ("failed", "obstacle")]
        left_out = (each.frontier for each in self._places(view).left_out)
        blocked = (*(frontier for frontier, _ in view.blocked), *left_out)
        if waited < (self._settings.patience if retriable else self._settings.settle):
            status = self._status("exploring", inputs)
            clear = bool(retriable) and not self._cleared and waited > self._settings.settle
            self._cleared = self._cleared or clear
            return Outputs(status, cancel=cancel, clear=clear, blocked=blocked)
        again = self._memory.retry(self._settings.attempts)
        if again != self._memory:
            self._memory, self._version, self._empty_since = again, -1, None
            return Outputs(self._status("exploring", inputs), cancel=cancel, blocked=blocked)
        return Outputs(self._status("complete", inputs), cancel=cancel, blocked=blocked)

    def _escape(self, inputs: Inputs, cancel: bool) -> Outputs:
        """The robot stands where it does not fit: have the costmaps cleared, and end when that does not help."""
        cancel = cancel or self._pursuit is not None
        self._pursuit = None
        if self._lost_since is None:
            self._lost_since = inputs.now
        waited = inputs.now - self._lost_since
        where = at((inputs.robot.x, inputs.robot.y))
        reason = f"the robot at {where} is too near to an obstacle, no free place is within 0.5 m"
        if waited < self._settings.patience:
            return Outputs(self._status("starting", inputs, reason=reason), cancel=cancel, clear=waited == 0.0)
        return Outputs(self._status("incomplete", inputs, reason=reason), cancel=cancel)

    def _status(self, state: State, inputs: Inputs, reason: str = "") -> Status:
        return self._describe(state, inputs.now, reason)

    def _describe(self, state: State, now: float, reason: str) -> Status:
        view = self._view
        seconds = now - self._began if self._began is not None else 0.0
        if view is None:
            return Status(state=state, way=self._way, seconds=seconds, reason=reason)
        places = self._places(view)
        frontiers = tuple(each.frontier for each in places.ahead)
        return Status(
            state=state,
            reachable=len(frontiers),
            unknown=unknown_behind(view.floor, frontiers),
            known=view.floor.known,
            way=self._way,
            seconds=seconds,
            unreachable=tuple(dict.fromkeys(reason.text for _, reason in view.blocked)),
            corners=tuple(at(each.frontier.place) for each in places.left_out),
            reason=reason,
        )


def _near(a: Pose2, b: Pose2) -> bool:
    return math.hypot(a.x - b.x, a.y - b.y) < _SAME_GOAL
