"""Reports of the node `slam_gmapping` on its pose, wheels and gyroscope."""

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.slam.gmapping.slam import SlamStep
from ur_nodes.slam.gyro import Headings
from ur_nodes.slam.mount_watch import MountError, MountWatch

_SCANS = 20  # over which both motions are compared
_LEAST = (0.15, 0.3)  # m, rad: smaller differences are usual
_SHARE = 0.5  # of the distance by odometry: likewise


@dataclass(frozen=True, slots=True)
class Slip:
    """The same motion as odometry `reported` it and as the scans have `shown` it."""

    reported: Pose2
    shown: Pose2


class SlipWatch:
    """Compares the motions between scans by odometry and by the scans."""

    def __init__(self) -> None:
        self._steps: deque[tuple[Pose2, Pose2]] = deque(maxlen=_SCANS)

    def forget(self) -> None:
        """Restart, for example after a scan whose motion is uncertain."""
        self._steps.clear()

    def add(self, reported: Pose2, shown: Pose2) -> Slip | None:
        """Add the motion between two scans; returns a detected slip, and then restarts."""
        self._steps.append((reported, shown))
        whole = Pose2(0.0, 0.0, 0.0)
        other = Pose2(0.0, 0.0, 0.0)
        for by_wheels, by_scans in self._steps:
            whole, other = whole.compose(by_wheels), other.compose(by_scans)
        apart = math.hypot(whole.x - other.x, whole.y - other.y)
        turned = abs(wrap_angle(whole.yaw - other.yaw))
        if apart <= max(_LEAST[0], _SHARE * math.hypot(whole.x, whole.y)) and turned <= _LEAST[1]:
            return None
        self._steps.clear()
        return Slip(whole, other)


SLIP_SILENCE = 30.0  # s between two reports of wheels that slip


class SlamReports:
    """Logs changes from scan to scan. `describe` is called with places on the map that look alike."""

    def __init__(self, node: Node, describe: Callable[[Sequence[Pose2]], None], *, lost: bool) -> None:
        """`lost`: the initial state."""
        self._node, self._log = node, node.log
        self._describe = describe
        self._located, self._lost, self._places = True, lost, 0  # as reported last
        self._slip = SlipWatch()
        self._mount = MountWatch()
        self._slip_due = 0
        self._last: Pose2 | None = None  # odometry at the last scan
        self._by_gyro = self._gyro_wrong = False  # as reported last

    def on_step(self, step: SlamStep) -> None:
        """Report the changes after a scan."""
        estimate = step.estimate
        if step.lost or self._lost:
            self._report_search(step)
        elif self._located and not estimate.located:
            share = 100.0 * estimate.agreement
            self._log.warn(f"the scan does not match the map ({share:.0f} % of it); the map goes on by odometry alone")
        elif estimate.located and not self._located:
            self._log.info("the scan matches the map again")
        self._located, self._lost = estimate.located or step.lost, step.lost
        self._watch_wheels(step)

    def watch_gyro(self, headings: Headings) -> None:
        """Report whether the gyroscope is used, and one that contradicts the scans."""
        if headings.trusted != self._by_gyro:
            self._by_gyro = headings.trusted
            source = f"the gyroscope on {self._node.resolve('imu')} turns" if self._by_gyro else "the wheels turn"
            self._log.info(f"{source} as the scans show: the robot's turns come from there")
        if headings.contradicted and not self._gyro_wrong:
            self._gyro_wrong = True
            topic = self._node.resolve("imu")
            self._log.warn(f"the yaw rates on {topic} contradict the scans and are not used; is its frame right?")

    def _report_search(self, step: SlamStep) -> None:
        if not step.lost:
            self._log.info("found again at ({:.2f}, {:.2f})".format(*step.estimate.pose[:2]))
            self._places = 0
            return
        if not self._lost:
            self._log.warn("lost: looking for the place on the map; drive slowly through places that are mapped")
        if len(step.poses) not in (0, self._places):
            self._describe(step.poses)
        self._places = len(step.poses)

    def _watch_wheels(self, step: SlamStep) -> None:
        last, self._last = self._last, step.odometry
        estimate = step.estimate
        if estimate.still:
            return
        if not step.odometry or not last or not estimate.step or step.lost:
            self._slip.forget()
            self._mount.forget()
            return
        reported = last.inverse().compose(step.odometry)
        if step.mount and (error := self._mount.add(reported, estimate.step, step.mount)):
            self._log.warn(_describe_mount(error))
        slip = self._slip.add(reported, estimate.step)
        now = self._node.now()
        if slip and not self._slip_due - SLIP_SILENCE * SECOND < now < self._slip_due:
            self._slip_due = now + round(SLIP_SILENCE * SECOND)
            self._log.warn(
                "the wheels slip, or the robot is pushed: odometry reports {:.2f} m and {:.0f} degrees, the scans "
                "{:.2f} m and {:.0f} degrees; the map follows the scans".format(*_sizes(slip.reported, slip.shown)),
            )


def _describe_mount(error: MountError) -> str:
    described, shown = (
        "x {:.3f} m, y {:.3f} m, yaw {:.3f} rad".format(*pose) for pose in (error.described, error.shown)
    )
    return (
        f"wheels and scans show the lidar at {shown}, the robot's description has it at {described}; "
        "measure it, and correct its pose in the base file"
    )


def _sizes(*motions: Pose2) -> list[float]:
    """Return the distance (m) and the turn (degrees) of each motion."""
    return [size for each in motions for size in (math.hypot(each.x, each.y), math.degrees(each.yaw))]
