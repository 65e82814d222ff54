"""The transform tree as nodes see it."""

from collections.abc import Callable, Iterable
from typing import Protocol

from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.geometry.transform_tree import TransformError, TransformTree
from ur_nodes.ports.log import Log
from ur_nodes.ports.validation import Refusals, problem_of
from ur_nodes.ports.values import Transform

_SECOND = 1_000_000_000


def seconds_of(stamp: int) -> float:
    """Convert a stamp (ns) to s, rounded as ROS does, so that transforms and scans of one moment keep equal times."""
    return float(stamp // _SECOND) + float(stamp % _SECOND) / 1e9


class TransformLink(Protocol):
    """A backend's publisher of transforms."""

    def __call__(self, transforms: tuple[Transform, ...]) -> None:
        """Send transforms in one message."""


class Transforms(TransformTree):
    """Receives the transforms of all nodes, and sends this node's own."""

    def __init__(self, link: TransformLink, log: Log, keep: float = 10.0) -> None:
        """`keep` is the length of the history in s."""
        super().__init__(keep)
        self._link = link
        self._refusals = Refusals("tf", log.error)
        self._ignored: frozenset[str] = frozenset()
        self._watchers: list[Callable[[], None]] = []

    def ignore(self, children: Iterable[str]) -> None:
        """Ignore transforms of these frames, for example those that this node sends itself."""
        self._ignored |= {child.lstrip("/") for child in children}

    def watch(self, call: Callable[[], None]) -> None:
        """Call after each change."""
        self._watchers.append(call)

    def send(self, *transforms: Transform) -> None:
        """Send transforms of this node in one message."""
        self._link(transforms)

    def receive(self, transforms: Iterable[Transform]) -> None:
        """Add transforms of another node."""
        used = [each for each in transforms if each.child.lstrip("/") not in self._ignored]
        for each in used:
            if problem := problem_of(each.pose):
                self._refusals.report(problem, each.child)
                continue
            self.add(each.parent, each.child, seconds_of(each.stamp), each.pose, fixed=each.fixed)
        if used:
            for call in self._watchers:
                call()

    def find(self, target: str, source: str, stamp: int = 0) -> Pose3 | None:
        """Return the pose of frame `source` in `target` at a time in ns (0: the newest); None while it is unknown."""
        try:
            return self.lookup(target, source, seconds_of(stamp) if stamp else None)
        except TransformError:
            return None

    def find_planar(self, target: str, source: str, stamp: int = 0) -> Pose2 | None:
        """Return the planar pose of frame `source` in `target`, as `find` does."""
        found = self.find(target, source, stamp)
        return found.planar() if found else None
