"""The transform tree as nodes see it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Protocol

from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.geometry.transform_tree import TransformError, TransformTree
from ur_nodes.ports.values import Transform

_SECOND = 1_000_000_000


def seconds_of(stamp: int) -> float:
    """A stamp (ns) in s, rounded as all of ROS rounds it: transforms and scans of one moment stay of one moment."""
    return float(stamp // _SECOND) + float(stamp % _SECOND) / 1e9


class TransformLink(Protocol):
    """A backend's way of sending transforms."""

    def __call__(self, transforms: tuple[Transform, ...]) -> None:
        """Send them together."""


class Transforms(TransformTree):
    """Listens to the transforms of all nodes, and sends this node's own."""

    def __init__(self, link: TransformLink, keep: float = 10.0) -> None:
        """`keep` is the length of the history in s."""
        super().__init__(keep)
        self._link = link
        self._ignored: frozenset[str] = frozenset()
        self._watchers: list[Callable[[], None]] = []

    def ignore(self, children: Iterable[str]) -> None:
        """Do not take frames in, such as those that this node itself sends."""
        self._ignored |= {child.lstrip("/") for child in children}

    def watch(self, call: Callable[[], None]) -> None:
        """Call after each change."""
        self._watchers.append(call)

    def send(self, *transforms: Transform) -> None:
        """Send transforms of this node, together."""
        self._link(transforms)

    def take(self, transforms: Iterable[Transform]) -> None:
        """Take what another node has sent."""
        used = [each for each in transforms if each.child.lstrip("/") not in self._ignored]
        for each in used:
            self.add(each.parent, each.child, seconds_of(each.stamp), each.pose, fixed=each.fixed)
        if used:
            for call in self._watchers:
                call()

    def find(self, target: str, source: str, stamp: int = 0) -> Pose3 | None:
        """The pose of frame `source` in `target` at a time in ns (0: the newest), None while it is not known."""
        try:
            return self.lookup(target, source, seconds_of(stamp) if stamp else None)
        except TransformError:
            return None

    def find_planar(self, target: str, source: str, stamp: int = 0) -> Pose2 | None:
        """As `find`, in the plane."""
        found = self.find(target, source, stamp)
        return found.planar() if found else None
