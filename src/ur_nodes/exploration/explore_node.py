"""The node `explore`: drives a robot over a map that grows until it is complete. Stands in for `explore_lite`."""

from __future__ import annotations

import sys
import threading
import time

import rospy
from nav_msgs.msg import OccupancyGrid
from rospy.numpy_msg import numpy_msg
from std_msgs.msg import String
from std_srvs.srv import Trigger
from visualization_msgs.msg import MarkerArray

from ur.maps.names import is_map_name
from ur.source.diagnostic import UserError
from ur_nodes.exploration.explorer import Explorer
from ur_nodes.exploration.explorer_step import Inputs, Outputs
from ur_nodes.exploration.markers_node import marker_array
from ur_nodes.exploration.navigation_node import Navigation
from ur_nodes.exploration.obstacles_node import Obstacles
from ur_nodes.exploration.settings_node import read_settings
from ur_nodes.exploration.status import Status, describe_status, write_status
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.frames import Frames
from ur_nodes.rosio.grid_message import grid_of_message
from ur_nodes.rosio.shell import run_node

_POLL = 0.1  # s between two looks at what has happened
_SHOWN_EVERY = 10.0  # s between two lines in the log
_SAVE_AGAIN = 5.0  # s of this computer until a map that is not stored is saved again
_MOST_SAVES = 4  # at the end


class ExploreNode:
    """Translates messages for an Explorer, in a thread of its own. Ends nothing: the last status stays published."""

    def __init__(self) -> None:
        self._settings = read_settings()
        self._explorer = Explorer(self._settings.explorer)
        self._frames = Frames()
        self._grid: Grid | None = None
        self._version = 0
        self._told = ("", -_SHOWN_EVERY)
        self._saved = ""
        self._save_at = 0.0
        self._status = rospy.Publisher("~status", String, queue_size=1, latch=True)
        self._markers = rospy.Publisher("~frontiers", MarkerArray, queue_size=1, latch=True)
        self._navigation = Navigation(self._settings)
        rospy.Subscriber("map", numpy_msg(OccupancyGrid), self._take_map, queue_size=1)
        self._obstacles = Obstacles(self._settings.costmap, self._settings.costmap_updates)
        threading.Thread(target=self._run, name="explore", daemon=True).start()

    def _run(self) -> None:
        due, version, paused = 0.0, -1, ""
        while not rospy.is_shutdown():
            time.sleep(_POLL)
            now = rospy.get_time()
            grid, robot = self._grid, self._pose()
            if missing := self._missing(grid, robot):
                self._publish(Status(reason=missing), now)
                continue
            assert grid is not None
            assert robot is not None
            if now < due - self._settings.period:  # time has begun anew
                due = now
            end, pause = self._navigation.take_end(), self._navigation.pause(now)
            if now < due and end is None and bool(pause) == bool(paused):
                continue
            paused, due = pause, now + self._settings.period
            version = self._version
            obstacles = self._obstacles.points()
            out = self._explorer.step(Inputs(now, grid, version, robot, obstacles, end, pause))
            if not self._obey(out, now):
                return

    def _obey(self, out: Outputs, now: float) -> bool:
        """Carry out what the explorer has decided; return whether it goes on."""
        if out.cancel:
            self._navigation.cancel()
        if out.clear:
            self._navigation.clear()
        if out.goal is not None:
            self._navigation.send(out.goal)
        floor = self._explorer.floor
        if floor is not None and self._markers.get_num_connections():
            self._markers.publish(marker_array(self._settings.map_frame, floor, out.frontiers, out.blocked))
        if not out.status.ended:
            if not self._saved and time.monotonic() >= self._save_at:
                self._save_at = time.monotonic() + _SAVE_AGAIN
                self._saved = self._save()
            self._publish(out.status.with_map(self._saved), now)
            return True
        self._publish(out.status.with_map(self._save_last()), now)
        return False

    def _save_last(self) -> str:
        """Save the map as it is at the end; return its name, '' where it cannot be saved."""
        for _ in range(_MOST_SAVES if self._settings.save_service else 0):
            if name := self._save():
                return name
            time.sleep(_SAVE_AGAIN)
        return ""

    def _save(self) -> str:
        """Save the map once; return its name, '' where it is not saved."""
        service = self._settings.save_service
        if not service:
            return ""
        try:
            rospy.wait_for_service(service, timeout=_SAVE_AGAIN)
            answer = rospy.ServiceProxy(service, Trigger)()
        except (rospy.ROSException, rospy.ServiceException) as problem:
            rospy.logwarn_throttle(_SHOWN_EVERY, f"{service}: the map is not saved: {problem}")
            return ""
        return answer.message if answer.success and is_map_name(answer.message) else ""

    def _missing(self, grid: Grid | None, robot: Pose2 | None) -> str:
        if grid is None:
            return f"no map on {rospy.resolve_name('map')}; is a mapping node running?"
        if robot is None:
            return f"no transform from {self._settings.base_frame} to {self._settings.map_frame}"
        return "" if self._navigation.ready() else f"no action {rospy.resolve_name(self._settings.navigation)}"

    def _publish(self, status: Status, now: float) -> None:
        line, (before, told_at) = describe_status(status), self._told
        kind = f"{status.state} {status.reason if status.state != 'paused' else ''}"
        if kind != before or not 0.0 <= now - told_at < _SHOWN_EVERY:
            self._told = (kind, now)
            rospy.loginfo("%s", line)
        self._status.publish(write_status(status))

    def _pose(self) -> Pose2 | None:
        found = self._frames.find(self._settings.map_frame, self._settings.base_frame, rospy.Time(0))
        return found.planar() if found else None

    def _take_map(self, message: OccupancyGrid) -> None:
        try:
            self._grid = grid_of_message(message)
        except UserError as problem:
            rospy.logerr_throttle(_SHOWN_EVERY, str(problem))
            return
        self._version += 1


def main() -> int:
    """Run the node until ROS ends it."""
    nodes: list[ExploreNode] = []
    return run_node("explore", lambda: nodes.append(ExploreNode()))


if __name__ == "__main__":
    sys.exit(main())
