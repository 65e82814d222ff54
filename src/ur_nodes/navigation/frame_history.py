"""Frames in the plane, with the history of the last seconds: what tf knows, as far as a driving robot needs it."""

from __future__ import annotations

from bisect import bisect_right

from ur_nodes.rosio.pose import Pose2, wrap_angle


class FrameError(Exception):
    """Two frames are not connected, or were not at that time. The text is a sentence part for people."""


class FrameHistory:
    """Poses of frames in their parents, all seen from above. Names may carry a leading slash.

    One thread may add while others ask.
    """

    def __init__(self, keep: float = 5.0) -> None:
        self._keep = keep
        self._parents: dict[str, str] = {}
        self._stamps: dict[str, list[float]] = {}
        self._poses: dict[str, list[Pose2]] = {}
        self._fixed: set[str] = set()

    def add(self, parent: str, child: str, stamp: float, pose: Pose2, *, fixed: bool = False) -> None:
        """Take a link in. Older than what is there by more than the history is long: time has begun anew."""
        child = child.lstrip("/")
        self._parents[child] = parent.lstrip("/")
        stamps, poses = self._stamps.get(child, []), self._poses.get(child, [])
        if fixed:
            self._fixed.add(child)
            stamps, poses = [], []
        if stamps and stamp <= stamps[-1]:
            if stamps[-1] - stamp < self._keep:
                return
            stamps, poses = [], []
        drop = bisect_right(stamps, stamp - self._keep) if len(stamps) > 200 else 0
        # New lists instead of changed ones: a reader in another thread keeps a matching pair.
        self._poses[child] = [*poses[drop:], pose] if drop or not poses else poses
        self._stamps[child] = [*stamps[drop:], stamp] if drop or not stamps else stamps
        if not drop and poses:
            poses.append(pose)
            stamps.append(stamp)

    def forget(self) -> None:
        """Forget what moves; fixed links stay."""
        for child in list(self._stamps):
            if child not in self._fixed:
                del self._stamps[child], self._poses[child], self._parents[child]

    def newest(self, child: str) -> float | None:
        """The stamp of a frame's newest link, None when it has none."""
        stamps = self._stamps.get(child.lstrip("/"))
        return stamps[-1] if stamps else None

    def pose(self, target: str, source: str, stamp: float | None = None) -> Pose2:
        """The pose of `source` in its ancestor `target` at a time, or the newest.

        Between two known ones it is interpolated, outside of the known it is the nearest. Raises FrameError when the
        frames are not connected.
        """
        total = Pose2(0.0, 0.0, 0.0)
        frame, end = source.lstrip("/"), target.lstrip("/")
        for _ in range(len(self._parents) + 1):
            if frame == end:
                return total
            if frame not in self._parents:
                break
            total = self._link(frame, stamp).compose(total)
            frame = self._parents[frame]
        raise FrameError(f"no transform from {source} to {target}")

    def chain(self, target: str, source: str) -> tuple[str, ...]:
        """The frames whose links lead from `source` up to `target`; () when they are not connected."""
        frames: list[str] = []
        frame, end = source.lstrip("/"), target.lstrip("/")
        while frame != end and frame in self._parents and len(frames) <= len(self._parents):
            frames.append(frame)
            frame = self._parents[frame]
        return tuple(frames) if frame == end else ()

    def age(self, target: str, source: str, now: float) -> float:
        """How old (s) the oldest of the moving links between two frames is. Raises FrameError when not connected."""
        chain = self.chain(target, source)
        if not chain and target.lstrip("/") != source.lstrip("/"):
            raise FrameError(f"no transform from {source} to {target}")
        moving = [self._stamps[frame][-1] for frame in chain if frame not in self._fixed]
        return max((now - stamp for stamp in moving), default=0.0)

    def _link(self, frame: str, stamp: float | None) -> Pose2:
        poses, stamps = self._poses[frame], self._stamps[frame]
        count = min(len(poses), len(stamps))
        if stamp is None or frame in self._fixed or stamp >= stamps[count - 1]:
            return poses[count - 1]
        after = bisect_right(stamps, stamp, 0, count)
        if after == 0:
            return poses[0]
        a, b = poses[after - 1], poses[after]
        share = (stamp - stamps[after - 1]) / (stamps[after] - stamps[after - 1])
        return Pose2(
            a.x + share * (b.x - a.x),
            a.y + share * (b.y - a.y),
            wrap_angle(a.yaw + share * wrap_angle(b.yaw - a.yaw)),
        )
