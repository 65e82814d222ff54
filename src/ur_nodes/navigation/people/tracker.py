"""People in scans: clusters of points that the map does not explain, tracked from scan to scan.

A cluster as wide as a person counts as one while it moves and for a while after, and at first also while it stands
still: what has not moved for longer is furniture. Velocities come from an alpha-beta filter (Kalata, The tracking
index: a generalized parameter for alpha-beta and alpha-beta-gamma target trackers, 1984).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.navigation.people.tracked_people import NO_PEOPLE, TrackedPeople

Floats = NDArray[np.float64]

_RANGE = 6.0  # m to a person
_GAP = 0.25  # m between two neighbouring points of a person
_WIDTH = 0.8  # m, at most
_FEWEST = 3  # points
_RADIUS, _DEPTH = 0.2, 0.12  # m: of a person; from the middle of the points that are seen to that of the person
_GATE = 0.4  # m from where a track expects a cluster
_AGILITY, _NOISE = 1.5, 0.04  # m/s2 and m: how people accelerate, and how exactly clusters are seen
_MOVING = 0.3  # m/s: a track that is faster walks
_WALKED = 0.25  # m from where it was first seen
_LOST, _WALKER_LOST = 0.4, 1.0  # s without a cluster until a track ends
_FURNITURE, _WALKER_STILL = 30.0, 60.0  # s without motion after which a track is no person
_LONGEST = 1.0  # s between two scans


@dataclass(slots=True)
class _PersonTrack:
    place: Floats
    first: Floats
    seen: float
    moved: float
    radius: float
    velocity: Floats
    walks: bool = False

    def is_person(self, now: float) -> bool:
        return now - self.moved < (_WALKER_STILL if self.walks else _FURNITURE)


class PeopleTracker:
    """Tracks in the odometry frame. Times are in s."""

    def __init__(self) -> None:
        self._tracks: list[_PersonTrack] = []
        self._last = -math.inf

    def update(self, now: float, sensor: tuple[float, float], points: Floats, explained: NDArray[np.bool_]) -> None:
        """Update the tracks with the points (n, 2) of a scan in the order of its beams, `explained` (n) by the map."""
        seconds = now - self._last
        self._last = now
        if not 0.0 < seconds < _LONGEST:
            self._tracks = []
            seconds = 0.0
        clusters = _find_clusters(sensor, points, explained)
        for track in self._tracks:
            track.place = track.place + seconds * track.velocity
        pairs = sorted(
            (math.dist(track.place, place), number, other)
            for number, track in enumerate(self._tracks)
            for other, (place, _) in enumerate(clusters)
        )
        tracks, used = set[int](), set[int]()
        for distance, number, other in pairs:
            if distance < _GATE and number not in tracks and other not in used:
                tracks.add(number)
                used.add(other)
                self._correct(self._tracks[number], *clusters[other], now, seconds)
        still = np.zeros(2)
        self._tracks = [
            track for track in self._tracks if now - track.seen < (_WALKER_LOST if track.walks else _LOST)
        ] + [
            _PersonTrack(place, place, now, now, radius, still)
            for other, (place, radius) in enumerate(clusters)
            if other not in used
        ]

    def people(self, now: float) -> TrackedPeople:
        """Return the tracks that are people, predicted to a time of now or a little later."""
        found = [track for track in self._tracks if track.is_person(now)]
        if not found:
            return NO_PEOPLE
        velocities = np.array([track.velocity if track.walks else (0.0, 0.0) for track in found])
        places = np.array([track.place for track in found]) + min(max(now - self._last, 0.0), 0.3) * velocities
        return TrackedPeople(places, velocities, np.array([track.radius for track in found]))

    def are_walkers(self, points: Floats) -> NDArray[np.bool_]:
        """Mark the points (n, 2) of people who have walked and will move on."""
        places = [track.place for track in self._tracks if track.walks and track.is_person(self._last)]
        if not places:
            return np.zeros(len(points), bool)
        gaps = np.hypot(*np.moveaxis(points[:, None] - np.array(places), -1, 0))
        near: NDArray[np.bool_] = gaps.min(axis=1) < _RADIUS + 0.15
        return near

    def forget(self) -> None:
        """Forget all tracks."""
        self._tracks, self._last = [], -math.inf

    def _correct(self, track: _PersonTrack, point: Floats, radius: float, now: float, seconds: float) -> None:
        index = _AGILITY * seconds**2 / _NOISE
        root = (4.0 + index - math.sqrt(8.0 * index + index**2)) / 4.0
        alpha = 1.0 - root**2
        beta = 2.0 * (2.0 - alpha) - 4.0 * math.sqrt(1.0 - alpha)
        off = point - track.place
        track.place = track.place + alpha * off
        track.velocity = track.velocity + (beta / seconds) * off if seconds > 0.0 else track.velocity
        track.radius += 0.2 * (radius - track.radius)
        track.seen = now
        if math.hypot(*track.velocity) > _MOVING and math.dist(track.place, track.first) > _WALKED:
            track.walks, track.moved = True, now


def _find_clusters(
    sensor: tuple[float, float], points: Floats, explained: NDArray[np.bool_]
) -> list[tuple[Floats, float]]:
    """Return the centres of clusters as wide as a person, and their radii, m."""
    usable = ~explained & (np.hypot(*(points - sensor).T) < _RANGE)
    if not usable.any():
        return []
    steps = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    joined = usable & np.roll(usable, -1) & (steps < _GAP)
    begins = np.flatnonzero(usable & ~np.roll(joined, 1))
    found = []
    for begin in begins.tolist():
        length = 1
        while length < len(points) and joined[(begin + length - 1) % len(points)]:
            length += 1
        part = points[(begin + np.arange(length)) % len(points)]
        width = float(np.hypot(*(part.max(axis=0) - part.min(axis=0))))
        if length < _FEWEST or width > _WIDTH:
            continue
        middle = 0.5 * (part.max(axis=0) + part.min(axis=0))
        away = middle - sensor
        place = middle + _DEPTH * away / max(float(np.hypot(*away)), 1e-6)
        found.append((place, min(max(_RADIUS, 0.5 * width), 2.0 * _RADIUS)))
    return found
