"""The transform tree (tf) with the history of the last seconds."""

import math
from bisect import bisect_left, bisect_right

from ur_nodes.geometry.pose import Pose2, Pose3, interpolate, wrap_angle

JUMP = 1.0
"""A stamp older (s) than the newest of the same frame by more than this means that time was reset."""

_IDENTITY = Pose3(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)


class TransformError(Exception):
    """Two frames are not connected. The text completes a message to a user."""


class ExtrapolationError(TransformError):
    """A transform is not known at the time asked for. `ahead`: the time is newer than the newest that is known."""

    def __init__(self, text: str, *, ahead: bool) -> None:
        super().__init__(text)
        self.ahead = ahead


class TransformTree:
    """Poses of frames in their parents over time. Names may carry a leading slash.

    `keep` is the length of the history in s. One thread may add while others look up.
    """

    def __init__(self, keep: float = 10.0) -> None:
        self._keep = keep
        self._parents: dict[str, str] = {}
        self._stamps: dict[str, list[float]] = {}
        self._poses: dict[str, list[Pose3]] = {}
        self._fixed: set[str] = set()

    def add(self, parent: str, child: str, stamp: float, pose: Pose3, *, fixed: bool = False) -> None:
        """Add the pose of `child` in `parent` at a time (s). A stamp that jumps back starts the whole history again."""
        child = child.lstrip("/")
        stamps, poses = self._stamps.get(child, []), self._poses.get(child, [])
        if stamps and not fixed and stamp <= stamps[-1]:
            if stamps[-1] - stamp < JUMP:
                return
            self.forget()
            stamps, poses = [], []
        self._parents[child] = parent.lstrip("/")
        if fixed:
            self._fixed.add(child)
            stamps, poses = [], []
        # New lists instead of changed ones: a reader in another thread keeps a matching pair.
        drop = bisect_right(stamps, stamp - self._keep) if len(stamps) > 200 else 0
        if drop or not poses:
            self._poses[child] = [*poses[drop:], pose]
            self._stamps[child] = [*stamps[drop:], stamp]
        else:
            poses.append(pose)
            stamps.append(stamp)

    def forget(self) -> None:
        """Forget moving frames; fixed ones stay."""
        for child in list(self._stamps):
            if child not in self._fixed:
                self._stamps.pop(child, None)
                self._poses.pop(child, None)
                self._parents.pop(child, None)

    def frames(self) -> set[str]:
        """Return all known frames."""
        return {*self._parents, *self._parents.values()}

    def parent(self, child: str) -> str | None:
        """Return the name of the frame that a frame's poses are in, None when there is none."""
        return self._parents.get(child.lstrip("/"))

    def root(self, child: str) -> str:
        """Return the name of the frame above all others of a frame; itself when it has no parent."""
        return self._climb(child, None)[-1]

    def newest(self, child: str) -> float | None:
        """Return the newest stamp (s) of a frame in its parent, None when there is none."""
        stamps = self._stamps.get(child.lstrip("/"))
        return stamps[-1] if stamps else None

    def lookup(self, target: str, source: str, stamp: float | None = None, *, hold: float = 0.0) -> Pose3:
        """Return the pose of frame `source` in frame `target` at a time (s); without a time, the newest of each frame.

        Between two stamps it is interpolated. The newest pose of a frame counts for `hold` s more.
        Raises TransformError when the frames are not connected, ExtrapolationError when the time lies outside.
        """
        down = self._climb(target, None)
        up = self._climb(source, set(down))
        common = up[-1] if up else ""
        if common not in down:
            raise TransformError(f"no transform from {source.lstrip('/')} to {target.lstrip('/')}")
        there = self._chain_pose(up[:-1], stamp, hold)
        back = self._chain_pose(down[: down.index(common)], stamp, hold)
        return back.inverse().compose(there) if back is not _IDENTITY else there

    def pose(self, target: str, source: str, stamp: float | None = None, *, hold: float = 0.0) -> Pose2:
        """Return `lookup` as a planar pose."""
        return self.lookup(target, source, stamp, hold=hold).planar()

    def velocity(self, child: str, window: float) -> tuple[float, float, float]:
        """Return the mean planar velocity of a frame in its parent over the newest `window` s.

        Ahead and to the left (m/s) of its newest heading, and turning (rad/s); 0 while the history is shorter.
        """
        newest, parent = self.newest(child), self.parent(child)
        if newest is None or parent is None:
            return 0.0, 0.0, 0.0
        try:
            before, after = self.pose(parent, child, newest - window), self.pose(parent, child, newest)
        except TransformError:
            return 0.0, 0.0, 0.0
        x, y, c, s = after.x - before.x, after.y - before.y, math.cos(after.yaw), math.sin(after.yaw)
        return (c * x + s * y) / window, (c * y - s * x) / window, wrap_angle(after.yaw - before.yaw) / window

    def chain(self, target: str, source: str) -> tuple[str, ...]:
        """Return the frames from `source` up to below its ancestor `target`; () if it is no ancestor."""
        frames = self._climb(source, {target.lstrip("/")})
        return tuple(frames[:-1]) if frames and frames[-1] == target.lstrip("/") else ()

    def age(self, target: str, source: str, now: float) -> float:
        """Return the age (s) of the oldest moving frame between two. Raises TransformError without a connection."""
        chain = self.chain(target, source)
        if not chain and target.lstrip("/") != source.lstrip("/"):
            raise TransformError(f"no transform from {source.lstrip('/')} to {target.lstrip('/')}")
        moving = [stamps[-1] for frame in chain if frame not in self._fixed and (stamps := self._stamps.get(frame))]
        return max((now - stamp for stamp in moving), default=0.0)

    def _climb(self, frame: str, ends: set[str] | None) -> list[str]:
        """Return the frame and its ancestors, up to the first of `ends`."""
        frames = [frame.lstrip("/")]
        while not (ends and frames[-1] in ends) and len(frames) <= len(self._parents):
            parent = self._parents.get(frames[-1])
            if parent is None:
                break
            frames.append(parent)
        return frames

    def _chain_pose(self, frames: list[str], stamp: float | None, hold: float) -> Pose3:
        total = _IDENTITY
        for frame in frames:
            pose = self._pose_at(frame, stamp, hold)
            total = pose if total is _IDENTITY else pose.compose(total)
        return total

    def _pose_at(self, frame: str, stamp: float | None, hold: float) -> Pose3:
        poses, stamps = self._poses.get(frame, []), self._stamps.get(frame, [])
        count = min(len(poses), len(stamps))
        if not count:  # forgotten by another thread just now
            raise TransformError(f"no transform of {frame}")
        if stamp is None or frame in self._fixed or stamps[count - 1] <= stamp <= stamps[count - 1] + hold:
            return poses[count - 1]
        after = bisect_left(stamps, stamp, 0, count)
        if after == count:
            late = stamp - stamps[count - 1]
            raise ExtrapolationError(f"the newest transform of {frame} is {late:.2f} s too old", ahead=True)
        if stamps[after] == stamp:
            return poses[after]
        if after == 0:
            raise ExtrapolationError(
                f"the oldest transform of {frame} is {stamps[0] - stamp:.2f} s too new", ahead=False
            )
        share = (stamp - stamps[after - 1]) / (stamps[after] - stamps[after - 1])
        return interpolate(poses[after - 1], poses[after], share)
