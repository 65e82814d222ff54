"""A robot with one sonar for tests, which stands still. A JSON request a line in, a JSON answer a line out."""

from __future__ import annotations

import math
import time
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import PolygonStamped, TransformStamped
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import Range
from tests.json_client import answer_requests, claim_output
from tf2_msgs.msg import TFMessage

_TURN = (math.sin(math.pi / 4), math.cos(math.pi / 4))  # the sonar looks to the left


class Client:
    """Publishes frames and ranges, and looks at the costmap."""

    def __init__(self) -> None:
        self.grid: OccupancyGrid | None = None
        self.outline: PolygonStamped | None = None
        self.tf = rospy.Publisher("/tf", TFMessage, queue_size=10)
        self.ranges = rospy.Publisher("sonars", Range, queue_size=10)
        rospy.Subscriber("local_costmap/costmap/costmap", OccupancyGrid, self._take_grid, queue_size=1)
        rospy.Subscriber("local_costmap/costmap/footprint", PolygonStamped, self._take_outline, queue_size=1)

    def do_echo(self, distance: float, obstacles: bool, seconds: float) -> dict[str, Any]:
        """Hear something at a distance (m) until the costmap has obstacles, or none; where they are, in m."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self._publish(distance)
            time.sleep(0.1)
            found = self._obstacles()
            if found is not None and self.outline is not None and bool(len(found)) == obstacles:
                return {
                    "frame": self.grid and self.grid.header.frame_id,
                    "at": found,
                    "corners": len(self.outline.polygon.points),
                }
        raise TimeoutError(f"obstacles expected: {obstacles}, found {found}")

    def _publish(self, distance: float) -> None:
        now = rospy.Time.now()
        base, sonar = TransformStamped(), TransformStamped()
        for transform, parent, child in ((base, "odom", "base_footprint"), (sonar, "base_footprint", "sonar_0")):
            transform.header.stamp, transform.header.frame_id, transform.child_frame_id = now, parent, child
            transform.transform.rotation.w = 1.0
        base.transform.translation.x = 3.0
        sonar.transform.rotation.z, sonar.transform.rotation.w = _TURN
        self.tf.publish(TFMessage([base, sonar]))
        message = Range(field_of_view=0.3, min_range=0.02, max_range=4.0, range=distance)
        message.header.stamp, message.header.frame_id = now, "sonar_0"
        self.ranges.publish(message)

    def _obstacles(self) -> list[tuple[float, float]] | None:
        grid = self.grid
        if grid is None:
            return None
        rows, columns = np.nonzero(np.array(grid.data).reshape(grid.info.height, grid.info.width) == 100)
        origin, size = grid.info.origin.position, grid.info.resolution
        return [
            (origin.x + (column + 0.5) * size, origin.y + (row + 0.5) * size)
            for row, column in zip(rows.tolist(), columns.tolist(), strict=True)
        ]

    def _take_grid(self, message: OccupancyGrid) -> None:
        self.grid = message

    def _take_outline(self, message: PolygonStamped) -> None:
        self.outline = message


def main() -> None:
    """Answer requests until standard input ends."""
    answers = claim_output()
    rospy.init_node("sonar_client", anonymous=True, disable_signals=True)
    answer_requests(answers, Client(), "do_")


if __name__ == "__main__":
    main()
