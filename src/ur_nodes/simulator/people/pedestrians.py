"""People who walk, stop, stand together and block doors. They give way to robots that they see.

Deterministic: the same seed and the same robots give the same walks. They decide ten times a second and move between.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ur.worlds.world_file import WorldModel
from ur_nodes.geometry.hull import Hull
from ur_nodes.geometry.pose import Pose2
from ur_nodes.simulator.mujoco_model import PERSON_RADIUS
from ur_nodes.simulator.people.floor import WalkableFloor

Floats = NDArray[np.float64]

_PERIOD = 0.1  # s between two decisions
_SPEEDS = (0.6, 1.2)  # m/s
_SPACES = (0.4, 0.7)  # m that a person keeps from a robot
_PATIENCES = (1.5, 4.0)  # s until a person who is blocked turns round, or one who blocks a robot leaves
_STOPS = 25.0  # s between two stops on the way, in the mean
_STOPPED, _STANDING, _TOGETHER, _IN_DOOR = (1.0, 4.0), (2.0, 8.0), (8.0, 15.0), (4.0, 8.0)  # s
_TO_DOOR, _TO_OTHERS = 0.15, 0.3  # shares of the places that they go to
_BETWEEN = 0.65  # m between the middles of two people
_SEEN = 2.5  # m to a robot that matters
_WAITING = 1.0  # m to a robot at rest that seems to wait
_RESTING = 0.05  # m/s
_SIDESTEPS = (0.0, 0.5, -0.5, 1.0, -1.0)  # rad
_AHEAD = np.array((0.2, 0.4, 0.6, 0.9))  # s
_BESIDE = tuple(0.2 * n for n in range(1, 9))  # m that one steps aside who cannot leave
_NEARER, _CLOSE, _SLOW = 0.1, 0.15, 0.4  # m nearer to a robot then, m to it at all, m/s
_DIRECTIONS = 16  # in which they look for room then
_SOON = 0.4  # s: where they look for walls and for each other
_ARRIVED = 0.15  # m


@dataclass(frozen=True, slots=True, eq=False)
class NearbyRobot:
    """A robot near people: its outline, its pose in the map, and its velocity, m/s and rad/s."""

    hull: Hull
    pose: Pose2
    forward: float
    turn: float
    left: float = 0.0


@dataclass(slots=True)
class _Person:
    """One person: m, m/s, s, rad."""

    speed: float
    space: float
    patience: float
    heading: float = 0.0
    end: int = -1
    route: list[Floats] = field(default_factory=list)
    until: float = 0.0
    blocked: float = 0.0
    aside: bool = False


class Pedestrians:
    """The people of a world. Positions and velocities are in the map frame: m, m/s."""

    def __init__(self, world: WorldModel, seed: int, robots: Sequence[Pose2]) -> None:
        """`robots` is where robots begin. Raises UserError when the world has no floor for people."""
        self._random = np.random.default_rng((seed, world.people))
        self._floor = WalkableFloor(world, self._random)
        away = np.array([pose[:2] for pose in robots]).reshape(-1, 2)
        self.places = self._floor.draw(world.people, away, self._random)
        self.velocities = np.zeros_like(self.places)
        self._people = [
            _Person(speed=self._draw(_SPEEDS), space=self._draw(_SPACES), patience=self._draw(_PATIENCES))
            for _ in range(len(self.places))
        ]
        for person in self._people:
            person.heading, person.until = self._draw((-math.pi, math.pi)), self._draw((0.0, 3.0))
        self._next = 0.0

    @property
    def headings(self) -> list[float]:
        """The headings of the people, rad."""
        return [person.heading for person in self._people]

    def _draw(self, limits: tuple[float, float]) -> float:
        return float(self._random.uniform(*limits))

    def is_due(self, time: float) -> bool:
        """Return whether the people decide at a time (s)."""
        return time >= self._next - 1e-9

    def decide(self, time: float, robots: Sequence[NearbyRobot]) -> None:
        """Choose velocities until the next decision; robots are where they are now."""
        self._next = time + _PERIOD
        for number, person in enumerate(self._people):
            self._decide(number, person, time, robots)

    def advance(self, seconds: float) -> None:
        """Continue to walk for a time (s)."""
        self.places = self.places + self.velocities * seconds

    def _decide(self, number: int, person: _Person, time: float, robots: Sequence[NearbyRobot]) -> None:
        """Set the velocity of one person until the next decision."""
        here = self.places[number]
        near = [robot for robot in robots if math.dist(robot.pose[:2], here) < _SEEN]
        self.velocities[number] = 0.0
        if time < person.until:
            self._give_way(number, person, time, near)
            return
        while person.route and math.dist(person.route[0], here) < _ARRIVED:
            person.route.pop(0)
        if not person.route:
            self._arrive(number, person, time)
            return
        if self._random.random() < _PERIOD / _STOPS:
            person.until = time + self._draw(_STOPPED)
            return
        ahead = person.route[0] - here
        bearing = math.atan2(ahead[1], ahead[0])
        for aside in _SIDESTEPS:
            angle = bearing + aside
            velocity = (_SLOW if person.aside else person.speed) * np.array((math.cos(angle), math.sin(angle)))
            if self._may_walk(number, person, velocity, near):
                person.heading, person.blocked = angle, 0.0
                self.velocities[number] = velocity
                return
        person.blocked += _PERIOD
        if person.blocked > person.patience:
            self._turn_round(number, person, near)

    def _may_walk(self, number: int, person: _Person, velocity: Floats, robots: Sequence[NearbyRobot]) -> bool:
        """Return whether a velocity leads to no wall, and not too near to another person."""
        here = self.places[number]
        (x, y), (vx, vy) = here.tolist(), velocity.tolist()
        fits = all(self._floor.fits(x + vx * seconds, y + vy * seconds) for seconds in (_PERIOD, _SOON))
        if not fits and self._floor.fits(x, y):  # one who stands beside the free floor may come back to it
            return False
        then = (x + vx * _SOON, y + vy * _SOON)
        for other, place in enumerate(self.places.tolist()):
            if other != number and math.dist(place, then) < min(_BETWEEN, math.dist(place, (x, y))):
                return False
        space = _CLOSE if person.aside else person.space
        return all(_keeps_space(here, velocity, space, robot) for robot in robots)

    def _give_way(self, number: int, person: _Person, time: float, robots: Sequence[NearbyRobot]) -> None:
        """Let a standing person leave after a robot has waited in front for a while."""
        here = self.places[number]
        resting = (robot for robot in robots if abs(robot.forward) < _RESTING and abs(robot.left) < _RESTING)
        waits = any(_gap(robot.hull, robot.pose, here) < _WAITING for robot in resting)
        person.blocked = person.blocked + _PERIOD if waits else 0.0
        if person.blocked > person.patience:
            person.until = time
            self._turn_round(number, person, robots)

    def _turn_round(self, number: int, person: _Person, robots: Sequence[NearbyRobot]) -> None:
        """Choose a destination whose route leads away from robots; without one, step aside."""
        here = self.places[number]
        person.blocked, person.route, person.aside = 0.0, [], False
        for end in self._random.permutation(self._floor.rooms).tolist():
            route = list(self._floor.route(here, end))[1:]
            if not route or math.dist(route[0], here) < _ARRIVED:
                continue
            step = (route[0] - here) / math.dist(route[0], here)
            if all(_keeps_space(here, person.speed * step, person.space, robot) for robot in robots):
                person.end, person.route = end, route
                return
        person.route = self._find_room_beside(number, robots)
        person.aside = bool(person.route)

    def _find_room_beside(self, number: int, robots: Sequence[NearbyRobot]) -> list[Floats]:
        """Return a route straight to the place nearby that is farthest from robots, none if it is here."""
        here, route = self.places[number], list[Floats]()
        now = min((_gap(robot.hull, robot.pose, here) for robot in robots), default=math.inf)
        farthest = now + _NEARER
        for angle in np.linspace(0.0, math.tau, _DIRECTIONS, endpoint=False).tolist():
            direction = np.array((math.cos(angle), math.sin(angle)))
            for distance in _BESIDE:
                place = here + distance * direction
                if not self._floor.fits(*place.tolist()):
                    break
                gap = min((_gap(robot.hull, robot.pose, place) for robot in robots), default=math.inf)
                if gap < now - _NEARER:
                    break
                if gap > farthest:
                    farthest, route = gap, [place]
        return route

    def _arrive(self, number: int, person: _Person, time: float) -> None:
        """Stand for a while at the destination, and choose the next."""
        here, arrived, person.aside = self.places[number], person.end, False
        draw = float(self._random.random())
        doors = len(self._floor.ends) - self._floor.rooms
        standing = [other.end for other in self._people if other is not person and other.until > time]
        if arrived >= self._floor.rooms:
            pause = _IN_DOOR
        elif arrived >= 0 and arrived in standing:
            pause = _TOGETHER
        else:
            pause = _STANDING if self._random.random() < 0.5 else (0.0, 0.0)
        person.until = time + self._draw(pause) if arrived >= 0 else time
        joined = [end for end in standing if 0 <= end < self._floor.rooms and end != arrived]
        if draw < _TO_DOOR and doors:
            person.end = self._floor.rooms + int(self._random.integers(doors))
        elif draw < _TO_DOOR + _TO_OTHERS and joined:
            person.end = joined[int(self._random.integers(len(joined)))]
        else:
            person.end = int(self._random.integers(self._floor.rooms))
        route = list(self._floor.route(here, person.end))[1:]
        if route:  # those who stand together do not stand in one place
            angle = self._draw((-math.pi, math.pi))
            beside = route[-1] + 0.4 * np.array((math.cos(angle), math.sin(angle)))
            route[-1] = beside if self._floor.is_free(beside[None])[0] else route[-1]
        person.route = route


def _keeps_space(here: Floats, velocity: Floats, space: float, robot: NearbyRobot) -> bool:
    """Return whether a walking person keeps away from a robot at constant velocity, or leaves its space."""
    now = _gap(robot.hull, robot.pose, here)
    for seconds in _AHEAD.tolist():
        turned = robot.pose.yaw + 0.5 * robot.turn * seconds
        c, s = math.cos(turned), math.sin(turned)
        pose = Pose2(
            robot.pose.x + robot.forward * seconds * c - robot.left * seconds * s,
            robot.pose.y + robot.forward * seconds * s + robot.left * seconds * c,
            robot.pose.yaw + robot.turn * seconds,
        )
        walked, stayed = _gap(robot.hull, pose, here + velocity * seconds), _gap(robot.hull, pose, here)
        if walked < space and walked < min(stayed, now) + 0.05 * seconds:
            return False
    return True


def _gap(hull: Hull, pose: Pose2, point: Floats) -> float:
    """Return the distance between a person and a robot, m."""
    c, s = math.cos(pose.yaw), math.sin(pose.yaw)
    dx, dy = point[0] - pose.x, point[1] - pose.y
    return float(hull.distances(np.array(((c * dx + s * dy, c * dy - s * dx),)))[0]) - PERSON_RADIUS
