"""Goals from the frontiers of a growing map, and the end of the exploration, without ROS and without a clock."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from skimage.graph import MCP_Geometric

from ur_nodes.exploration.explorer_step import ExplorerInputs, ExplorerOutputs, ExplorerSettings, GoalEnd
from ur_nodes.exploration.search.choice import Viewpoints, choose_viewpoint, sort_corners
from ur_nodes.exploration.search.floor import ESCAPE, OCCUPIED_FROM, Floor, read_floor
from ur_nodes.exploration.search.frontiers import Frontier, find_frontiers, unknown_behind
from ur_nodes.exploration.search.viewpoints import DISTANCES, Viewpoint, find_viewpoint, next_viewpoint
from ur_nodes.exploration.status import ExploreStatus, State
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, wrap_angle

Kind = Literal["narrow", "obstacle", "behind", "apart", "unseen", "failed"]

_THROUGH_UNKNOWN = 30.0  # the cost of a cell, against 1 for a free one
_THROUGH_OBSTACLE = 1000.0


@dataclass(frozen=True, slots=True)
class Reason:
    """The kind of a reason, the place (m) that blocks the way, and a clause for people."""

    kind: Kind
    point: tuple[float, float]
    text: str


def explain_unreachable(floor: Floor, frontier: Frontier, map_walls: np.ndarray | None = None) -> Reason:
    """Explain why the robot can reach no place that sees a frontier.

    `map_walls` (height, width): the occupied cells of the map alone; other occupied ones are obstacles that sensors see
    now.
    """
    narrow = 1.0 / np.maximum(floor.clearance, 0.5 * floor.resolution)
    tight = np.where(floor.clearance > floor.radius, 1.0, 1.0 + narrow**2)
    costs = np.where(floor.free, tight, np.where(floor.unknown, _THROUGH_UNKNOWN, _THROUGH_OBSTACLE))
    goals = np.argwhere(floor.reachable)
    if not len(goals):
        return Reason("apart", frontier.point, "the robot does not know how to get out of its place")
    search = MCP_Geometric(costs)
    totals, _ = search.find_costs([tuple(cell) for cell in frontier.cells.tolist()], find_all_ends=False)
    lengths = totals[goals[:, 0], goals[:, 1]]
    path = np.array(search.traceback(tuple(goals[int(np.argmin(lengths))].tolist())))
    path = path[::-1]  # from the robot's side
    rows, columns = path[:, 0], path[:, 1]
    crossed = floor.occupied[rows, columns]
    if crossed.any():
        place = floor.point(tuple(path[int(np.argmax(crossed))].tolist()))
        if map_walls is not None and not map_walls[rows, columns][crossed].any():
            return Reason("obstacle", place, f"behind an obstacle at {at(place)}")
        return Reason("behind", place, f"behind the glass or through a gap at {at(place)}")
    room = np.where(floor.unknown[rows, columns], np.inf, floor.clearance[rows, columns])
    tightest = int(np.argmin(room))
    place = floor.point(tuple(path[tightest].tolist()))
    # From the centre of one wall's cell to that of the other; half of either cell belongs to the wall.
    width = max(0.0, 2.0 * float(room[tightest]) - floor.resolution)
    if room[tightest] <= floor.radius:
        return Reason("narrow", place, f"too narrow at {at(place)}: {width:.2f} m < {2.0 * floor.radius:.2f} m")
    if floor.unknown[rows, columns].any():
        return Reason("apart", frontier.point, "no known floor leads to it")
    return Reason("unseen", frontier.point, "no place that the robot gets to is in sight of it")


def at(point: tuple[float, float]) -> str:
    """Describe a place of the map in words for users."""
    return f"({point[0]:.2f}, {point[1]:.2f})"


_SAME_FRONTIER = 0.6  # m: frontiers nearer than this are one and the same
_AROUND = 1.0  # m: a change of the map this near to a frontier makes it worth another attempt
_CHANGED = 0.15  # m2


@dataclass(frozen=True, slots=True)
class Attempt:
    """A frontier that was driven to. `looks`: how often its place was reached; `failures`: how often not.

    `reason` is None unless it is given up; `known` is the known space near it at the last of these, m2.
    """

    point: tuple[float, float]
    looks: int = 0
    failures: int = 0
    reason: Reason | None = None
    known: float = 0.0


@dataclass(frozen=True, slots=True)
class AttemptMemory:
    """Attempts, one for a frontier. Each method returns a new memory."""

    attempts: tuple[Attempt, ...] = ()

    def find(self, point: tuple[float, float]) -> Attempt:
        """Return the attempt at the frontier at a place; a new one if there was none."""
        near = [each for each in self.attempts if math.dist(each.point, point) < _SAME_FRONTIER]
        return min(near, key=lambda each: math.dist(each.point, point)) if near else Attempt(point)

    def note(self, attempt: Attempt) -> AttemptMemory:
        """Replace the earlier attempt at the same frontier."""
        old = self.find(attempt.point)
        return AttemptMemory((*(each for each in self.attempts if each is not old), attempt))

    def look(self, point: tuple[float, float], floor: Floor | None) -> AttemptMemory:
        """Note that the robot reached the place from which the frontier should be visible."""
        old = self.find(point)
        known = known_space(floor, old.point) if floor else 0.0
        return self.note(replace(old, looks=old.looks + 1, known=known))

    def fail(self, point: tuple[float, float], reason: Reason, floor: Floor | None) -> AttemptMemory:
        """Note that the robot did not reach the frontier."""
        old = self.find(point)
        known = known_space(floor, old.point) if floor else 0.0
        return self.note(replace(old, failures=old.failures + 1, reason=reason, known=known))

    def refresh(self, floor: Floor) -> AttemptMemory:
        """Forget attempts where the map has changed: a frontier that recedes when it is seen has not failed."""
        return AttemptMemory(tuple(_refreshed(each, floor) for each in self.attempts))

    def retry(self, most: int) -> AttemptMemory:
        """Allow another attempt at frontiers that have failed less than `most` times."""
        return AttemptMemory(
            tuple(
                replace(each, reason=None)
                if each.reason and each.reason.kind == "failed" and each.failures < most
                else each
                for each in self.attempts
            )
        )

    def refused(self, frontier: Frontier) -> Reason | None:
        """Return the reason why a frontier is not tried now; None if it is."""
        return self.find(frontier.point).reason


def known_space(floor: Floor, point: tuple[float, float]) -> float:
    """The known space near a place, m2; floor and obstacles."""
    row, column = floor.cell(*point)
    reach = math.ceil(_AROUND / floor.resolution)
    rows, columns = (slice(max(0, at - reach), max(0, at + reach + 1)) for at in (row, column))
    return float(np.count_nonzero(~floor.unknown[rows, columns])) * floor.resolution**2


def _refreshed(attempt: Attempt, floor: Floor) -> Attempt:
    if abs(known_space(floor, attempt.point) - attempt.known) < _CHANGED:
        return attempt
    return Attempt(attempt.point)


_KEPT_FOR = 10.0  # s: an explanation takes a search of the whole map
_SAME = 0.3  # m: a frontier this near to one that was explained is the same


@dataclass(frozen=True, slots=True, eq=False)
class Survey:
    """The floor of a map, the places that show its frontiers, and the `blocked` frontiers, each with the reason."""

    floor: Floor
    viewpoints: tuple[Viewpoint, ...]
    blocked: tuple[tuple[Frontier, Reason], ...]


def survey_frontiers(
    floor: Floor, memory: AttemptMemory, explain: Callable[[Frontier], Reason], *, smallest: float, room: float
) -> Survey:
    """Find a viewpoint for each frontier of at least `smallest` m that the memory does not refuse.

    Viewpoints have `room` m around them where they can. `explain` is called for frontiers that nothing leads to.
    """
    viewpoints: list[Viewpoint] = []
    blocked: list[tuple[Frontier, Reason]] = []
    for frontier in find_frontiers(floor, smallest):
        found = _find_view(floor, memory, frontier, explain, room)
        if isinstance(found, Viewpoint):
            viewpoints.append(found)
        else:
            blocked.append((frontier, found))
    return Survey(floor, tuple(viewpoints), tuple(blocked))


def _find_view(
    floor: Floor, memory: AttemptMemory, frontier: Frontier, explain: Callable[[Frontier], Reason], room: float
) -> Viewpoint | Reason:
    refused = memory.refused(frontier)
    if refused is not None:
        return refused
    looks = memory.find(frontier.point).looks
    viewpoint = next_viewpoint(floor, frontier, looks, room)
    if viewpoint is not None:
        return viewpoint
    if looks and find_viewpoint(floor, frontier, DISTANCES[1]) is not None:
        return Reason("unseen", frontier.point, f"at {at(frontier.point)} the lidar sees nothing")
    return explain(frontier)


class Explanations:
    """Explains unreachable frontiers, and keeps each explanation for some seconds."""

    def __init__(self) -> None:
        self._kept: tuple[tuple[float, tuple[float, float], Reason], ...] = ()  # time (s), place (m) of the frontier

    def explain(self, now: float, grid: Grid, floor: Floor, frontier: Frontier) -> Reason:
        """Return the reason why no place that the robot gets to shows a frontier; `floor` is that of `grid`."""
        for explained_at, place, reason in self._kept:
            if math.dist(place, frontier.point) < _SAME and now - explained_at < _KEPT_FOR:
                return reason
        reason = explain_unreachable(floor, frontier, grid.values >= OCCUPIED_FROM)
        recent = (each for each in self._kept if now - each[0] < _KEPT_FOR)
        self._kept = (*recent, (now, frontier.point, reason))
        return reason


_WINDOW = 60.0  # s: the growth of the map is measured over so long
_SHORTEST = 30.0  # s: a shorter time gives no estimate
_LEAST = 0.05  # m2/s: slower growth gives no estimate
_APART = 1.0  # s between two samples that are kept

_FACTOR = 2.2
"""The time left over the unknown floor divided by the growth: each frontier hides more than is counted behind it.

Fitted with bench/exploration: of the times left, flats need 0.6 to 2.0 for it, the office 2.1 and the maze 3.4. Half of
the estimates are within a factor of 1.4 of the truth, and nine of ten within 2.8.
"""


@dataclass(frozen=True, slots=True)
class Pace:
    """Known floor (m2) at times (s) of the last minute, oldest first."""

    samples: tuple[tuple[float, float], ...] = ()

    def note(self, now: float, known: float) -> Pace:
        """Add a sample and drop those that are too old; all of them if the time has jumped back."""
        kept = tuple(each for each in self.samples if now - _WINDOW <= each[0] <= now)
        if len(kept) > 1 and kept[-1][0] - kept[-2][0] < _APART:
            kept = kept[:-1]
        return Pace((*kept, (now, known)))

    def seconds_left(self, unknown: float) -> float | None:
        """The time (s) until `unknown` m2 are explored at this pace; None while too little is known about it."""
        if not self.samples or unknown <= 0.0:
            return None
        (began, before), (now, known) = self.samples[0], self.samples[-1]
        seconds = now - began
        if seconds < _SHORTEST or known - before < _LEAST * seconds:
            return None
        return _FACTOR * unknown * seconds / (known - before)


_SAME_GOAL = 0.4  # m: a place nearer than this to the present goal is not worth a new one
_NEWS = 0.5  # m2 of floor that the map must grow by to count as news
_TURN = 0.3  # m that a radian turned counts as, where the robot's effort without news is measured
_PROGRESS = 0.1  # m: by so much less than before must be left to count as progress


@dataclass(frozen=True, slots=True)
class _Pursuit:
    """A viewpoint that is driven to. `nearest` (m) is the least distance left so far, at the time `progressed` (s)."""

    viewpoint: Viewpoint
    nearest: float
    progressed: float


class Explorer:
    """Explores one map by repeated calls of `step`; deterministic. `settings` may be replaced between two of them."""

    def __init__(self, settings: ExplorerSettings) -> None:
        self.settings = settings
        self._memory = AttemptMemory()
        self._pursuit: _Pursuit | None = None
        self._survey: Survey | None = None
        self._explanations = Explanations()
        self._version = -1  # of the map that was surveyed
        self._began: float | None = None  # s
        self._empty_since: float | None = None  # s: since then nothing is left to drive to
        self._enclosed_since: float | None = None  # s: since then the robot is where it does not fit
        self._cleared = False  # the costmaps, for what was left at the end
        self._robot: Pose2 | None = None  # at the last step
        self._travelled = 0.0  # m
        self._effort = 0.0  # m travelled, and turns
        self._known, self._effort_at_news = 0.0, 0.0  # m2 and m, when the map last grew
        self._pace = Pace()

    def step(self, inputs: ExplorerInputs) -> ExplorerOutputs:
        """Decide the next commands. After a status that has ended there are none."""
        self._measure_travel(inputs)
        if inputs.paused:
            had, self._pursuit, self._empty_since = self._pursuit, None, None
            return ExplorerOutputs(self._status("paused", inputs.now, reason=inputs.paused), cancel=had is not None)
        if inputs.ended is not None:
            self._end_pursuit(inputs.ended)
        cancel = self._check_progress(inputs)
        if inputs.version != self._version or inputs.ended is not None or cancel or self._pursuit is None:
            self._survey_map(inputs)
        survey = self._survey
        assert survey is not None
        if not survey.floor.reachable.any():
            return self._escape(inputs, cancel)
        self._enclosed_since = None
        return self._choose(inputs, survey, cancel)

    @property
    def floor(self) -> Floor | None:
        """Return the floor of the newest map that was used."""
        return self._survey.floor if self._survey else None

    # -- events ----------------------------------------------------------------------------------------------------

    def _measure_travel(self, inputs: ExplorerInputs) -> None:
        if self._began is None:
            self._began = inputs.now
        if self._robot is not None:
            step = math.hypot(inputs.robot.x - self._robot.x, inputs.robot.y - self._robot.y)
            self._travelled += step
            self._effort += step + _TURN * abs(wrap_angle(inputs.robot.yaw - self._robot.yaw))
        self._robot = inputs.robot

    def _end_pursuit(self, end: GoalEnd) -> None:
        pursuit, self._pursuit = self._pursuit, None
        if pursuit is None:
            return
        place = pursuit.viewpoint.frontier.point
        if end.reached:
            self._memory = self._memory.look(place, self.floor)
            return
        reason = Reason("failed", place, f"at {at(place)}: {end.text or 'navigation gave up'}")
        self._memory = self._memory.fail(place, reason, self.floor)

    def _check_progress(self, inputs: ExplorerInputs) -> bool:
        """Give up the goal when the robot gets no nearer; return whether to cancel it."""
        pursuit = self._pursuit
        if pursuit is None:
            return False
        pose = pursuit.viewpoint.pose
        left = self._distance_left(pursuit.viewpoint)
        if not math.isfinite(left):
            left = math.hypot(pose.x - inputs.robot.x, pose.y - inputs.robot.y)
        if left < pursuit.nearest - _PROGRESS:
            self._pursuit = replace(pursuit, nearest=left, progressed=inputs.now)
            return False
        if inputs.now - pursuit.progressed < self.settings.progress_timeout:
            return False
        self._end_pursuit(GoalEnd(reached=False, text=f"no progress for {self.settings.progress_timeout:g} s"))
        return True

    def _distance_left(self, viewpoint: Viewpoint) -> float:
        """Return the distance (m) to drive to a viewpoint on the newest map; inf if it is not reachable."""
        floor = self.floor
        if floor is None:
            return math.inf
        row, column = floor.cell(viewpoint.pose.x, viewpoint.pose.y)
        return float(floor.distance[row, column]) if floor.contains(np.array((row, column))) else math.inf

    # -- the map ---------------------------------------------------------------------------------------------------

    def _survey_map(self, inputs: ExplorerInputs) -> None:
        settings = self.settings
        self._version = inputs.version
        floor = read_floor(inputs.grid, inputs.robot, settings.radius, inputs.obstacles)
        self._memory = self._memory.refresh(floor)
        if floor.known > self._known + _NEWS:
            self._known, self._effort_at_news = floor.known, self._effort
        self._survey = survey_frontiers(
            floor,
            self._memory,
            lambda frontier: self._explanations.explain(inputs.now, inputs.grid, floor, frontier),
            smallest=settings.smallest_frontier,
            room=settings.room,
        )

    # -- decisions -------------------------------------------------------------------------------------------------

    def _choose(self, inputs: ExplorerInputs, survey: Survey, cancel: bool) -> ExplorerOutputs:
        pursuit = self._pursuit
        kept = pursuit.viewpoint.frontier.point if pursuit else None
        places = self._places(survey)
        weights = self.settings.weights
        best = choose_viewpoint(
            survey.floor, places.now, replace(weights, keep=weights.keep + self._idle_distance), kept
        )
        if best is None:
            return self._finish(inputs, survey, cancel)
        self._empty_since = None
        frontiers = tuple(each.frontier for each in places.ahead)
        blocked = (*(frontier for frontier, _ in survey.blocked), *(each.frontier for each in places.left_out))
        status = self._status("exploring", inputs.now)
        if (
            pursuit is not None
            and _near(pursuit.viewpoint.pose, best.pose)
            and math.isfinite(self._distance_left(pursuit.viewpoint))
        ):
            self._pursuit = replace(pursuit, viewpoint=replace(pursuit.viewpoint, frontier=best.frontier))
            return ExplorerOutputs(status, cancel=False, frontiers=frontiers, blocked=blocked)
        self._pursuit = _Pursuit(best, best.distance, inputs.now)
        return ExplorerOutputs(status, goal=best.pose, frontiers=frontiers, blocked=blocked)

    def _places(self, survey: Survey) -> Viewpoints:
        kept = self._pursuit.viewpoint.frontier.point if self._pursuit else None
        return sort_corners(survey.viewpoints, survey.floor.known, self.settings.corners, kept, self._idle_distance)

    @property
    def _idle_distance(self) -> float:
        """The distance (m) driven since the map last grew, and turned. It makes the robot keep to its goal.

        Gains change with each map: it could turn back and forth between two places for ever.
        """
        return self._effort - self._effort_at_news

    def _finish(self, inputs: ExplorerInputs, survey: Survey, cancel: bool) -> ExplorerOutputs:
        """Nothing is left to look at: wait for a moment, try again what failed, then end."""
        cancel = cancel or self._pursuit is not None
        self._pursuit = None
        if self._empty_since is None:
            self._empty_since = inputs.now
        waited = inputs.now - self._empty_since
        retriable = [reason for _, reason in survey.blocked if reason.kind in ("failed", "obstacle")]
        left_out = (each.frontier for each in self._places(survey).left_out)
        blocked = (*(frontier for frontier, _ in survey.blocked), *left_out)
        if waited < (self.settings.patience if retriable else self.settings.settle):
            status = self._status("exploring", inputs.now)
            clear = bool(retriable) and not self._cleared and waited > self.settings.settle
            self._cleared = self._cleared or clear
            return ExplorerOutputs(status, cancel=cancel, clear=clear, blocked=blocked)
        again = self._memory.retry(self.settings.attempts)
        if again != self._memory:
            self._memory, self._version, self._empty_since = again, -1, None
            return ExplorerOutputs(self._status("exploring", inputs.now), cancel=cancel, blocked=blocked)
        return ExplorerOutputs(self._status("complete", inputs.now), cancel=cancel, blocked=blocked)

    def _escape(self, inputs: ExplorerInputs, cancel: bool) -> ExplorerOutputs:
        """Clear the costmaps if the robot's own place is occupied; end the exploration if that does not help."""
        cancel = cancel or self._pursuit is not None
        self._pursuit = None
        if self._enclosed_since is None:
            self._enclosed_since = inputs.now
        waited = inputs.now - self._enclosed_since
        where = at((inputs.robot.x, inputs.robot.y))
        reason = f"the robot at {where} is too near to an obstacle, no free place is within {ESCAPE:g} m"
        if waited < self.settings.patience:
            return ExplorerOutputs(
                self._status("starting", inputs.now, reason=reason), cancel=cancel, clear=waited == 0.0
            )
        return ExplorerOutputs(self._status("incomplete", inputs.now, reason=reason), cancel=cancel)

    def _status(self, state: State, now: float, reason: str = "") -> ExploreStatus:
        survey = self._survey
        seconds = now - self._began if self._began is not None else 0.0
        if survey is None:
            return ExploreStatus(state=state, way=self._travelled, seconds=seconds, reason=reason)
        places = self._places(survey)
        frontiers = tuple(each.frontier for each in places.ahead)
        unknown = unknown_behind(survey.floor, frontiers)
        self._pace = self._pace.note(now, survey.floor.known) if state == "exploring" else Pace()
        return ExploreStatus(
            state=state,
            reachable=len(frontiers),
            unknown=unknown,
            known=survey.floor.known,
            way=self._travelled,
            seconds=seconds,
            unreachable=tuple(dict.fromkeys(reason.text for _, reason in survey.blocked)),
            corners=tuple(at(each.frontier.point) for each in places.left_out),
            reason=reason,
            left=self._pace.seconds_left(unknown),
        )


def _near(a: Pose2, b: Pose2) -> bool:
    return math.hypot(a.x - b.x, a.y - b.y) < _SAME_GOAL
