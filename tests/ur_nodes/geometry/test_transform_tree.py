import math

import pytest

from ur_nodes.geometry.pose import Pose2, Pose3, make_pose3
from ur_nodes.geometry.transform_tree import ExtrapolationError, TransformError, TransformTree


def on_floor(x: float, y: float, yaw: float) -> Pose3:
    return make_pose3((x, y, 0.0), (0.0, 0.0, math.sin(yaw / 2.0), math.cos(yaw / 2.0)))


def filled() -> TransformTree:
    tree = TransformTree()
    tree.add("base_link", "laser", 0.0, on_floor(0.1, 0.0, 0.0), fixed=True)
    tree.add("base_link", "camera", 0.0, make_pose3((0.2, 0.0, 0.5), (-0.5, 0.5, -0.5, 0.5)), fixed=True)
    tree.add("/odom", "/base_link", 1.0, on_floor(0.0, 0.0, 3.0))
    tree.add("odom", "base_link", 2.0, on_floor(1.0, 0.0, -3.0))
    tree.add("map", "odom", 2.0, on_floor(0.0, 5.0, 0.0))
    return tree


def test_lookup_composes_transforms_up_to_an_ancestor() -> None:
    pose = filled().pose("map", "laser")
    assert pose == pytest.approx((1.0 + 0.1 * math.cos(-3.0), 5.0 + 0.1 * math.sin(-3.0), -3.0))


def test_lookup_finds_the_ancestor_of_both_frames() -> None:
    assert filled().lookup("laser", "camera")[:3] == pytest.approx((0.1, 0.0, 0.5))
    assert filled().pose("laser", "map") == pytest.approx(filled().pose("map", "laser").inverse())


def test_lookup_interpolates_the_short_way_round() -> None:
    pose = filled().pose("odom", "base_link", 1.5)
    assert pose.x == pytest.approx(0.5)
    assert abs(pose.yaw) == pytest.approx(math.pi, abs=1e-6)


def test_lookup_interpolates_rotations_out_of_the_plane() -> None:
    tree = TransformTree()
    tree.add("base", "arm", 0.0, make_pose3((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
    tree.add("base", "arm", 1.0, make_pose3((0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 1.0)))  # 90 degrees about y
    assert tree.lookup("base", "arm", 1 / 3).qy == pytest.approx(math.sin(math.radians(15.0)))


@pytest.mark.parametrize(("stamp", "ahead"), [(0.9, False), (2.1, True)])
def test_lookup_refuses_times_outside_of_the_history(stamp: float, ahead: bool) -> None:
    with pytest.raises(ExtrapolationError) as caught:
        filled().pose("odom", "base_link", stamp)
    assert caught.value.ahead is ahead


def test_newest_pose_is_held_only_as_long_as_asked_for() -> None:
    assert filled().pose("odom", "base_link", 2.5, hold=0.5).yaw == pytest.approx(-3.0)
    with pytest.raises(ExtrapolationError, match=r"the newest transform of base_link is 0\.51 s too old"):
        filled().pose("odom", "base_link", 2.51, hold=0.5)


def test_fixed_frames_are_known_at_any_time() -> None:
    assert filled().pose("base_link", "laser", 99.0) == Pose2(0.1, 0.0, 0.0)


@pytest.mark.parametrize(("target", "source"), [("map", "gripper"), ("gripper", "map"), ("gripper", "arm")])
def test_lookup_names_frames_that_are_not_connected(target: str, source: str) -> None:
    with pytest.raises(TransformError, match=f"no transform from {source} to {target}"):
        filled().pose(target, source)


def test_lookup_ends_where_frames_form_a_loop() -> None:
    tree = TransformTree()
    tree.add("a", "b", 0.0, on_floor(0.0, 0.0, 0.0))
    tree.add("b", "a", 0.0, on_floor(0.0, 0.0, 0.0))
    with pytest.raises(TransformError):
        tree.pose("map", "a")


def test_age_is_that_of_the_oldest_moving_frame() -> None:
    tree = filled()
    tree.add("map", "odom", 2.5, on_floor(0.0, 5.0, 0.0))
    assert tree.age("map", "laser", 3.0) == pytest.approx(1.0)
    assert tree.age("base_link", "laser", 3.0) == 0.0


def test_history_drops_what_is_old_and_what_arrives_late() -> None:
    tree = TransformTree(keep=1.0)
    for number in range(1000):
        tree.add("odom", "base_link", 0.01 * number, on_floor(float(number), 0.0, 0.0))
    tree.add("odom", "base_link", 9.5, on_floor(-1.0, 0.0, 0.0))
    assert tree.pose("odom", "base_link").x == 999.0
    assert tree.pose("odom", "base_link", 9.5).x == 950.0
    with pytest.raises(ExtrapolationError):
        tree.pose("odom", "base_link", 5.0)


def test_history_starts_again_when_time_does() -> None:
    tree = filled()
    tree.add("odom", "base_link", 100.0, on_floor(9.0, 0.0, 0.0))
    tree.add("odom", "base_link", 0.5, on_floor(0.2, 0.0, 0.0))
    assert tree.pose("odom", "base_link").x == 0.2
    assert tree.newest("odom") is None
    tree.forget()
    assert tree.newest("base_link") is None
    assert tree.pose("base_link", "laser").x == 0.1


def test_velocity_is_along_the_newest_heading() -> None:
    tree = TransformTree()
    assert tree.velocity("base", 0.2) == (0.0, 0.0, 0.0)
    for number in range(4):
        tree.add("odom", "/base", 10.0 + 0.1 * number, on_floor(0.02 * number, 0.05 * number, math.pi / 2))
    assert tree.parent("base") == "odom"
    assert tree.velocity("base", 0.2) == pytest.approx((0.5, -0.2, 0.0))
    assert tree.velocity("base", 1.0) == (0.0, 0.0, 0.0), "the history is shorter"


def test_velocity_turns_through_the_smaller_angle() -> None:
    tree = TransformTree()
    tree.add("odom", "base", 1.0, on_floor(0.0, 0.0, math.pi - 0.1))
    tree.add("odom", "base", 1.5, on_floor(0.0, 0.0, -math.pi + 0.1))
    assert tree.velocity("base", 0.5) == pytest.approx((0.0, 0.0, 0.4))
