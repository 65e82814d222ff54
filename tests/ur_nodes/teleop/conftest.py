from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ur.source.diagnostic import UserError, error
from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.mux import MuxRequest
from ur_nodes.client.patrol_text import PatrolAction, PatrolAnswer, PatrolRoute, PatrolState, PatrolStatus
from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2


def make_grid() -> Grid:
    """10 m x 10 m, walls round it, the origin in the middle."""
    cells = np.zeros((100, 100), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    return Grid(cells, 0.1, Pose2(-5.0, -5.0, 0.0))


class FakeNavigator:
    """A Navigator whose state the test sets, and that notes what was asked of it."""

    def __init__(self) -> None:
        self.seen = RobotSnapshot(grid=make_grid(), pose=Pose2(0.0, 0.0, 0.0))
        self.goals: list[Pose2] = []
        self.any_heading = False
        self.poses: list[Pose2] = []
        self.patrols: list[tuple[PatrolAction, PatrolRoute]] = []
        self.patrol_problem = ""
        self.stops = 0
        self.searches = 0
        self.offers_search = True
        self.asked: list[MuxRequest] = []
        self.requests: list[DriverRequest] = []
        self.problem: UserError | None = None

    def snapshot(self) -> RobotSnapshot:
        return self.seen

    def go(self, pose: Pose2, *, any_heading: bool = False) -> int:
        if self.problem:
            raise self.problem
        self.goals.append(pose)
        self.any_heading = any_heading
        number = self.seen.goal.number + 1
        self.seen = replace(self.seen, goal=GoalReport(number, pose, LastGoalState.DRIVING, any_heading=any_heading))
        return number

    def ask_patrol(self, action: PatrolAction, route: PatrolRoute) -> str:
        self.patrols.append((action, route))
        answer = PatrolAnswer(f"id-{len(self.patrols)}", self.patrol_problem)
        state: PatrolState = "driving" if action in ("start", "resume") and not self.patrol_problem else "ended"
        self.seen = replace(self.seen, patrol=PatrolStatus(state, route, answer=answer))
        return answer.id

    def stop(self) -> None:
        self.stops += 1
        if not self.seen.goal.over:
            self.end(LastGoalState.STOPPED)

    def request_lease(self, request: DriverRequest) -> None:
        self.requests.append(request)

    def ask_mux(self, request: MuxRequest) -> None:
        self.asked.append(request)
        self.seen = replace(self.seen, mux=replace(self.seen.mux, stopped=request == "stop"))

    def set_pose(self, pose: Pose2) -> None:
        self.poses.append(pose)

    def relocalise(self) -> None:
        if not self.offers_search:
            raise UserError(error("service /global_localization: unavailable, expected one", rule="no-service"))
        self.searches += 1

    def end(self, state: LastGoalState, text: str = "") -> None:
        self.seen = replace(self.seen, goal=replace(self.seen.goal, state=state, text=text))

    def move(self, pose: Pose2) -> None:
        self.seen = replace(self.seen, pose=pose)


@pytest.fixture
def navigator() -> FakeNavigator:
    return FakeNavigator()


@pytest.fixture
def store(tmp_path: Path) -> WaypointStore:
    return WaypointStore(tmp_path / "waypoints" / "maze.yaml")
