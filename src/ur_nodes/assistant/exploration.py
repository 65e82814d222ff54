"""The exploration of an assistant: places to drive to, one after the other, until the map is complete."""

from collections.abc import Callable
from dataclasses import dataclass

from ur_nodes.exploration.explorer import Explorer
from ur_nodes.exploration.explorer_step import ExplorerInputs, ExplorerOutputs, GoalEnd
from ur_nodes.exploration.obstacles import Obstacles
from ur_nodes.exploration.settings import ExploreSettings, read_settings
from ur_nodes.exploration.status import ExploreStatus
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.node import Node

_OUTSIDE = "outside of the area of the grant"

Allows = Callable[[Pose2], bool]


@dataclass(frozen=True, slots=True)
class NextPlace:
    """`pose`: drive there from now on; None: go on, or `cancel` the goal."""

    pose: Pose2 | None = None
    cancel: bool = False


class AssistedExploration:
    """Chooses places as `explore` does. Sends nothing: who drives asks for the next place, and reports its end."""

    def __init__(self, node: Node, settings: ExploreSettings) -> None:
        self._node, self._settings = node, settings
        self._explorer = Explorer(settings.explorer)
        self._grid: Grid | None = None
        self._version, self._due, self._busy = 0, 0.0, False
        self._end: GoalEnd | None = None
        self._next = NextPlace()
        self.status = ExploreStatus()
        """The newest status."""
        self._obstacles = Obstacles(node, settings.costmap, settings.costmap_updates)

    def begin(self) -> None:
        """Go on with what a call before has begun; anew where that has ended."""
        self._end, self._next = None, NextPlace()
        if self.status.ended:
            self._explorer, self.status = Explorer(self._settings.explorer), ExploreStatus()

    def note_end(self, reached: bool, text: str) -> None:
        """Take the end of the goal at the last place."""
        self._end = GoalEnd(reached, text)

    def choose_place(self, robot: Pose2, grid: Grid | None, allows: Allows) -> NextPlace:
        """The next place, once. One that is not allowed counts as not reached."""
        now = self._node.steady()
        if grid is not self._grid:
            self._grid, self._version = grid, self._version + 1
        found, self._next = self._next, NextPlace()
        if found.pose is not None and not allows(found.pose):
            found, self._end = NextPlace(cancel=True), GoalEnd(reached=False, text=_OUTSIDE)
        if self._grid is not None and not self._busy and (now >= self._due or self._end is not None):
            self._due, self._busy = now + self._settings.period, True
            seen = ExplorerInputs(now, self._grid, self._version, robot, self._obstacles.points(), self._end)
            self._end = None
            self._node.work(lambda: self._explorer.step(seen), self._on_outputs)
        return found

    def _on_outputs(self, out: ExplorerOutputs) -> None:
        self._busy, self.status = False, out.status
        self._next = NextPlace(out.goal, out.cancel)


def make_exploration(node: Node) -> AssistedExploration:
    """An exploration with the parameters of `explore` and of navigation. Raises UserError, which names a parameter."""
    return AssistedExploration(node, read_settings(node.parameters))
