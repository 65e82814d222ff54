"""The state of the robot as frames for pages, each sent when it has changed."""

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur.web.wire.frames import NOTHING_RUNS, Kind, Layer, PoseSample, json_frame, points_frame, pose_frame
from ur_nodes.client.exploration import ExplorationStatus
from ur_nodes.client.mux import MuxLink
from ur_nodes.client.navigation import NavigationTopics
from ur_nodes.client.patrol_text import PatrolLink
from ur_nodes.client.snapshot import RobotSnapshot, distance_left
from ur_nodes.geometry.grid import Grid
from ur_nodes.ports.graph import Graph
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery
from ur_nodes.web.driving.driver_link import DriverLink
from ur_nodes.web.layers.camera import CameraView
from ur_nodes.web.layers.extra_layers import ExtraLayers
from ur_nodes.web.layers.overlays import Overlays
from ur_nodes.web.layers.pacing import FrameOutlet, Frames, FrameSender
from ur_nodes.web.layers.plots import PlotFeed
from ur_nodes.web.layers.tiles import GridFrames
from ur_nodes.web.maps.map_link import MapLink
from ur_nodes.web.maps.map_server_link import ZoneLink
from ur_nodes.web.maps.place_file import PlaceFile
from ur_nodes.web.server_link import is_alone
from ur_nodes.web.view_state import (
    RobotFacts,
    describe_battery,
    describe_exploration,
    describe_goal,
    describe_lease,
    describe_mux,
    describe_patrol_state,
    list_sources,
)

_PERIOD = 1.0 / 15.0  # s between two poses
_SCAN_EVERY = 2  # poses to a scan
_IDLE_PERIOD = 0.5  # s, while no page is open
_ALONE = 2  # graphs in a row without a node of a robot, after which nothing runs
_MOST_POINTS = 2000


@dataclass(frozen=True, slots=True)
class ShownRobot:
    """The parts of a robot that pages show."""

    facts: RobotFacts
    topics: NavigationTopics
    mux: MuxLink
    driver: DriverLink
    patrol: PatrolLink
    exploration: ExplorationStatus
    places: PlaceFile
    zones: ZoneLink
    maps: MapLink


class ViewerSession:
    """Sends frames of the robot's state to pages; on the node's thread."""

    def __init__(self, node: Node, mux_name: str, shown: ShownRobot, outlet: FrameOutlet) -> None:
        self._node, self._mux_name, self._shown = node, mux_name, shown
        self._sender = FrameSender(node, outlet)
        self._frames: list[Frames] = []
        place = shown.topics.robot.pose_of
        self._layers = ExtraLayers(node, place, self._frames.append)
        self._camera = CameraView(node, outlet)
        self._overlays = Overlays(node, place, self._add)
        self._plots = PlotFeed(node, self._add, self._published)
        self._map = GridFrames(Layer.MAP)  # for what is called beside the node
        self._graph, shown.maps.on_graph = Graph(), self._on_graph
        self._alone, self._met = 0, False  # graphs without a node of a robot; whether there was one before
        self._sources: list[str] = []
        self._sent: dict[Kind, dict[str, object]] = {}
        self._viewers = self._count = 0
        self._grid: Grid | None = None
        self._path: NDArray[np.float64] | None = None
        self._battery: dict[str, object] | None = None
        self._limit: int | None = None
        node.subscribe(f"{mux_name}/speed_limit_in_force", float, self._on_limit, Quality.LATCHED)
        node.subscribe("battery_state", Battery, self._on_battery)
        self._due = node.steady()
        self._timer = node.after(0.0, self._beat, steady=True)

    def look(self, viewers: int, layers: Collection[int], plots: Collection[str], camera: str) -> None:
        """Note how many pages are open and what they show; without a page, only data that changes rarely is sent.

        `camera` is the topic of the chosen camera; "" for none.
        """
        woken, self._viewers = not self._viewers, viewers
        self._layers.want(layers)
        self._overlays.want(layers, watched=viewers > 0)
        self._plots.want(plots, shown=Layer.PLOTS in layers)
        self._camera.want(camera, wanted=Layer.CAMERA in layers)
        if woken:
            self._timer.cancel()
            self._due = self._node.steady()
            self._beat()

    def _beat(self) -> None:
        now = self._node.steady()
        if not self._sender.busy and self._alone < _ALONE:
            self._step(now)
        self._due = max(self._due + _PERIOD, now) if self._viewers else now + _IDLE_PERIOD
        self._timer = self._node.after(max(0.0, self._due - self._node.steady()), self._beat, steady=True)

    def _step(self, now: float) -> None:
        seen = self._shown.topics.snapshot()
        self._add_pose(seen)
        if seen.grid is not self._grid:
            self._grid = grid = seen.grid
            self._shown.places.show(grid)
            if grid is not None:
                self._frames.append(lambda: self._map.show(grid))
        if seen.path is not self._path:
            self._path = seen.path
            self._add(points_frame(Layer.PLAN, _thin(seen.path)))
        self._layers.step(now)
        self._overlays.step(now)
        self._plots.step(now)
        self._camera.step()
        self._count += 1
        if self._count % _SCAN_EVERY == 1:
            if self._viewers:
                robot = self._shown.topics.robot
                scan = seen.scan if seen.pose is not None else robot.scan(by_odometry=True)
                self._add(points_frame(Layer.SCAN, _thin(scan)))
            self._add_changed(Kind.STATE, self._describe(seen))
            self._add_changed(Kind.PLACES, self._shown.places.describe())
            self._add_changed(Kind.ZONES, self._shown.zones.describe())
        frames = self._frames.copy()
        self._frames.clear()
        self._sender.put(lambda: (frame for make in frames for frame in make()))

    def _add(self, frame: bytes) -> None:
        self._frames.append(lambda: (frame,))

    def _add_changed(self, kind: Kind, value: dict[str, object]) -> None:
        if value != self._sent.get(kind):
            self._sent[kind] = value
            self._add(json_frame(kind, value))

    def _add_pose(self, seen: RobotSnapshot) -> None:
        robot = self._shown.topics.robot
        pose = seen.pose or robot.odometry_pose()
        x, y, yaw = pose or (math.nan, math.nan, math.nan)
        age = math.inf if pose is None else robot.age()
        self._add(pose_frame(PoseSample(x, y, yaw, seen.speed, seen.turn, age, self._shown.driver.link_age())))

    def _describe(self, seen: RobotSnapshot) -> dict[str, object]:
        shown = self._shown
        return {
            "robot": shown.facts.describe(),
            "missing": list(seen.missing),
            "goal": describe_goal(seen.goal, distance_left(seen)),
            "mux": describe_mux(shown.mux.view()),
            "lease": describe_lease(shown.driver.lease),
            "patrol": describe_patrol_state(shown.patrol.status()),
            "exploring": describe_exploration(shown.exploration.shown()),
            "map": shown.maps.describe(),
            "spread": None if seen.spread is None else round(seen.spread, 2),
            "lost": seen.lost,
            "battery": self._battery,
            "limit": self._limit,
            "bumpers": self._overlays.pressed(),
            "cameras": self._camera.describe(),
            "sources": self._sources,
        }

    def _published(self) -> list[tuple[str, str]]:
        return self._graph.published()

    def _on_graph(self, graph: Graph) -> None:
        """Take what is published. Where nothing runs, report it and send no more; the next robot gets another node."""
        self._graph = graph
        self._overlays.update_topics(graph.published())
        self._camera.update_topics(graph.published())
        if is_alone(graph, self._node.name):
            self._alone += 1
            if self._alone == _ALONE:
                self._sent.clear()
                self._sender.put(lambda: (NOTHING_RUNS,))
        elif self._alone >= _ALONE and self._met:
            self._node.end("another robot has started")
        else:
            self._alone, self._met = 0, True

    def _on_limit(self, percent: float) -> None:
        self._limit = round(percent) if 0.0 < percent <= 100.0 else None
        if not self._sources:  # the mux has its parameters by now
            self._node.work(self._read_sources, self._on_sources)

    def _read_sources(self) -> list[str]:
        try:
            return list_sources(self._node.parameters.of(self._mux_name).any("topics"))
        except Exception:  # a parameter server that does not answer: they are asked for again
            return []

    def _on_sources(self, sources: list[str]) -> None:
        self._sources = sources

    def _on_battery(self, battery: Battery) -> None:
        self._battery = describe_battery(battery)


def _thin(points: NDArray[np.float64] | None) -> list[list[float]]:
    """Return at most `_MOST_POINTS` of the points, evenly chosen, always with the last one."""
    if points is None:
        return []
    if len(points) > _MOST_POINTS:
        points = points[np.linspace(0, len(points) - 1, _MOST_POINTS).astype(int)]
    found: list[list[float]] = points.tolist()
    return found
