import math

import numpy as np
import pytest

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.mount_watch import MountError, MountWatch

DESCRIBED = Pose2(0.1, 0.0, 0.0)
TURNED = math.radians(2.0)


def watch(mounted: Pose2, *, scale: float = 1.0, drift: float = 0.0, turns: bool = True) -> list[MountError]:
    """What is noticed on a drive of five minutes with a lidar at `mounted`; odometry is so much too long, and turns."""
    random = np.random.default_rng(3)
    frame = DESCRIBED.compose(mounted.inverse())
    found, watched, before = [], MountWatch(), Pose2(0.0, 0.0, 0.0)
    for number in range(3000):
        turn = 0.05 * math.sin(number / 23.0) if turns else 0.0
        true = Pose2(0.05, 0.0, turn) if number % 200 < 150 else Pose2(0.0, 0.0, 0.08 if turns else 0.0)
        now = Pose2(*(random.standard_normal(3) * (0.003, 0.003, 0.002)).tolist())  # of a match, not of a motion
        shown = before.inverse().compose(frame.compose(true).compose(frame.inverse())).compose(now)
        before = now
        reported = Pose2(scale * true.x, 0.0, true.yaw + drift * true.x)
        error = watched.add(reported, shown, DESCRIBED)
        found += [error] if error else []
    return found


@pytest.mark.parametrize(
    "mounted",
    [
        Pose2(0.1, 0.0, TURNED),
        Pose2(0.1, 0.0, -TURNED),
        Pose2(0.13, 0.0, 0.0),
        Pose2(0.1, 0.03, 0.0),
        Pose2(0.07, 0.0, 0.0),
    ],
)
def test_lidar_that_is_mounted_elsewhere_is_noticed_once_with_its_place(mounted: Pose2) -> None:
    (error,) = watch(mounted, scale=1.02, drift=0.02)
    assert error.described == DESCRIBED
    assert math.dist(error.shown[:2], mounted[:2]) < 0.008
    assert error.shown.yaw == pytest.approx(mounted.yaw, abs=math.radians(0.4))


@pytest.mark.parametrize(("scale", "drift"), [(1.0, 0.0), (1.05, math.radians(3.0)), (0.95, -math.radians(3.0))])
def test_poor_odometry_is_no_wrong_mount(scale: float, drift: float) -> None:
    assert watch(DESCRIBED, scale=scale, drift=drift) == []


def test_straight_drive_shows_how_a_lidar_is_turned_and_not_where_it_is() -> None:
    assert watch(Pose2(0.13, 0.03, 0.0), turns=False) == []
    (error,) = watch(Pose2(0.1, 0.0, TURNED), turns=False)
    assert error.shown.yaw == pytest.approx(TURNED, abs=math.radians(0.4))


def test_wheels_that_slip_teach_nothing() -> None:
    watched = MountWatch()
    assert not any(watched.add(Pose2(0.05, 0.0, 0.0), Pose2(0.0, 0.0, 0.0), DESCRIBED) for _ in range(1000))
