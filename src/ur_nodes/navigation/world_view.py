"""Sensor inputs of `move_base`: frames, the newest scan, the map, and the two costmaps made from them."""

import math
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.costmap import Costmap
from ur_nodes.costmap.layers import Beams, beams_of_scan, level_beams
from ur_nodes.costmap.map_costmap import MapCostmap
from ur_nodes.costmap.rolling_costmap import RollingCostmap
from ur_nodes.costmap.sonar import beams_of_range, without_walls
from ur_nodes.costmap.touched import TouchMarks
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.transform_tree import ExtrapolationError, TransformError
from ur_nodes.navigation.move_base_settings import MoveBaseSettings
from ur_nodes.navigation.people.tracked_people import NO_PEOPLE, TrackedPeople
from ur_nodes.navigation.people.tracker import PeopleTracker
from ur_nodes.navigation.planning.outline_plan import is_long
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.rollout import RolloutState
from ur_nodes.navigation.steering.speed_profile import DriveVelocity
from ur_nodes.ports.newest_work import NewestWork
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import ScanFeed
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import Map, Range, Scan


class ZoneMasks:
    """The newest masks in the map frame: `keep_out` is 100 in zones, `speed` a percentage; None before the first."""

    def __init__(self, node: Node, keep_out_topic: str, speed_topic: str, forbid: Callable[[], None]) -> None:
        """An empty topic means that there are no such zones.

        `forbid` is called when the keep-out zones have changed.
        """
        self.keep_out: Grid | None = None
        self.speed: Grid | None = None
        self._forbid = forbid
        if keep_out_topic:
            node.subscribe(keep_out_topic, Map, self._on_keep_out, Quality.LATCHED)
        if speed_topic:
            node.subscribe(speed_topic, Map, self._on_speed, Quality.LATCHED)

    def _on_keep_out(self, mask: Map) -> None:
        self.keep_out = mask.grid
        self._forbid()

    def _on_speed(self, mask: Map) -> None:
        self.speed = mask.grid


_WAITING = 100  # ranges that are not worked in yet
_PATIENCE = 0.2  # s for which a range waits for the odometry of its time
_BEHIND = 0.4  # cells behind the end of a ray in which a long robot marks: passages are as wide as they are
_ECHO = 1.2  # m: what sonars hear farther away is no obstacle beside a lidar
_SLACK = 0.02  # s by which the newest odometry may be older than a scan

LOCALISER_SILENCE = 3.0
"""How old (s) the newest transform from the odometry frame to the map may be."""


_NOTHING = Costmap(np.zeros((1, 1), np.uint8), 1.0, Pose2(0.0, 0.0, 0.0))

_MapRequest = tuple[Grid | MapCostmap, Grid | None]
"""A map, or the costmap of one whose slopes change, and its keep-out zones."""


class _Place(NamedTuple):
    """The robot's newest pose in the odometry frame, and its poses in odometry frame and map at the time of a scan."""

    newest: Pose2
    in_odom: Pose2
    in_map: Pose2 | None


class WorldView:
    """Subscribes and stores inputs; scans change the costmaps in `update`, which the control loop calls."""

    def __init__(
        self, node: Node, settings: MoveBaseSettings, see: Callable[[Pose2, NDArray[np.float64], Pose2], object]
    ) -> None:
        """`see` takes each scan: odometry, the ends of its beams (n, 2) in the robot's frame, the lidar's place."""
        self._node = node
        self._settings = settings
        self._see = see
        self._touched = TouchMarks()  # in the map
        self._looked_at = 0.0  # s: when their places were seen last
        self.frames = node.transforms
        self.local_costmap = RollingCostmap(
            settings.local_side,
            settings.local_resolution,
            settings.local.reach,
            settings.local.inflation,
            behind=_BEHIND * settings.local_resolution if is_long(settings.footprint) else 0.0,
        )
        self.global_costmap: MapCostmap | None = None
        self.map_problem = ""
        self.maps = 0  # used so far
        self._tracker = PeopleTracker()
        self._exact = is_long(settings.footprint)  # cells are too coarse for its outline in a door
        self._points = np.empty((0, 2))  # where the newest scan ends, in the odometry frame
        self._scan: Scan | None = None
        self._feed: ScanFeed | None = None
        self._used: int | None = None  # the stamp of the last scan that was worked in, ns
        self._laid = False
        self.zones = ZoneMasks(node, settings.keep_out_topic, settings.speed_topic, self._forbid)
        self._new_maps: NewestWork[_MapRequest, MapCostmap] = NewestWork(
            node, "maps", self._make_costmap, self._use_costmap
        )
        node.subscribe(settings.map_topic, Map, self._on_map, Quality.LATCHED, unreadable=self._refuse_map)
        self._ranges: deque[Range] = deque(maxlen=_WAITING)
        if settings.local.scan:
            frames, topic = (settings.local.frame, settings.base_frame), settings.local.scan.topic
            self._feed = ScanFeed(node, *frames, self._on_scan, topic=topic, reports=False)
        for topic in settings.local.sonars:
            node.subscribe(topic, Range, self._ranges.append, Quality.EVERY)

    def use(self, settings: MoveBaseSettings) -> None:
        """Use changed settings."""
        self._settings = settings
        self.local_costmap.inflation = settings.local.inflation
        self._inflate_again()

    def update(self) -> None:
        """Update the costmaps with the newest scan, or the ranges since the last update."""
        source, scan = self._settings.local.scan, self._scan
        if source is None:
            self._lay_map()
        for _ in range(len(self._ranges)):
            self._use_range(self._ranges.popleft())
        if source is None or scan is None or scan.stamp == self._used:
            return
        try:
            mount = self.frames.lookup(self._settings.base_frame, scan.frame)
            robot = self._place(seconds_of(scan.stamp))
        except ExtrapolationError as problem:
            if not problem.ahead:  # else the odometry of that moment is still on its way
                self._used = scan.stamp
            return
        except TransformError:
            return
        self._used = scan.stamp
        place = self.odom()
        if self._laid and self.global_costmap is not None and place is not None:
            self.local_costmap.overlay(robot.newest, self.global_costmap.zones or _NOTHING, place)
            self._laid = self.global_costmap.zones is not None
        sensor, beams = level_beams(mount, beams_of_scan(scan, inf_is_valid=source.inf_is_valid))
        points, placed = beams.points(), robot.in_odom.compose(sensor)
        ends = placed.transform_points(points)
        self._see(robot.in_odom, sensor.transform_points(points), sensor)
        if robot.in_map is not None:
            self._look(robot.in_map, sensor, beams, seconds_of(scan.stamp))
        self.local_costmap.update(robot.newest, placed, beams)
        self._points = ends[beams.ranges[beams.hits] <= source.reach.obstacle]
        if self.global_costmap is not None and robot.in_map is not None:
            mapped = robot.in_map.compose(sensor)
            explained = self.global_costmap.explains(mapped.transform_points(points))
            self._tracker.update(seconds_of(scan.stamp), placed[:2], ends, explained)
            lasting = beams.hits.copy()
            lasting[beams.hits] = ~self._tracker.are_walkers(ends)  # who walks will not stay there
            self.global_costmap.update(mapped, Beams(beams.angles, beams.ranges, lasting))

    @property
    def touched(self) -> bool:
        """Return whether there is something that the robot has touched."""
        return len(self._touched.points) > 0

    def touched_in_base(self) -> NDArray[np.float64]:
        """Return what the robot has touched, points (n, 2) in its frame."""
        robot = self.robot_in_map() if self.touched else None
        return robot.inverse().transform_points(self._touched.points) if robot is not None else np.empty((0, 2))

    def touch(self, points: NDArray[np.float64]) -> None:
        """Mark what the robot touches: points (n, 2) in its frame."""
        robot = self.robot_in_map()
        if robot is not None:
            self._touched.add(robot.transform_points(points))
            self._show_touched()

    def _look(self, robot: Pose2, sensor: Pose2, beams: Beams, stamp: float) -> None:
        seconds, self._looked_at = min(max(stamp - self._looked_at, 0.0), 0.5), stamp
        reach = self._settings.footprint.circumscribed
        if self._touched.look(robot, reach, robot.compose(sensor), beams, seconds):
            self._node.log.info("what was touched is forgotten where nothing is seen")
        self._show_touched()

    def _show_touched(self) -> None:
        odom, points = self.odom(), self._touched.points
        if odom is not None:
            self.local_costmap.touched = odom.transform_points(points)
        if self.global_costmap is not None:
            self.global_costmap.touch(points)

    def surroundings(self, now: float) -> LocalObstacles:
        """Return the obstacles and people around the robot at a time in s."""
        costmap, people = self.local_costmap.occupied(), self._tracker.people(now)
        around = LocalObstacles(costmap, people, scan=self._points)
        return around.exact() if self._exact else around

    def people_in_map(self, now: float) -> TrackedPeople:
        """The people around the robot in the map."""
        people, odom = self._tracker.people(now), self.odom()
        if odom is None or not len(people.points):
            return NO_PEOPLE
        back = odom.inverse()
        turned = Pose2(0.0, 0.0, back.yaw).transform_points(people.velocities)
        return TrackedPeople(back.transform_points(people.points), turned, people.radii)

    def motion(self, sent: DriveVelocity, now: float) -> RolloutState | None:
        """Extrapolate the robot's newest pose in the odometry frame to `now`, with the command that was sent."""
        try:
            pose = self.frames.pose(self._settings.local.frame, self._settings.base_frame)
            age = self.frames.age(self._settings.local.frame, self._settings.base_frame, now)
        except TransformError:
            return None
        ahead = min(max(age, 0.0), 0.1)
        return RolloutState(pose.compose(Pose2(sent.speed * ahead, sent.left * ahead, sent.turn * ahead)), *sent)

    def odom(self) -> Pose2 | None:
        """The map's pose in the odometry frame."""
        try:
            return self.frames.pose(self._settings.world.frame, self._settings.local.frame).inverse()
        except TransformError:
            return None

    def robot_in_odom(self) -> Pose2 | None:
        """The newest pose of the robot in the odometry frame."""
        try:
            return self.frames.pose(self._settings.local.frame, self._settings.base_frame)
        except TransformError:
            return None

    def robot_in_map(self) -> Pose2 | None:
        """The newest pose of the robot in the map."""
        try:
            return self.frames.pose(self._settings.world.frame, self._settings.base_frame)
        except TransformError:
            return None

    def trouble(self, now: float) -> str:
        """Return the reason why the robot must not move, an input that is missing or too old; '' when there is none."""
        settings = self._settings
        if self.global_costmap is None:
            return self.map_problem or f"no map on {self._node.resolve(settings.map_topic)}"
        if blind := self._blind(now):
            return blind
        try:
            old = self.frames.age(settings.local.frame, settings.base_frame, now)
            if old > settings.tolerance:
                return f"no odometry: {settings.base_frame} in {settings.local.frame} is {old:.1f} s old"
            old = self.frames.age(settings.world.frame, settings.local.frame, now)
            if old > LOCALISER_SILENCE:
                return f"not localised: {settings.local.frame} in {settings.world.frame} is {old:.1f} s old"
            if self._feed and self._feed.newest:
                self.frames.pose(settings.base_frame, self._feed.newest.frame)
        except TransformError as problem:
            return str(problem)
        return ""

    def _blind(self, now: float) -> str:
        """Return the reason why the scan cannot be used; '' also for a robot without one."""
        source = self._settings.local.scan
        if source is None or self._feed is None:
            return ""
        topic = self._node.resolve(source.topic)
        if self._feed.newest is None:
            return f"no scan on {topic}"
        silent = now - seconds_of(self._feed.newest.stamp)
        return f"no scan on {topic} for {silent:.1f} s" if silent > source.silence else ""

    def forget(self) -> None:
        """Clear all inputs after time was reset."""
        self.frames.forget()
        self._scan, self._used = None, None
        if self._feed:
            self._feed.newest = None
        self.clear_touched()
        self._ranges.clear()
        self.local_costmap.clear()
        self._tracker.forget()
        self._points = np.empty((0, 2))

    def clear_touched(self) -> None:
        """Forget what the robot has touched."""
        self._touched.clear()
        self._show_touched()

    def costmaps(self) -> tuple[Costmap, Costmap, Costmap | None] | None:
        """The costs of the whole map: with obstacles, which change with the next update, without, and zones alone."""
        layered = self.global_costmap
        return (layered.costmap, layered.static, layered.zones) if layered else None

    def _forbid(self) -> None:
        if self.global_costmap is not None:
            self.global_costmap.forbid(self.zones.keep_out)
            self._laid = self._laid or self.global_costmap.zones is not None

    def _lay_map(self) -> None:
        robot, place = self.robot_in_odom(), self.odom()
        if self.global_costmap is not None and robot is not None and place is not None:
            self.local_costmap.overlay(robot, self.global_costmap.static, place)

    def _use_range(self, sonar: Range) -> None:
        """Mark an echo as an obstacle, unless the map has a wall there."""
        beams = beams_of_range(sonar.range, sonar.field_of_view, sonar.range_min, sonar.range_max)
        if self.global_costmap is None or not len(beams.angles):
            return
        stamp = seconds_of(sonar.stamp)
        try:
            mount = self.frames.pose(self._settings.base_frame, sonar.frame)
            robot = self._place(stamp)
        except ExtrapolationError as problem:
            if problem.ahead and seconds_of(self._node.now()) - stamp < _PATIENCE:
                self._ranges.append(sonar)  # the odometry of that moment has not arrived yet
            return
        except TransformError:
            return
        if robot.in_map is None:
            return
        sensor = robot.in_map.compose(mount)
        if self._settings.local.scan is not None:
            self._use_echo(robot.in_map, mount, beams)
            return
        beams = without_walls(beams, sensor, self.global_costmap.walls)
        self.local_costmap.update(robot.newest, robot.in_odom.compose(mount), beams)
        self.global_costmap.update(sensor, beams)
        self._look(robot.in_map, mount, beams, stamp)

    def _use_echo(self, robot: Pose2, mount: Pose2, beams: Beams) -> None:
        """Mark the echo of what neither map nor scan have there, until the sonar sees the place free."""
        assert self.global_costmap is not None
        sensor, near = robot.compose(mount), Beams(beams.angles, beams.ranges, beams.hits & (beams.ranges < _ECHO))
        if self._touched.look(robot, 0.0, sensor, near, math.inf):
            self._show_touched()
        ends = without_walls(near, sensor, self.global_costmap.costmap).ends(sensor)
        if len(ends):
            self._touched.add(ends)
            self._show_touched()

    def _place(self, stamp: float) -> _Place:
        """Return where the robot was at a time. Raises TransformError when its odometry is not known at that time.

        A correction of the localiser is valid for a while, as it comes from an earlier scan.
        """
        settings = self._settings
        newest = self.frames.pose(settings.local.frame, settings.base_frame)
        in_odom = self.frames.pose(settings.local.frame, settings.base_frame, stamp, hold=_SLACK)
        try:
            odom = self.frames.pose(settings.world.frame, settings.local.frame, stamp, hold=LOCALISER_SILENCE)
        except TransformError:
            return _Place(newest, in_odom, None)
        return _Place(newest, in_odom, odom.compose(in_odom))

    def _on_map(self, value: Map) -> None:
        self._new_maps.ask((value.grid, self.zones.keep_out))

    def _refuse_map(self, reason: str) -> None:
        """Drop the map if its replacement cannot be read."""
        self._new_maps.drop()
        self.global_costmap, self.map_problem = None, reason

    def _make_costmap(self, request: _MapRequest) -> MapCostmap:
        """Work out the costs of a map and of keep-out zones: for a large one the control loop would miss periods."""
        given, keep_out = request
        settings = self._settings
        costmap = MapCostmap(
            given.grid() if isinstance(given, MapCostmap) else given,
            settings.world.reach,
            settings.world.inflation,
            lethal=settings.lethal,
            track_unknown=settings.track_unknown,
        )
        if keep_out is not None:
            costmap.forbid(keep_out)
        return costmap

    def _use_costmap(self, request: _MapRequest, costmap: MapCostmap) -> None:
        if isinstance(request[0], MapCostmap):
            costmap.mark_like(request[0])
        self.global_costmap = costmap
        self.maps += 1
        self._laid = self._laid or costmap.zones is not None
        if request[1] is not self.zones.keep_out:  # they changed in the meantime
            self._forbid()
        self._inflate_again()

    def _inflate_again(self) -> None:
        """Work the costs of the map out again if their slopes are not those of the settings."""
        costmap = self.global_costmap
        if costmap is not None and costmap.inflation != self._settings.world.inflation and not self._new_maps.busy:
            self._new_maps.ask((costmap, self.zones.keep_out))

    def _on_scan(self, scan: Scan, _odometry: Pose2 | None) -> None:
        self._scan = scan
