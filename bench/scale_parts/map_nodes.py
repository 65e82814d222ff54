"""map_server, amcl and move_base on a building of one size: `python -m bench.scale_parts.map_nodes SIDE` prints JSON.

A robot at rest beside them publishes odometry and scans. `plan`: seconds from the start of the three processes to the
path to a goal about 15 m away, `accepted`: to the goal's acceptance; the goal is sent again while there is no map. For
each node its resident memory in MB (10^6 bytes) 3 s after that, shared pages by share (`pss`) and whole (`rss`), its
largest since the start (`peak`), and its processor time (`cpu`).
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np

from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2

_ROOT = Path(__file__).resolve().parents[2]
_PACKAGE = _ROOT / "ubiquity_launches"
_RANGE, _BEAMS = 12.0, 360
_START, _PATIENCE = 120.0, 200.0  # s until move_base takes goals, and from the goal to its path


def main() -> int:
    """Start a master and the nodes, send one goal, print the figures; everything is ended."""
    from bench.master import start_master
    from bench.scale_parts.building import write_building

    side = int(sys.argv[1])
    with tempfile.TemporaryDirectory(prefix="bench_maps_") as folder:
        file = write_building(Path(folder), side)
        grid = load_map(str(file))
        start, goal = find_ends(grid, min(15.0, side * grid.resolution * 0.4))
        master = start_master(folder)
        nodes: dict[str, subprocess.Popen[bytes]] = {}
        try:
            print(json.dumps(_measure(grid, file, start, goal, nodes)), flush=True)
        finally:
            for process in [*nodes.values(), master]:
                process.terminate()
            for process in [*nodes.values(), master]:
                process.wait(20)
    return 0


def find_ends(grid: Grid, distance: float) -> tuple[Pose2, Pose2]:
    """Return a place in the middle of the floor and one about `distance` m from it, both with 0.6 m of room."""
    rng = np.random.default_rng(1)
    x, y = grid.points_of_cells(np.array((grid.height // 2, grid.width // 2))).tolist()
    start = next(place for place in _places(rng, x, y, 3.0) if _has_room(grid, place))
    for place in _places(rng, start[0], start[1], 1.1 * distance):
        if math.dist(place, start) >= 0.9 * distance and _has_room(grid, place):
            return Pose2(start[0], start[1], 0.3), Pose2(place[0], place[1], 0.0)
    raise AssertionError


def _places(rng: np.random.Generator, x: float, y: float, reach: float) -> Any:
    while True:
        yield (x + rng.uniform(-reach, reach), y + rng.uniform(-reach, reach))


def _has_room(grid: Grid, point: tuple[float, float]) -> bool:
    steps = np.arange(-0.6, 0.65, 0.05)
    around = np.stack(np.meshgrid(point[0] + steps, point[1] + steps), axis=-1)
    return bool((grid.values_at(around) == 0).all())


def _measure(
    grid: Grid, file: Path, start: Pose2, goal: Pose2, nodes: dict[str, subprocess.Popen[bytes]]
) -> dict[str, Any]:
    import actionlib
    import rospy
    from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
    from nav_msgs.msg import Path as PathMessage

    from ur_nodes.codecs.geometry import pose_message

    rospy.init_node("bench", disable_signals=True, log_level=rospy.FATAL)
    for name in ("amcl", "move_base"):
        subprocess.run(
            ["rosparam", "load", str(_PACKAGE / f"n_{name}" / "params" / "stage.yaml"), f"/{name}"], check=True
        )
    for axis, value in zip("xya", start, strict=True):
        rospy.set_param(f"/amcl/initial_pose_{axis}", float(value))
    rospy.set_param("/move_base/planner_patience", 300.0)
    rospy.set_param("/move_base/recovery_behavior_enabled", False)
    planned, accepted = threading.Event(), threading.Event()
    rospy.Subscriber("move_base/NavfnROS/plan", PathMessage, lambda _: planned.set())
    client = actionlib.ActionClient("move_base", MoveBaseAction)
    threading.Thread(target=_live, args=(grid, start), daemon=True).start()
    began = time.monotonic()
    for name, arguments in (("map_server", [str(file)]), ("amcl", []), ("move_base", [])):
        command = [str(_PACKAGE / f"n_{name}" / "bin" / name), *arguments, f"__name:={name}"]
        nodes[name] = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    request = MoveBaseGoal()
    request.target_pose.header.frame_id, request.target_pose.pose = "map", pose_message(goal)
    if not client.wait_for_server(rospy.Duration(_START)):  # a goal sent to a node without a connection is lost
        raise SystemExit(f"error: move_base took no goals within {_START:g} s, expected it to start")

    def follow(handle: Any) -> None:
        if handle.get_goal_status() == 1:
            accepted.set()

    result: dict[str, Any] = {}
    handle = client.send_goal(request, transition_cb=follow)
    sent = time.monotonic()
    while not planned.wait(0.005):
        if accepted.is_set():
            result.setdefault("accepted", time.monotonic() - began)
        if handle.get_comm_state() == actionlib.CommState.DONE:
            if "no map" in handle.get_goal_status_text() and time.monotonic() - sent < _PATIENCE:
                accepted.clear()  # the map took longer than a goal waits for it
                result.clear()
                handle = client.send_goal(request, transition_cb=follow)
                continue
            raise SystemExit(f"error: the goal ended without a path, expected one: {handle.get_goal_status_text()}")
        if time.monotonic() - sent > _PATIENCE:
            state = "the goal was accepted" if accepted.is_set() else "move_base did not answer the goal"
            raise SystemExit(f"error: no path within {_PATIENCE:g} s, expected one; {state}")
    result["plan"] = time.monotonic() - began
    result.setdefault("accepted", result["plan"])
    time.sleep(3.0)
    result |= {name: _memory(process.pid) for name, process in nodes.items()}
    rospy.signal_shutdown("done")
    return result


def _memory(pid: int) -> dict[str, float]:
    import psutil

    rollup = Path(f"/proc/{pid}/smaps_rollup").read_text(encoding="ascii").splitlines()
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii").splitlines()
    lines = {line.split(":")[0]: int(line.split()[1]) * 1024 / 1e6 for line in (*rollup[1:], *status) if " kB" in line}
    times = psutil.Process(pid).cpu_times()
    unseen = _unseen(pid)
    return {
        "pss": lines["Pss"] + unseen,
        "rss": lines["VmRSS"],
        "peak": lines["VmHWM"],
        "cpu": times.user + times.system,
    }


def _unseen(pid: int) -> float:
    """Memory (MB) of the process that no page table shows: pages of its memory files that it has not touched."""
    total, counts = 0.0, False
    for line in Path(f"/proc/{pid}/smaps").read_text(encoding="utf-8").splitlines():
        words = line.split()
        if not words[0].endswith(":"):
            counts = "/memfd:" in line and words[1].endswith("s")
        elif counts and words[0] in ("Size:", "Rss:"):
            total += int(words[1]) * (1024 if words[0] == "Size:" else -1024) / 1e6
    return total


def _live(grid: Grid, pose: Pose2) -> None:
    import rospy
    from geometry_msgs.msg import TransformStamped
    from sensor_msgs.msg import LaserScan
    from tf2_msgs.msg import TFMessage

    from ur_nodes.codecs.geometry import transform_message

    tf = rospy.Publisher("/tf", TFMessage, queue_size=10)
    scans = rospy.Publisher("scan", LaserScan, queue_size=1)
    angles = np.arange(_BEAMS) * math.tau / _BEAMS - math.pi
    steps = np.arange(0.1, _RANGE, 0.025)
    bearings = angles + pose.yaw
    points = np.stack((np.cos(bearings), np.sin(bearings)), axis=-1)[:, None] * steps[:, None] + (pose.x, pose.y)
    hit = grid.values_at(points) >= 65
    ranges = np.where(hit.any(axis=1), steps[hit.argmax(axis=1)], math.inf).tolist()
    rate = rospy.Rate(20)
    for tick in range(1 << 30):
        if rospy.is_shutdown():
            return
        now = rospy.Time.now()
        link = TransformStamped(child_frame_id="base_footprint", transform=transform_message(Pose2(0.0, 0.0, 0.0)))
        link.header.frame_id, link.header.stamp = "odom", now
        tf.publish(TFMessage([link]))
        if tick % 2 == 0:
            scan = LaserScan(angle_min=-math.pi, angle_increment=math.tau / _BEAMS, range_min=0.05, range_max=_RANGE)
            scan.header.frame_id, scan.header.stamp, scan.ranges = "base_footprint", now, ranges
            scans.publish(scan)
        rate.sleep()


if __name__ == "__main__":
    sys.exit(main())
