import math

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.gmapping.map_output import SlipWatch


def test_wheels_that_spin_on_the_spot_are_noticed_once() -> None:
    watch = SlipWatch()
    found = [watch.add(Pose2(0.03, 0.0, 0.0), Pose2(0.0, 0.0, 0.0)) for _ in range(8)]
    noticed = [number for number, slip in enumerate(found) if slip]
    assert noticed == [5]
    slip = found[5]
    assert slip
    assert slip.reported.x > 0.15
    assert slip.shown.x == 0.0


def test_turn_that_only_the_wheels_report_is_noticed() -> None:
    watch = SlipWatch()
    assert any(watch.add(Pose2(0.0, 0.0, 0.05), Pose2(0.0, 0.0, 0.01)) for _ in range(12))


def test_poor_odometry_is_no_slip() -> None:
    """5 % long, and turning 3 degrees a metre, at 1 m/s and 5 scans a second."""
    watch = SlipWatch()
    for _ in range(100):
        assert watch.add(Pose2(0.21, 0.0, math.radians(0.6)), Pose2(0.2, 0.0, 0.0)) is None


def test_forgotten_motions_do_not_count() -> None:
    watch = SlipWatch()
    for _ in range(4):
        for _ in range(5):
            assert watch.add(Pose2(0.03, 0.0, 0.0), Pose2(0.0, 0.0, 0.0)) is None
        watch.forget()
