"""The work of the node `amcl`: its map, its localiser, and its log lines."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.calibration import MotionCalibration
from ur_nodes.geometry.difference import describe_poses
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.motion_witness import MotionWitness
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount, points_of_scan
from ur_nodes.localisation.amcl_settings import AmclSettings
from ur_nodes.localisation.likelihood import make_field
from ur_nodes.localisation.localiser import LITTLE, ClusterEstimate, ParticleLocaliser
from ur_nodes.localisation.particle_filter import Particles
from ur_nodes.localisation.scan_match import RefinedPose
from ur_nodes.ports.log import Log
from ur_nodes.ports.values import Map, PoseEstimate, Result, Scan

_CERTAIN = 0.03  # m: of a place that a scan shows
_BLIND = 0.2  # m: a place whose standard deviation is larger is not shown
_DRIFT = 0.03  # of the way: wheels are rarely further off
_LEAST = 3.0  # m without a place, before which a pose is hardly off
_AT_A_PLACE = np.diag((0.1, 0.1, 0.03)) ** 2  # m^2, m^2, rad^2: of the pose where a blind way ends
_AFTER_SLIP = np.diag((0.1, 0.1, 0.1)) ** 2  # m^2, m^2, rad^2: of the pose after wheels have slipped


class BlindWay:
    """Adds up the way since scans last showed where along it the robot is, as in a long corridor without a door."""

    def __init__(self) -> None:
        self.axis: NDArray[np.float64] = np.array((1.0, 0.0))
        """The direction (2) in the map in which no place is shown."""
        self._length = 0.0
        self._last: Pose2 | None = None

    @property
    def spread(self) -> float:
        """The standard deviation (m) of the place along the axis, from the wheels; 0 where scans show it."""
        return _DRIFT * self._length if self._length > _LEAST else 0.0

    def update(self, odometry: Pose2, match: RefinedPose) -> None:
        """Take the odometry, and the match of a scan without it, which determines where the robot is if it can."""
        way = math.dist(self._last[:2], odometry[:2]) if self._last else 0.0
        self._last = odometry
        variances, axes = np.linalg.eigh(match.covariance[:2, :2])
        if match.agreement < LITTLE:
            self._length += way if self._length else 0.0
        elif variances[1] < _BLIND**2:
            self._length = 0.0
        else:
            self._length, self.axis = self._length + way, axes[:, 1]

    def widen(self, estimate: ClusterEstimate) -> ClusterEstimate:
        """Return an estimate with the uncertainty along the axis."""
        covariance = estimate.covariance.copy()
        covariance[:2, :2] += self.spread**2 * np.outer(self.axis, self.axis)
        return replace(estimate, covariance=covariance)

    def restart(self) -> None:
        """Begin anew: the place is known."""
        self._length, self._last = 0.0, None


class Amcl:
    """Localises on the map in use. `last` is the newest estimate, also that of an earlier map; None before the first.

    What wheels turn in vain, as scans show, is no motion: a robot that pushes something does not become lost.
    `correction` is the pose of the odometry's frame in the map. Both are kept while the robot is lost.
    """

    def __init__(self, settings: AmclSettings, log: Log) -> None:
        self._settings = settings
        self._log = log
        self._rng = np.random.default_rng(settings.seed)
        self._localiser: ParticleLocaliser | None = None
        self._grid: Grid | None = None
        self._places = 0  # that fit, as reported last
        self._lost = False  # likewise
        self._witness = MotionWitness()
        self._slip = Pose2(0.0, 0.0, 0.0)  # of odometry without what wheels turned in vain, from odometry
        self._shown: tuple[Pose2, Pose2] | None = None  # odometry and the pose by the scan alone, at the last update
        self.calibration = MotionCalibration()
        self._blind = BlindWay()
        self.last: ClusterEstimate | None = None
        self.correction: Pose2 | None = None

    @property
    def has_map(self) -> bool:
        """True if there is a map."""
        return self._localiser is not None

    @property
    def lost(self) -> str:
        """A description of the search for a lost robot; '' while the robot is localised."""
        if not self._localiser or not self._localiser.lost:
            return ""
        places = self._localiser.poses
        if not places:
            return "lost: the scan does not fit the map here; searching the whole map"
        where = " and ".join(f"({place.x:.1f}, {place.y:.1f})" for place in places)
        return f"lost: the scan fits alike at {where}; place the robot on the map by hand"

    @property
    def particles(self) -> Particles:
        """The particles after the last update; requires a map."""
        assert self._localiser
        return self._localiser.particles

    def use_map(self, given: Map) -> None:
        """Start on a map, which takes long for a large one. The pose on the last map is kept if there was one."""
        if given.frame != self._settings.map_frame:
            self._log.warn(f"map in frame {given.frame!r}, expected ~global_frame_id, {self._settings.map_frame!r}")
        self._localiser = localiser = ParticleLocaliser(
            make_field(given.grid, self._settings.beams), self._settings.filter, self._rng
        )
        self._grid = grid = given.grid
        if self.last:
            localiser.set_pose(self.last.pose, self.last.covariance)
        else:
            localiser.set_pose(self._settings.initial_pose, self._settings.initial_covariance)
        self._log.info(f"map of {grid.width} x {grid.height} cells of {grid.resolution:g} m")

    def use(self, settings: AmclSettings) -> None:
        """Use changed settings of the filter and limits of the laser from the next scan on."""
        self._settings = settings
        if self._localiser:
            self._localiser.settings = settings.filter

    def set_pose(self, given: PoseEstimate, moved: Pose2) -> None:
        """Set the pose of the robot; `moved` is its motion since."""
        if given.frame and given.frame != self._settings.map_frame:
            self._log.warn(f"initialpose in frame {given.frame!r} ignored, expected {self._settings.map_frame!r}")
            return
        pose = given.pose.compose(moved)
        if not self._localiser or not self._grid:
            self._log.warn("initialpose ignored, expected a map first")
        elif not self._grid.contains(self._grid.cells_of_points(np.array(pose[:2]))):
            self._log.warn(f"initialpose at x {pose.x:g} m, y {pose.y:g} m ignored, expected a place on the map")
        else:
            self._localiser.set_pose(pose, given.covariance)
            self._blind.restart()
            self._log.info(f"placed at x {pose.x:.2f} m, y {pose.y:.2f} m, yaw {pose.yaw:.2f} rad")

    def scatter(self) -> Result:
        """Start a global localisation."""
        if not self._localiser or not self._localiser.scatter():
            return Result(False, "there is no map with free cells yet, expected one")
        self._log.info("global localisation: the robot may be anywhere")
        return Result(success=True)

    def request_update(self) -> Result:
        """Use the next scan even when the robot has not moved."""
        if self._localiser:
            self._localiser.request_update()
        return Result(success=True)

    def update(self, scan: Scan, mount: SensorMount, odometry: Pose2) -> ClusterEstimate | None:
        """Use a scan taken at a pose of the odometry. Returns the estimate if there is a new one."""
        localiser = self._localiser
        assert localiser
        assert self._grid
        low, high = self._settings.laser_limits
        limits = (max(low, scan.range_min), min(high, scan.range_max) if high > 0.0 else scan.range_max)
        points = points_of_scan(scan, mount, limits)
        if slip := self._witness.update(odometry, points, (float(mount.offset[0]), float(mount.offset[1]))):
            back = odometry.compose(slip.inverse()).compose(odometry.inverse())
            self._slip, self._shown = self._slip.compose(back), None
            if self.correction and not localiser.lost:  # what stops it may turn it, too
                self.correction = self.correction.compose(back)
                localiser.set_pose(self.correction.compose(odometry), _AFTER_SLIP)
        estimate = localiser.update(self._slip.compose(odometry), points)
        if not estimate:
            return None
        if localiser.lost and not self._lost:
            self._log.warn("lost: was the robot carried? The scan does not fit the map here; searching the whole map")
        elif self._lost and not localiser.lost:
            pose = estimate.pose
            self._log.info(f"found: at x {pose.x:.2f} m, y {pose.y:.2f} m, yaw {pose.yaw:.2f} rad")
        self._lost = localiser.lost
        self._report_poses(localiser.poses, self._grid)
        if localiser.lost:
            return None
        match = localiser.match_alone(estimate.pose, points)
        self._calibrate(odometry, match)
        self._blind.update(odometry, match)
        if place := localiser.find_along(estimate.pose, self._blind.axis, 2.0 * self._blind.spread, points):
            self._log.info(f"a place after a way without one: {math.dist(place[:2], estimate.pose[:2]):.2f} m on")
            localiser.set_pose(place, _AT_A_PLACE)
            estimate, self._shown = replace(estimate, pose=place, covariance=_AT_A_PLACE), None
            self._blind.restart()
        estimate = self._blind.widen(estimate)
        self.last = estimate
        self.correction = estimate.pose.compose(odometry.inverse())
        return estimate

    def _calibrate(self, odometry: Pose2, match: RefinedPose) -> None:
        """Compare the motion since the last update as the wheels and the scans have it, where scans show it."""
        last, self._shown = self._shown, None
        if match.agreement >= LITTLE and match.covariance.diagonal()[:2].max() < _CERTAIN**2:
            self._shown = odometry, match.pose
        if last and self._shown:
            self.calibration.add(*(a.inverse().compose(b) for a, b in zip(last, self._shown, strict=True)))
        else:
            self.calibration.forget()

    def _report_poses(self, poses: list[Pose2], grid: Grid) -> None:
        """Log when more than one place fits, with what would distinguish the best two, and when only one is left."""
        if len(poses) == self._places:
            return
        if poses:
            self._log.warn(describe_poses(grid, poses, "place the robot by hand"))
        else:
            self._log.info("only one place on the map fits now")
        self._places = len(poses)
