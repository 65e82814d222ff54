"""Goals on a bus in one process: no ROS, no real time, the same drive to the last bit for a seed."""

import math
import time
from itertools import pairwise

from bench.navigation_parts.comfort import Comfort, judge_comfort
from bench.navigation_parts.driver import Drive
from bench.navigation_parts.geodesic import free_cells, length_of, shortest_path
from bench.navigation_parts.worlds import BenchWorld, Goal, passage_radius
from tests.ur_nodes.first_drive.drive import FirstDrive

from ur_nodes.costmap.footprint import footprint_of_outline
from ur_nodes.geometry.hull import hull_of_outline
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.ports.values import Poses

_LIMIT = 180.0  # s for a goal
_STEP = 0.1  # s between two looks at the robot
_REST = 0.4  # s in which a robot comes to rest


class MemoryDriver:
    """A robot of `base` (`BASE[:VARIANT]`) with mux, amcl and move_base in a world."""

    def __init__(self, world: BenchWorld, base: str, seed: int, people: int = 0) -> None:
        """`people` walk in the world."""
        name, _, variant = base.partition(":")
        self.drive = FirstDrive(world.source, base=name, variant=variant, seed=seed, people=people)
        self.used = 0.0  # s of processor, without the shortest ways
        self._collisions = self.drive.record("simulator/collisions", int)
        self._strikes = self.drive.record("simulator/people_struck", int)
        self._lost = self.drive.record("amcl/lost", str)
        self._people = self.drive.record("simulator/people", Poses)
        self._hull = hull_of_outline(self.drive.base.footprint)
        self._grid = world.grid
        footprint = footprint_of_outline(self.drive.base.footprint, world.grid.resolution)
        self._free = free_cells(world.grid, passage_radius(footprint))

    @property
    def collisions(self) -> int:
        """The contacts of the robot so far."""
        return self._collisions[-1] if self._collisions else 0

    @property
    def comfort(self) -> Comfort:
        """The comfort of people so far."""
        return judge_comfort(self._hull, self.drive.truths, self._people, self._strikes[-1] if self._strikes else 0)

    @property
    def lost(self) -> int:
        """The number of times that localisation reported the robot as lost."""
        return sum(bool(text) and not before for before, text in pairwise(["", *self._lost]))

    def go(self, goal: Goal, limit: float = _LIMIT) -> Drive:
        """Send a goal and let it end, at most after `limit` s."""
        drive, bus = self.drive, self.drive.bus
        start, target = drive.truth.pose, Pose2(goal[0], goal[1], math.radians(goal[2]))
        way = shortest_path(self._grid, self._free, (start.x, start.y), goal[:2])
        began, used, length, last, errors = bus.now, time.process_time(), 0.0, start, []
        id = drive.send_goal(*target)

        def ended() -> bool:
            return id in drive.states and drive.states[id].state not in ("pending", "active")

        while not ended() and (bus.now - began) * 1e-9 < limit:
            bus.run_until(ended, _STEP)
            here = drive.truth.pose
            length += math.dist(here[:2], last[:2])
            last = here
            if drive.estimates:
                errors.append(math.dist(drive.estimates[-1].pose[:2], here[:2]))
        seconds, state = (bus.now - began) * 1e-9, drive.states.get(id)
        bus.run(_REST)
        self.used += time.process_time() - used
        here = drive.truth.pose
        return Drive(
            reached=state is not None and state.state == "succeeded",
            text=state.text if state is not None and ended() else f"not there after {limit:.0f} s",
            shortest=length_of(way) if way is not None else math.nan,
            length=length,
            seconds=seconds,
            error=math.dist(here[:2], target[:2]),
            turn_error=math.degrees(abs(wrap_angle(here.yaw - target.yaw))),
            errors=tuple(errors),
        )
