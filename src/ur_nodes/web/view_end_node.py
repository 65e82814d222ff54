"""The state of the robot as frames for pages, each sent when it has changed."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Collection
from contextlib import suppress
from typing import Any

import numpy as np
import rospy
from numpy.typing import NDArray
from sensor_msgs.msg import BatteryState
from std_msgs.msg import Float32

from ur.source.printable import printable
from ur.web.wire.frames import (
    Kind,
    Layer,
    PoseSample,
    grid_frame,
    json_frame,
    points_frame,
    pose_frame,
    tile_frame,
)
from ur_nodes.client.model import GoalReport, Snapshot, distance_left
from ur_nodes.client.mux import MuxView
from ur_nodes.client.patrol_text import PatrolStatus, describe_patrol
from ur_nodes.geometry.grid import Grid
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.teleop.navigator.mux_link_node import MuxLink
from ur_nodes.teleop.navigator.navigation_topics_node import NavigationTopics
from ur_nodes.teleop.navigator.patrol_link_node import PatrolLink
from ur_nodes.web.drive_end_node import DriveEnd
from ur_nodes.web.exploration_topic_node import ExplorationTopic
from ur_nodes.web.layers.camera_node import CameraView
from ur_nodes.web.layers.layers_node import ExtraLayers
from ur_nodes.web.layers.overlays_node import Overlays
from ur_nodes.web.layers.plots_node import PlotFeed
from ur_nodes.web.layers.tiles import Tiles, cut_tiles
from ur_nodes.web.layers.topic_list_node import list_topics
from ur_nodes.web.map_link_node import MapLink
from ur_nodes.web.place_file_node import PlaceFile
from ur_nodes.web.places import Places
from ur_nodes.web.robot_facts_node import RobotFacts
from ur_nodes.web.zone_link_node import ZoneLink

_PERIOD = 1.0 / 15.0  # s between two poses
_SCAN_EVERY = 2  # poses to a scan
_IDLE_PERIOD = 0.5  # s, while nobody looks
_MOST_POINTS = 2000

Send = Callable[[bytes], None]


class ViewEnd:
    """Sends frames from a thread of its own, until shutdown. `send` may block; it raises OSError at the end."""

    def __init__(
        self,
        topics: NavigationTopics,
        mux: MuxLink,
        drive: DriveEnd,
        facts: RobotFacts,
        places: Places,
        zones: ZoneLink,
        patrol: PatrolLink,
        maps: MapLink,
        mux_name: str,
        send: Send,
    ) -> None:
        self._topics, self._mux, self._drive, self._facts, self._send = topics, mux, drive, facts, send
        self._places, self._place_file = places, PlaceFile(places)
        self._layers = ExtraLayers(topics.robot.place, send)
        self._zones, self._camera = zones, CameraView(self._send_picture, list_topics)
        self._overlays = Overlays(topics.robot.place, send, list_topics)
        self._plots = PlotFeed(send, list_topics)
        self._exploration, self._patrol = ExplorationTopic(), patrol
        self._maps = maps
        self._mux_name = mux_name
        self._sources: list[str] = []
        self._places_sent: dict[str, Any] = {}
        self._zones_sent: dict[str, Any] = {}
        self._viewers = 0
        self._tiles = Tiles()
        self._grid: Grid | None = None
        self._path: NDArray[np.float64] | None = None
        self._state: dict[str, Any] = {}
        self._battery: dict[str, Any] | None = None
        self._limit: int | None = None
        self._awake = threading.Event()
        rospy.Subscriber(f"{mux_name}/speed_limit_in_force", Float32, self._on_limit, queue_size=1)
        rospy.Subscriber("battery_state", BatteryState, self._on_battery, queue_size=1)
        threading.Thread(target=self._run, name="view", daemon=True).start()

    def look(self, viewers: int, layers: Collection[int], plots: Collection[str], camera: str) -> None:
        """Note how many pages look, and at what: without any, only what changes rarely is sent.

        `camera` is the topic of the chosen camera; "" for none.
        """
        self._viewers = viewers
        self._layers.want(layers)
        self._overlays.want(layers, watched=viewers > 0)
        self._plots.want(plots, shown=Layer.PLOTS in layers)
        self._camera.want(camera, wanted=Layer.CAMERA in layers)
        self._awake.set()

    def _send_picture(self, frame: bytes) -> None:
        with suppress(OSError):  # the end: the thread of poses reports it
            self._send(frame)

    @quiet_at_end
    def _run(self) -> None:
        count = 0
        due = time.monotonic()
        try:
            while not rospy.is_shutdown():
                self._step(count)
                count += 1
                due = max(due + _PERIOD, time.monotonic())
                if self._viewers:
                    time.sleep(max(0.0, due - time.monotonic()))
                else:
                    self._awake.clear()
                    self._awake.wait(_IDLE_PERIOD)
        except OSError:
            rospy.signal_shutdown("the server is gone")

    def _step(self, count: int) -> None:
        now = time.monotonic()
        seen = self._topics.snapshot(now)
        self._send_pose(seen, now)
        if seen.grid is not self._grid:
            self._grid = seen.grid
            self._place_file.show(seen.grid)
            self._send_map(seen.grid)
        if seen.path is not self._path:
            self._path = seen.path
            self._send(points_frame(Layer.PLAN, [] if seen.path is None else _thin(seen.path).tolist()))
        self._layers.step(now)
        self._overlays.step(now)
        self._plots.step(now)
        self._camera.step(now)
        if count % _SCAN_EVERY == 0:
            if self._viewers:
                self._send(points_frame(Layer.SCAN, [] if seen.scan is None else _thin(seen.scan).tolist()))
            state = self._describe(seen)
            if state != self._state:
                self._state = state
                self._send(json_frame(Kind.STATE, state))
            places = self._places.describe()
            if places != self._places_sent:
                self._places_sent = places
                self._send(json_frame(Kind.PLACES, places))
            zones = self._zones.describe()
            if zones != self._zones_sent:
                self._zones_sent = zones
                self._send(json_frame(Kind.ZONES, zones))

    def _send_pose(self, seen: Snapshot, now: float) -> None:
        x, y, yaw = seen.pose or (math.nan, math.nan, math.nan)
        age = math.inf if seen.pose is None else self._topics.robot.age(now)
        self._send(pose_frame(PoseSample(x, y, yaw, seen.speed, seen.turn, age, self._drive.link_age())))

    def _send_map(self, grid: Grid | None) -> None:
        if grid is None:
            return
        self._tiles, changed = cut_tiles(self._tiles, grid)
        frame = self._tiles.frame
        assert frame is not None, "made from a grid"
        self._send(grid_frame(Layer.MAP, frame))
        for column, row in changed:
            cells = self._tiles.tiles[column, row].tobytes()
            self._send(tile_frame(Layer.MAP, frame.generation, column, row, cells))

    def _describe(self, seen: Snapshot) -> dict[str, Any]:
        lease = self._drive.lease()
        left = distance_left(seen)
        return {
            "robot": self._facts.describe(),
            "missing": list(seen.missing),
            "goal": _goal(seen.goal, left),
            "mux": _mux(self._mux.view()),
            "lease": None
            if lease is None
            else {
                "state": lease.state,
                "client": lease.client,
                "name": lease.name,
                "program": lease.program,
                "since": lease.since,
                "until": lease.until,
                "asking": [{"client": each.client, "name": each.name} for each in lease.asking],
                "takenFrom": lease.taken_from.client if lease.taken_from else None,
            },
            "patrol": _patrol(self._patrol.status()),
            "exploring": self._exploration.describe(),
            "map": self._maps.describe(),
            "spread": None if seen.spread is None else round(seen.spread, 2),
            "battery": self._battery,
            "limit": self._limit,
            "bumpers": self._overlays.pressed(),
            "cameras": self._camera.describe(),
            "sources": self._sources,
        }

    @quiet_at_end
    def _on_limit(self, message: Any) -> None:
        self._limit = round(message.data) if 0.0 < message.data <= 100.0 else None
        if not self._sources:  # the mux has its parameters by now
            self._sources = list_sources(rospy.get_param(f"{self._mux_name}/topics", None))

    @quiet_at_end
    def _on_battery(self, message: Any) -> None:
        self._battery = {
            "share": round(message.percentage, 2) if 0.0 <= message.percentage <= 1.0 else None,
            "volts": round(message.voltage, 1) if math.isfinite(message.voltage) else None,
            "charging": message.power_supply_status == BatteryState.POWER_SUPPLY_STATUS_CHARGING,
        }


def list_sources(topics: object) -> list[str]:
    """The names of a mux's sources from its parameter `topics`, the most urgent first; none where it is malformed."""
    if not isinstance(topics, list) or not all(isinstance(each, dict) for each in topics):
        return []
    known = [(each.get("priority"), each.get("name")) for each in topics[:20]]
    good = [(urgency, name) for urgency, name in known if isinstance(urgency, int) and isinstance(name, str)]
    return [printable(name)[:40] for _, name in sorted(good, key=lambda each: -each[0])]


def _goal(goal: GoalReport, left: float | None) -> dict[str, Any]:
    place: list[float | None] | None = None if goal.place is None else [round(each, 3) for each in goal.place]
    if place is not None and goal.any_heading:
        place[2] = None
    rest = None if left is None or goal.over else round(left, 1)
    return {"number": goal.number, "place": place, "state": goal.state.name.lower(), "text": goal.text, "left": rest}


def _patrol(status: PatrolStatus | None) -> dict[str, Any] | None:
    """The patrol of the robot; None where no node drives one. `line` is empty before the first."""
    if status is None:
        return None
    return {
        "state": status.state,
        "line": describe_patrol(status),
        "stops": [[each.name, each.x, each.y] for each in status.route.stops],
        "index": status.index,
        "loop": status.route.loop,
    }


def _mux(view: MuxView) -> dict[str, Any]:
    return {
        "stopped": view.stopped,
        "active": printable(view.active)[:40],
        "asked": view.asked,
        "problem": printable(view.problem)[:300],
        "obstacles": {"state": view.obstacles.state, "text": view.obstacles.text},
    }


def _thin(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """At most `_MOST_POINTS` of the points, evenly; the last one stays."""
    if len(points) <= _MOST_POINTS:
        return points
    some: NDArray[np.float64] = points[np.linspace(0, len(points) - 1, _MOST_POINTS).astype(int)]
    return some
