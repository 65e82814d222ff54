"""A map of fiducials built while driving: a factor graph of robot poses, odometry and sightings (gtsam's iSAM2)."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import gtsam
import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.rigid import Floats, angle_between, from_planar, invert, to_planar
from ur_nodes.vision.estimation.graph import (
    GATE,
    deviation,
    fiducial_key,
    known_factor,
    level_factor,
    odometry_factor,
    odometry_sigmas,
    robot_from,
    robot_key,
    sighting_factor,
    start_factor,
)
from ur_nodes.vision.estimation.observation import CLEAR, Observation, Sighting, choose_sighting, misfit
from ur_nodes.vision.fiducial_map import MapEntry

_KEPT = 12  # views of a fiducial
_SAME = 0.15  # rad by which two guesses at one pose differ
_CERTAIN = 0.1  # rad: standard deviation of the turn, all views together, below which a pose counts as known


@dataclass(frozen=True, slots=True)
class FiducialView:
    """A fiducial seen at a moment of the graph by a robot at an estimated pose (4, 4)."""

    moment: int
    robot: Floats
    observation: Observation


class Unsettled:
    """Views of fiducials that wait for their pose to become clear."""

    def __init__(self) -> None:
        self._views: dict[int, list[FiducialView]] = {}

    def add(self, view: FiducialView) -> Floats | None:
        """Keep a view. Returns the pose (4, 4) in the map once it is unambiguous; then call `pop`."""
        views = self._views.setdefault(view.observation.id, [])
        views.append(view)
        del views[:-_KEPT]
        return settle(views)

    def pop(self, fiducial: int, pose: Floats) -> list[tuple[int, Sighting]]:
        """Remove and return the moments and sightings of a fiducial whose pose has become unambiguous."""
        chosen = [
            (view.moment, choose_sighting(view.observation, invert(view.robot) @ pose))
            for view in self._views.pop(fiducial)
        ]
        return [(moment, sighting) for moment, sighting in chosen if sighting]


def settle(views: list[FiducialView]) -> Floats | None:
    """Return the pose (4, 4) in the map on which all views agree much better than on any other; None without one."""
    turns = [np.linalg.eigvalsh(s.covariance[:3, :3])[-1] for view in views for s in view.observation.sightings[:1]]
    if sum(1.0 / turn for turn in turns) < 1.0 / _CERTAIN**2:
        return None
    guesses = [view.robot @ sighting.pose for view in views for sighting in view.observation.sightings]
    costs = []
    for guess in guesses:
        expected = [(view, invert(view.robot) @ guess) for view in views]
        costs.append(sum(min(misfit(each, pose) for each in view.observation.sightings) for view, pose in expected))
    best = min(range(len(guesses)), key=lambda index: costs[index])
    others = [cost for guess, cost in zip(guesses, costs, strict=True) if angle_between(guess, guesses[best]) > _SAME]
    return guesses[best] if all(cost - costs[best] > CLEAR for cost in others) else None


_STEP, _TURN = 0.15, 0.15  # m, rad: how far apart moments of the graph are where something is seen
_LONG_STEP, _LONG_TURN = 0.6, 0.8  # and where nothing is
_ORIGIN = Pose2(0.0, 0.0, 0.0)
_NEARBY, _NEARLY = 0.3, 0.35  # m, rad by which a known fiducial may seem displaced without further thought


class FiducialMapper:
    """Estimates the poses of robot and fiducials from odometry and observations. The same input gives the same map.

    A fiducial that is seen farther from its place in the map than all uncertainty explains (it was moved, or there are
    two of that number) is ignored, and stays in the map unchanged.
    """

    def __init__(self, known: Iterable[MapEntry] = (), *, start: Pose2 | None = _ORIGIN) -> None:
        """`start` is the first pose of the robot; None: estimated from the first `known` fiducial that is seen."""
        self._start = start
        self._isam = gtsam.ISAM2()
        self._graph = gtsam.NonlinearFactorGraph()
        self._poses: dict[int, Floats] = {}
        self._seen: dict[int, int] = {}
        self._links: dict[int, set[int]] = {}
        self._contradicting: set[int] = set()
        self._unsettled = Unsettled()
        self.moments = 0  # poses of the robot in the graph
        self._odometry: Pose2 | None = None
        self._robot = from_planar(start) if start else None
        self._known = {entry.id: entry for entry in known}
        self._pending: list[MapEntry] = list(self._known.values())

    @property
    def fiducials(self) -> dict[int, Floats]:
        """The poses (4, 4) of the fiducials in the map, as far as they are estimated now."""
        return {entry.id: entry.pose for entry in self._known.values()} | self._poses

    @property
    def contradicting(self) -> frozenset[int]:
        """Return the fiducials whose last sighting contradicted the map."""
        return frozenset(self._contradicting)

    @property
    def last(self) -> Pose2 | None:
        """The robot's pose in the map at the last moment; None while that is not known."""
        return None if self._robot is None else to_planar(self._robot)

    def robot(self, odometry: Pose2) -> Pose2 | None:
        """Return the robot's pose in the map for the present odometry; None while it is not known."""
        if self._robot is None:
            return None
        return to_planar(self._robot).compose(self._motion(odometry))

    def add(self, odometry: Pose2, observations: Iterable[Observation]) -> bool:
        """Add the observations of a moment, unless the last one is close; return whether the map changed."""
        seen = tuple(observations)
        if self.moments and not self._far(self._motion(odometry), bool(seen)):
            return False
        guess = self._guess(odometry, seen)
        if guess is None or not (seen or self.moments):
            return False
        factors, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for entry in self._pending:
            factors.push_back(known_factor(entry.id, entry.pose, entry.covariance))
            values.insert(fiducial_key(entry.id), gtsam.Pose3(entry.pose))
            self._poses[entry.id] = entry.pose
            self._seen[entry.id] = entry.observations
            self._links[entry.id] = set(entry.links)
        self._pending.clear()
        trusted = [each for each in seen if not self._contradicts(each, guess, odometry)]
        values.insert(robot_key(self.moments), gtsam.Pose3(guess))
        factors.push_back(level_factor(self.moments, guess))
        if self.moments:
            factors.push_back(odometry_factor(self.moments - 1, self.moments, self._motion(odometry)))
        elif self._start is not None:
            factors.push_back(start_factor(0, guess, 1e-3, 1e-3))
        self._add_sightings(factors, values, guess, trusted)
        self._isam.update(factors, values)
        self._isam.update()
        for index in range(factors.size()):
            self._graph.push_back(factors.at(index))
        self.moments += 1
        self._on_estimate(self._isam.calculateEstimate())
        self._odometry = odometry
        return True

    def refine(self) -> None:
        """Solve the whole graph again, without the approximations of the incremental solution."""
        if self.moments:
            values = gtsam.LevenbergMarquardtOptimizer(self._graph, self._isam.calculateEstimate()).optimize()
            self._on_estimate(values)

    def entries(self) -> tuple[MapEntry, ...]:
        """The map with covariances."""
        if not self.moments:
            return tuple(self._known.values())
        marginals = gtsam.Marginals(self._graph, self._isam.calculateEstimate())
        return tuple(
            MapEntry(
                number,
                pose,
                np.asarray(marginals.marginalCovariance(fiducial_key(number))),
                self._seen.get(number, 0),
                tuple(sorted(self._links.get(number, ()))),
            )
            for number, pose in sorted(self._poses.items())
        )

    def covariance(self) -> Floats:
        """Covariance (6, 6) of the robot's pose at the last moment: rotation, translation, in its own frame."""
        if not self.moments:
            return np.eye(6) * 1e-6
        return np.asarray(self._isam.marginalCovariance(robot_key(self.moments - 1)))

    def _motion(self, odometry: Pose2) -> Pose2:
        """Return the odometry since the last moment."""
        return self._odometry.inverse().compose(odometry) if self._odometry else Pose2(0.0, 0.0, 0.0)

    def _far(self, motion: Pose2, seeing: bool) -> bool:
        way, turn = math.hypot(motion.x, motion.y), abs(motion.yaw)
        return way > (_STEP if seeing else _LONG_STEP) or turn > (_TURN if seeing else _LONG_TURN)

    def _guess(self, odometry: Pose2, seen: tuple[Observation, ...]) -> Floats | None:
        if self.moments and self._robot is not None:
            return self._robot @ from_planar(self._motion(odometry))
        if self._start is not None:
            return from_planar(self._start)
        for observation in seen:
            if observation.id in self._known and observation.clear:
                return robot_from(self._known[observation.id].pose, observation.sightings[0])
        return None

    def _add_sightings(
        self, factors: gtsam.NonlinearFactorGraph, values: gtsam.Values, guess: Floats, seen: Iterable[Observation]
    ) -> None:
        used: list[tuple[int, int, Sighting]] = []
        for observation in (each for each in seen if each.sightings):
            number, known = observation.id, self._poses.get(observation.id)
            if known is not None:
                if sighting := choose_sighting(observation, invert(guess) @ known):
                    used.append((self.moments, number, sighting))
            elif (pose := self._unsettled.add(FiducialView(self.moments, guess, observation))) is not None:
                self._poses[number] = pose
                values.insert(fiducial_key(number), gtsam.Pose3(pose))
                used += [(moment, number, sighting) for moment, sighting in self._unsettled.pop(number, pose)]
        for moment, number, sighting in used:
            factors.push_back(sighting_factor(moment, number, sighting))
            self._seen[number] = self._seen.get(number, 0) + 1
            self._links.setdefault(number, set()).update(other for _, other, _ in used if other != number)

    def _contradicts(self, seen: Observation, guess: Floats, odometry: Pose2) -> bool:
        """Return True when a fiducial of the map is seen where it cannot be, with any drift of the robot."""
        number, known = seen.id, self._poses.get(seen.id)
        sighting = choose_sighting(seen, invert(guess) @ known) if known is not None else None
        self._contradicting.discard(number)
        if known is None or sighting is None or not self.moments:
            return False
        off = deviation(guess, known, sighting)
        if np.linalg.norm(off[3:]) < _NEARBY and np.linalg.norm(off[:3]) < _NEARLY:
            return False
        shift, turn = odometry_sigmas(self._motion(odometry))
        strayed = self.covariance() + np.diag(np.square([0.0, 0.0, turn, shift, shift, 0.0]))
        carry = gtsam.Pose3(invert(known) @ guess).AdjointMap()
        placed = np.asarray(self._isam.marginalCovariance(fiducial_key(number)))
        total = sighting.covariance + placed + carry @ strayed @ carry.T
        if float(off @ np.linalg.solve(total, off)) < GATE:
            return False
        self._contradicting.add(number)
        return True

    def _on_estimate(self, values: gtsam.Values) -> None:
        self._robot = np.asarray(values.atPose3(robot_key(self.moments - 1)).matrix())
        for number in self._poses:
            self._poses[number] = np.asarray(values.atPose3(fiducial_key(number)).matrix())
