"""Failures of a robot on a bus: what happens, so that it can be recorded and replayed."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

import numpy as np
from tests.ur_nodes.first_drive.drive import STARTS, FirstDrive, read_launch_files
from tests.ur_nodes.lock_step.run import StepPlan
from tests.ur_nodes.lock_step.wire import DELAY, WireBus

from ur_nodes.client.navigation import Names, NavigationTopics
from ur_nodes.client.snapshot import GoalReport
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.one_process.host import NodeStart
from ur_nodes.ports.actions import Goal, GoalId
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import PoseEstimate, StampedPose

MODULES = {
    "/cmd_vel_mux": "ur_nodes.motion.cmd_vel_mux_node",
    "/amcl": "ur_nodes.localisation.amcl_node",
    "/move_base": "ur_nodes.navigation.move_base_node",
}


class Viewer:
    """Goals and localisation as a viewer shows them once navigation has reported, each once until it changes."""

    def __init__(self, node: Node) -> None:
        self._topics = NavigationTopics(node, Names())
        self.shown: list[tuple[GoalReport, str]] = []
        node.every(0.1, self._look)

    def _look(self) -> None:
        seen = self._topics.snapshot()
        if seen.goal.number and (not self.shown or self.shown[-1] != (seen.goal, seen.lost)):
            self.shown.append((seen.goal, seen.lost))


class FailingDrive(FirstDrive):
    """A drive on a bus that is recorded, with a viewer; topics of `silent` are lost."""

    bus_class: ClassVar[Callable[..., Bus]] = WireBus

    def __init__(self, seed: int = 0) -> None:
        self.silent: set[str] = set()
        super().__init__("office", seed=seed, delay=self._find_delay)
        self.viewer = Viewer(self.bus.node("viewer"))

    def _find_delay(self, topic: str) -> int | None:
        return None if topic in self.silent else DELAY

    @property
    def wire(self) -> WireBus:
        assert isinstance(self.bus, WireBus)
        return self.bus

    def start(self, name: str) -> None:
        """See FirstDrive."""
        self.wire.begin_recording()
        super().start(name)

    def wait(self, seconds: float) -> None:
        self.bus.run(seconds)


def _drive(drive: FailingDrive, x: float = 3.5, y: float = -1.65) -> str:
    id = drive.send_goal(x, y)
    drive.wait(4.0)
    return id


def goal_in_a_wall(drive: FailingDrive) -> None:
    drive.send_goal(-3.0, -3.0)


def goal_outside_the_map(drive: FailingDrive) -> None:
    drive.send_goal(500.0, 0.0)


def goal_in_an_unknown_frame(drive: FailingDrive) -> None:
    drive._goals.send(Goal("frame", StampedPose(drive.bus.now, "moon", Pose2(1.0, 0.0, 0.0))))


def goal_that_is_no_place(drive: FailingDrive) -> None:
    drive._goals.send(Goal("nan", StampedPose(drive.bus.now, "map", Pose2(math.nan, 0.0, 0.0))))


def blocked_way(drive: FailingDrive) -> None:
    _drive(drive)
    here = drive.truth.pose
    for number in range(1, 4):
        drive.place(here.x + 0.9, here.y + 0.45 * (number - 2), name=f"obstacle_{number}")


def box_around_the_robot(drive: FailingDrive) -> None:
    here = drive.truth.pose
    for number, (dx, dy) in enumerate(((0.6, 0.0), (0.0, 0.6), (0.0, -0.6)), 1):
        drive.place(here.x + dx, here.y + dy, name=f"obstacle_{number}")
    drive.send_goal(3.5, -1.65)


def emergency_stop(drive: FailingDrive) -> None:
    _drive(drive)
    drive.ask("cmd_vel_mux/stop", Trigger())


def stop_and_release(drive: FailingDrive) -> None:
    emergency_stop(drive)
    drive.wait(2.0)
    drive.ask("cmd_vel_mux/release", Trigger())


def cancelled_goal(drive: FailingDrive) -> None:
    _drive(drive)
    drive.client.publish("move_base/cancel", GoalId, Quality.EVERY).send(GoalId())


def replaced_goal(drive: FailingDrive) -> None:
    _drive(drive)
    drive.send_goal(0.0, 0.0)


def silent_lidar(drive: FailingDrive) -> None:
    _drive(drive)
    drive.silent.add("/scan")


def late_transforms(drive: FailingDrive) -> None:
    _drive(drive)
    drive.silent.add("/tf")
    drive.wait(3.0)
    drive.silent.clear()


def silent_odometry(drive: FailingDrive) -> None:
    _drive(drive)
    drive.silent |= {"/odom", "/tf"}


def kidnapped(drive: FailingDrive) -> None:
    _drive(drive)
    x, y = drive.free_places(0.5)[-1]
    drive.place(float(x), float(y), 2.0)


def wrong_first_pose(drive: FailingDrive) -> None:
    x, y = drive.free_places(0.5)[-1]
    poses = drive.client.publish("initialpose", PoseEstimate)
    poses.send(PoseEstimate(drive.bus.now, "map", Pose2(float(x), float(y), 1.0), np.diag((0.2, 0.2, 0.1))))
    drive.wait(1.0)
    drive.send_goal(1.0, 0.0)


def dead_mux(drive: FailingDrive) -> None:
    _drive(drive)
    drive.bus.nodes["/cmd_vel_mux"].end("killed")


def dead_localisation(drive: FailingDrive) -> None:
    _drive(drive)
    drive.bus.nodes["/amcl"].end("killed")


def restarted_localisation(drive: FailingDrive) -> None:
    _drive(drive)
    drive.start("/amcl")


def driven_by_hand(drive: FailingDrive) -> None:
    _drive(drive)
    drive.drive(-0.2, 0.5, 3.0, "key_vel")


def silent_challenges(drive: FailingDrive) -> None:
    _drive(drive)
    drive.silent.add("/cmd_vel_mux/challenge")


FAILURES: tuple[Callable[[FailingDrive], None], ...] = (
    goal_in_a_wall,
    goal_outside_the_map,
    goal_in_an_unknown_frame,
    goal_that_is_no_place,
    blocked_way,
    box_around_the_robot,
    emergency_stop,
    stop_and_release,
    cancelled_goal,
    replaced_goal,
    silent_lidar,
    late_transforms,
    silent_odometry,
    kidnapped,
    wrong_first_pose,
    dead_mux,
    dead_localisation,
    restarted_localisation,
    driven_by_hand,
    silent_challenges,
)


def record(failure: Callable[[FailingDrive], None], folder: Path, seconds: float = 12.0) -> tuple[FailingDrive, Path]:
    """Let a failure happen, and what follows; the drive, and its recording."""
    drive = FailingDrive()
    failure(drive)
    drive.wait(seconds)
    return drive, drive.wire.write(folder, failure.__name__.replace("_", " "))


def plan_replay(recording: Path, *names: str) -> StepPlan:
    """The plan of a replay into some nodes."""
    plan = read_launch_files("office")
    remaps = {spec.full_name: dict(spec.remaps) for spec in plan.nodes}
    assert set(names) <= set(STARTS)
    return StepPlan(
        recording,
        tuple(NodeStart(name, (MODULES[name],), remaps[name]) for name in names),
        {each.name: each.value for each in plan.params if each.command is None},
    )
