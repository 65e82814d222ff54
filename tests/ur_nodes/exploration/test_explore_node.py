"""The node `explore` on a bus: a map that somebody draws, and a navigation that arrives at once."""

import numpy as np
from tests.ur_nodes.exploration.drawn import ROOM, draw, place

from ur_nodes.exploration.explore_node import ExploreNode
from ur_nodes.exploration.status import ExploreStatus, read_status
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.lease.text import FREE, write_lease
from ur_nodes.ports.actions import GoalHandle
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Silent, Trigger
from ur_nodes.ports.values import Map, MapUpdate, Markers, Result, Transform

KNOWN = ROOM.replace("...........?", "......#?????")


class ExploreWorld:
    """A robot whose navigation puts it at its goal after `takes` s, or ends the goal with `ends`."""

    def __init__(self, text: str = ROOM, **parameters: object) -> None:
        self.bus = Bus()
        self.bus.parameters.update({"/move_base/global_costmap/robot_radius": 0.2})
        self.bus.parameters.update({f"/explore/{name}": value for name, value in parameters.items()})
        self.robot = place(3, 4)
        self.takes = 2.0
        self.goals: list[Pose2] = []
        self.cleared = 0
        self.saved = 0
        self.statuses: list[ExploreStatus] = []
        self.shown: list[Markers] = []
        self._handle: GoalHandle | None = None
        self._node = node = self.bus.node("world")
        node.serve_goals("move_base", self)
        node.serve("move_base/clear_costmaps", Silent, self._clear)
        node.serve("save_map", Trigger, self._save)
        self._maps = node.publish("map", Map, Quality.LATCHED)
        self.stopped = node.publish("cmd_vel_mux/stopped", bool, Quality.LATCHED)
        self.active = node.publish("cmd_vel_mux/active", str, Quality.LATCHED)
        self.leases = node.publish("cmd_vel_mux/lease", str, Quality.LATCHED)
        self.costs = node.publish("move_base/global_costmap/costmap", Map, Quality.LATCHED)
        self.changes = node.publish("move_base/global_costmap/costmap_updates", MapUpdate, Quality.EVERY)
        self.leases.send(write_lease(FREE))
        self.show(text)
        node.every(0.05, self._send_pose)
        node.subscribe("explore/status", str, self._take_status)
        node.subscribe("explore/frontiers", Markers, self.shown.append)
        self.explore = self.bus.node("explore")
        ExploreNode(self.explore)

    def show(self, text: str) -> None:
        self._maps.send(Map(self.bus.now, "map", draw(text)))

    def run_until(self, state: str, seconds: float = 300.0) -> ExploreStatus:
        assert self.bus.run_until(lambda: bool(self.statuses) and self.statuses[-1].state == state, seconds), (
            self.statuses[-1:]
        )
        return self.statuses[-1]

    def handle_goal(self, handle: GoalHandle) -> None:
        if self._handle is not None:
            self._handle.cancel("replaced")
        handle.accept()
        self._handle = handle
        self.goals.append(handle.goal.target.pose)
        self._node.after(self.takes, lambda: self._arrive(handle))

    def handle_cancel(self, handle: GoalHandle) -> None:
        if handle is self._handle:
            self._handle = None
            handle.cancel("cancelled")

    def _arrive(self, handle: GoalHandle) -> None:
        if handle is self._handle:
            self._handle, self.robot = None, handle.goal.target.pose
            handle.succeed("reached")

    def _send_pose(self) -> None:
        self._node.transforms.send(Transform(self.bus.now, "map", "base_footprint", self.robot.in_space()))

    def _take_status(self, text: str) -> None:
        status = read_status(text)
        assert status is not None
        self.statuses.append(status)

    def _clear(self, _request: Silent) -> Result:
        self.cleared += 1
        return Result(success=True)

    def _save(self, _request: Trigger) -> Result:
        self.saved += 1
        return Result(success=True, text="flat")


def test_drives_to_the_frontier_and_ends_when_the_map_is_complete_and_saved() -> None:
    world = ExploreWorld(save_service="save_map")
    world.takes = 20.0
    world.bus.run(3.0)
    assert world.statuses[-1].state == "exploring"
    assert world.goals[0].x > place(6, 4).x
    assert len(world.shown[-1].markers) == 1
    world.show(KNOWN)
    end = world.run_until("complete")
    assert end.saved == "flat"
    assert world.saved >= 2
    count = len(world.statuses)
    world.bus.run(30.0)
    assert len(world.statuses) == count


def test_waits_for_map_and_navigation_and_says_so() -> None:
    bus = Bus()
    bus.parameters["/move_base/global_costmap/robot_radius"] = 0.2
    node = bus.node("explore")
    ExploreNode(node)
    bus.run(1.0)
    (line,) = [text for _, text in node.lines]
    assert "no map on /map; is a mapping node running?" in line


def test_pauses_at_the_emergency_stop_and_goes_on_after_it() -> None:
    world = ExploreWorld()
    world.takes = 1000.0
    world.bus.run(3.0)
    assert len(world.goals) == 1
    world.stopped.send(True)
    assert "emergency stop" in world.run_until("paused", 3.0).reason
    world.bus.run(20.0)
    assert len(world.goals) == 1
    world.stopped.send(False)
    world.run_until("exploring", 20.0)
    world.bus.run(2.0)
    assert len(world.goals) == 2


def test_pauses_while_somebody_drives_and_waits_a_while_afterwards() -> None:
    world = ExploreWorld()
    world.takes = 1000.0
    world.bus.run(3.0)
    world.active.send("keyboard")
    assert "the keyboard drives" in world.run_until("paused", 3.0).reason
    world.active.send("idle")
    world.bus.run(2.0)
    assert world.statuses[-1].state == "paused"
    world.run_until("exploring", 10.0)


def test_change_that_does_not_fit_the_costmap_is_left_out_and_logged() -> None:
    world = ExploreWorld()
    world.costs.send(Map(world.bus.now, "map", draw(ROOM)))
    world.bus.run(1.0)
    world.changes.send(MapUpdate(world.bus.now, "map", 1000, 0, np.zeros((2, 2), np.int8)))
    world.bus.run(1.0)
    assert any("expected cells inside the grid" in text for _, text in world.explore.lines)
