"""Find the pose of a scan on the map around the robot: from a guess, or else by widening searches."""

import math

import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.matching.correlative import Window, search
from ur_nodes.slam.matching.local_map import LocalMap
from ur_nodes.slam.matching.match import ScanMatch, match_surface, rotate_covariance
from ur_nodes.slam.matching.surface import Floats, Surface

POOR = 0.6
"""Agreement below which a match is doubted."""

_SLIPPED = 2.5  # standard deviations of the guess: by the scan, the wheels slip
_MOST_DOUBTED = 4.0  # likewise, of a match of poor agreement: among people, a scan fits a little everywhere
_SEARCHED = 3.0  # standard deviations of the guess that a search covers,
_LEAST_WINDOW = Window(0.2, 0.1)  # and at least this
_POINTS = 150  # of a scan, in a search
_LEAST_POINTS = 20  # of a scan that is searched for
_LEAD = 0.05  # agreement by which a pose away from the guess must be better than one near it that agrees
_PRIOR_OF_SEARCH = 4.0  # times the covariance of the guess, which has failed


def locate_surface(
    local: LocalMap, surface: Surface, guess: Pose2, prior: Floats, before: Pose2, spread: Floats
) -> ScanMatch:
    """Match the surface of a scan to the map around the robot.

    `guess` is its pose by odometry, `prior` (3, 3) the covariance of that in the map's frame. Where the scan disagrees
    with it, the scan is also matched from `before`, the pose at the last scan, with the covariance `spread` (3, 3);
    where little agrees after that, it is searched for round the guess.
    """
    match = match_surface(local, surface, guess, prior)
    if _deviations(guess, match.pose, prior) > _SLIPPED or match.agreement < POOR:
        other = match_surface(local, surface, before, spread)
        lead = _LEAD if match.agreement >= POOR else 0.0  # along a corridor many places agree alike
        if _is_believed(other, guess, prior) and other.agreement > match.agreement + lead:
            match = other
    if match.agreement >= POOR or len(surface) < _LEAST_POINTS:
        return match
    shift, turn = _SEARCHED * math.sqrt(prior[0, 0] + prior[1, 1]), _SEARCHED * math.sqrt(prior[2, 2])
    window = Window(max(_LEAST_WINDOW.shift, shift), max(_LEAST_WINDOW.turn, turn))
    found = search(local.pyramid, surface.sample(_POINTS), guess, window)
    if found is None:
        return match
    other = match_surface(local, surface, found.pose, _PRIOR_OF_SEARCH * prior)
    return other if _is_believed(other, guess, prior) and other.agreement > match.agreement else match


def _is_believed(match: ScanMatch, guess: Pose2, prior: Floats) -> bool:
    """Return whether a match agrees well, or is near the guess: a scan fits partly in many places."""
    return match.agreement >= POOR or _deviations(guess, match.pose, prior) < _MOST_DOUBTED


def _deviations(guess: Pose2, found: Pose2, covariance: Floats) -> float:
    """The distance of a pose from a guess in standard deviations (Mahalanobis) of the guess, in the map's frame."""
    moved = np.array(guess.inverse().compose(found))
    return math.sqrt(float(moved @ np.linalg.solve(rotate_covariance(covariance, guess.yaw), moved)))
