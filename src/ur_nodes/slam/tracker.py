"""A mapper that detects when it is lost: carried elsewhere, or started at an unknown place of an existing map.

While it is lost, the map is unchanged, and a second mapper makes a separate small map. Each of its keyframes is looked
for on the whole map. Once they agree on one place, the small map becomes part of the large one.
"""

from collections.abc import Sequence

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.hypotheses import Hypotheses
from ur_nodes.slam.map_state import Edge, find_drives
from ur_nodes.slam.mapper import MapEstimate, MapperSettings, ScanMapper
from ur_nodes.slam.matching.scan import MapScan
from ur_nodes.slam.relocation import WholeMap

_DOUBTS = 5  # scans in a row that contradict the map
_MOST_APART = 500  # keyframes of the small map that are looked for
_UNKNOWN = np.diag(np.square((10.0, 10.0, 2.0)))  # the covariance of a pose that is not known


class MapTracker:
    """Builds a map from scans as `ScanMapper` does, and finds the robot on it again when it was carried elsewhere."""

    def __init__(self, settings: MapperSettings | None = None) -> None:
        self._settings = settings
        self._mapper = ScanMapper(settings, cautious=True)
        self._apart: ScanMapper | None = None  # its map begins with the first scan in doubt
        self._doubts = 0  # of the mapper in charge
        self._whole: WholeMap | None = None  # while lost
        self._on_map = False  # at the start on a map that was made before
        self._hypotheses = Hypotheses(on_map=False)
        self._searched = 0  # keyframes of the small map
        self._expected: Pose2 | None = None  # the place of the small map, unless the robot was carried
        self._count = 0  # of scans

    def use(self, settings: MapperSettings) -> None:
        """Use changed settings from the next scan on."""
        self._settings = settings
        for mapper in (self._mapper, self._apart):
            if mapper:
                mapper.settings = settings

    @property
    def keyframes(self) -> list[Pose2]:
        """The poses of all keyframes of the map; those of `scans`."""
        return self._mapper.keyframes

    @property
    def scans(self) -> list[MapScan]:
        """The scans of all keyframes of the map."""
        return self._mapper.scans

    @property
    def edges(self) -> Sequence[Edge]:
        """The edges of the pose graph."""
        return self._mapper.edges

    @property
    def loops(self) -> int:
        """The number of edges that join places seen again."""
        return self._mapper.loops

    @property
    def lost(self) -> bool:
        """Return whether the robot's place on the map is unknown."""
        return self._whole is not None

    def drives(self) -> list[int]:
        """The numbers of the keyframes with which a later drive begins."""
        return find_drives(self._mapper.edges, len(self._mapper.scans))

    def path(self) -> dict[int, Pose2]:
        """Return the present poses of scans, by their number; those without a place are left out."""
        return self._mapper.path()

    def candidates(self) -> list[Pose2]:
        """The places, at least two, that fit equally while the robot is lost; else none."""
        if self._apart is None or not self._searched:
            return []
        newest = self._apart.keyframes[self._searched - 1]
        return [each.pose.compose(newest) for each in self._hypotheses.rivals()]

    def restore(self, poses: Sequence[Pose2], edges: Sequence[Edge], scans: Sequence[MapScan]) -> None:
        """Start with an existing map, of at least one keyframe, at an unknown place."""
        self._mapper.restore(poses, edges, scans)
        self._on_map = True
        self._begin_search()

    def add_scan(self, scan: MapScan, odometry: Pose2 | None = None, heading: float | None = None) -> MapEstimate:
        """Take the next scan as `ScanMapper.add_scan` does. While `lost`, the estimate is not located."""
        self._count += 1
        if self.lost:
            return self._search(scan, odometry, heading)
        estimate = self._mapper.add_scan(scan, odometry, heading)
        if not estimate.contradicted:
            self._apart, self._doubts = None, 0
            return estimate
        if self._apart is None:
            self._expected = estimate.pose
        self._map_apart(scan, odometry, heading)
        self._doubts += not estimate.still
        if self._doubts < _DOUBTS:
            return estimate
        self._begin_search()
        return self._unknown()

    def _begin_search(self) -> None:
        self._doubts = 0
        self._whole = WholeMap(self._mapper.keyframes, self._mapper.scans)
        self._forget_hypotheses()

    def _map_apart(
        self, scan: MapScan, odometry: Pose2 | None, heading: float | None
    ) -> tuple[ScanMapper, MapEstimate]:
        """Add a scan to the small map, or start one with it."""
        self._apart = self._apart or ScanMapper(self._settings, first=self._count - 1)
        return self._apart, self._apart.add_scan(scan, odometry, heading)

    def _forget_hypotheses(self) -> None:
        self._hypotheses, self._searched = Hypotheses(on_map=self._on_map, expected=self._expected), 0

    def _search(self, scan: MapScan, odometry: Pose2 | None, heading: float | None) -> MapEstimate:
        assert self._whole is not None
        apart, estimate = self._map_apart(scan, odometry, heading)
        if not estimate.still:
            self._doubts = self._doubts + 1 if estimate.contradicted else 0
        if self._doubts >= _DOUBTS or self._searched >= _MOST_APART:  # carried elsewhere again
            self._apart, self._doubts = None, 0
            self._expected = self._expected.compose(estimate.pose) if self._expected else None
            self._map_apart(scan, odometry, heading)
            self._forget_hypotheses()
            return self._unknown()
        if self._searched == len(apart.scans):
            return self._unknown()
        number = self._searched
        self._searched += 1
        newest, whole = apart.scans[number], self._whole
        self._hypotheses.add(
            number, apart.keyframes[number], whole.find(newest), lambda guess: whole.check(newest, guess)
        )
        winner = self._hypotheses.winner()
        if winner is None:
            return self._unknown()
        found = self._mapper.join(apart, winner.pose, winner.links())
        self._apart, self._whole, self._on_map, self._expected = None, None, False, None
        self._forget_hypotheses()
        return found

    def _unknown(self) -> MapEstimate:
        return MapEstimate(self._mapper.keyframes[-1], _UNKNOWN, 0.0, located=False)
