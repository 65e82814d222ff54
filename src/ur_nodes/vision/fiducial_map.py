"""A map of fiducials, and its text file.

The file is that of fiducial_slam: a line per fiducial with its number, x, y, z (m), roll, pitch, yaw (degrees),
variance (m^2), how often it was seen, and the numbers of those seen together with it. What that format has no room for
follows in lines that begin with "#covariance": the number and the upper triangle, row by row, of the 6 x 6 matrix.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ur.source.diagnostic import user_error
from ur.source.file import SourceFile, Span
from ur.source.read import read_source
from ur.source.replace import replace_file
from ur_nodes.geometry.rigid import Floats, from_angles, to_angles

_UPPER = np.triu_indices(6)
_TURN_VARIANCE = math.radians(2.0) ** 2  # of a map without covariances


@dataclass(frozen=True, slots=True)
class MapEntry:
    """A fiducial: its pose (4, 4) in the map, and the covariance (6, 6) of a small motion in its own frame.

    First the rotation (rad), then the translation (m). `links` are the fiducials seen together with it.
    """

    id: int
    pose: Floats
    covariance: Floats
    observations: int = 1
    links: tuple[int, ...] = ()

    @property
    def variance(self) -> float:
        """Return the variance of the position along an axis, on average, m^2."""
        return float(np.trace(self.covariance[3:, 3:]) / 3.0)


def format_map(entries: Iterable[MapEntry]) -> str:
    """Return the text of a map file, sorted by number, so that equal maps have equal texts."""
    ordered = sorted(entries, key=lambda entry: entry.id)
    lines = []
    for entry in ordered:
        angles = [math.degrees(angle) for angle in to_angles(entry.pose)]
        numbers = " ".join(f"{value:.6f}" for value in (*entry.pose[:3, 3], *angles, entry.variance))
        links = "".join(f" {link}" for link in sorted(entry.links))
        lines.append(f"{entry.id} {numbers} {entry.observations}{links}")
    for entry in ordered:
        upper = " ".join(f"{value:.4e}" for value in entry.covariance[_UPPER])
        lines.append(f"#covariance {entry.id} {upper}")
    return "".join(f"{line}\n" for line in lines)


def write_map(path: str | Path, entries: Iterable[MapEntry]) -> None:
    """Write a map file, folders included; an interrupted write leaves the old file. Raises UserError."""
    target = Path(path)
    try:
        replace_file(target, format_map(entries), parents=True)
    except OSError as problem:
        reason = f"{target}: cannot be written: {problem.strerror}, expected a place for the map of fiducials"
        raise user_error(reason, rule="cannot-write") from None


def read_map(path: str | Path) -> tuple[MapEntry, ...]:
    """Read a map file of ours or of fiducial_slam. Raises UserError with file and line."""
    return parse_map(read_source(path, expected="a map of fiducials"))


def parse_map(file: SourceFile) -> tuple[MapEntry, ...]:
    """Parse the text of a map file. Raises UserError with file and line."""
    entries: dict[int, MapEntry] = {}
    covariances: dict[int, Floats] = {}
    offset = 0
    for line in file.text.splitlines(keepends=True):
        words = line.split()
        span = Span(file, offset, offset + len(line.rstrip()))
        offset += len(line)
        try:
            if words and words[0] == "#covariance":
                upper = [_number(word) for word in words[2:]]
                if len(upper) != len(_UPPER[0]):
                    raise ValueError(f"a covariance of {len(upper)} values, not of {len(_UPPER[0])}")
                matrix = np.zeros((6, 6))
                matrix[_UPPER] = upper
                made: Floats = matrix + matrix.T - np.diag(np.diag(matrix))
                covariances[_whole(words[1])] = made
            elif words and not words[0].startswith("#"):
                if len(words) < 9:
                    raise ValueError(f"{len(words)} values in a line")
                x, y, z, roll, pitch, yaw, variance = map(_number, words[1:8])
                angles = (math.radians(roll), math.radians(pitch), math.radians(yaw))
                covariance = np.diag([_TURN_VARIANCE] * 3 + [max(variance, 1e-6)] * 3)
                links = tuple(map(_whole, words[9:]))
                entry = MapEntry(_whole(words[0]), from_angles((x, y, z), angles), covariance, _whole(words[8]), links)
                if entry.id in entries:
                    raise ValueError(f"fiducial {entry.id} is given twice")
                entries[entry.id] = entry
        except (ValueError, IndexError) as problem:
            expected = "a number, x y z (m), roll pitch yaw (degrees), a variance, how often it was seen"
            raise user_error(f"{problem}, expected {expected}", span, rule="bad-map") from None
    return tuple(
        MapEntry(e.id, e.pose, covariances.get(e.id, e.covariance), e.observations, e.links) for e in entries.values()
    )


def _number(word: str) -> float:
    try:
        value = float(word)
    except ValueError:
        raise ValueError(f"{word!r} is not a number") from None
    if not math.isfinite(value):
        raise ValueError(f"{word} is not finite")
    return value


def _whole(word: str) -> int:
    try:
        return int(word)
    except ValueError:
        raise ValueError(f"{word!r} is not a whole number") from None
