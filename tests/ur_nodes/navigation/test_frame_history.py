from __future__ import annotations

import math

import pytest

from ur_nodes.navigation.frame_history import FrameError, FrameHistory
from ur_nodes.rosio.pose import Pose2


def filled() -> FrameHistory:
    frames = FrameHistory()
    frames.add("base_link", "laser", 0.0, Pose2(0.1, 0.0, 0.0), fixed=True)
    frames.add("/odom", "/base_link", 1.0, Pose2(0.0, 0.0, 3.0))
    frames.add("odom", "base_link", 2.0, Pose2(1.0, 0.0, -3.0))
    frames.add("map", "odom", 2.0, Pose2(0.0, 5.0, 0.0))
    return frames


def test_frame_history_follows_links_up_to_an_ancestor() -> None:
    pose = filled().pose("map", "laser")
    assert pose == pytest.approx((1.0 + 0.1 * math.cos(-3.0), 5.0 + 0.1 * math.sin(-3.0), -3.0))


def test_frame_history_interpolates_the_short_way_round() -> None:
    pose = filled().pose("odom", "base_link", 1.5)
    assert pose.x == pytest.approx(0.5)
    assert abs(pose.yaw) == pytest.approx(math.pi, abs=1e-6)


def test_frame_history_answers_with_the_nearest_outside_of_what_it_knows() -> None:
    frames = filled()
    assert frames.pose("odom", "base_link", 0.2).yaw == 3.0
    assert frames.pose("odom", "base_link", 9.0).yaw == -3.0


def test_frame_history_names_frames_that_are_not_connected() -> None:
    with pytest.raises(FrameError, match="no transform from camera to map"):
        filled().pose("map", "camera")


def test_frame_history_age_is_that_of_the_oldest_moving_link() -> None:
    frames = filled()
    frames.add("map", "odom", 2.5, Pose2(0.0, 5.0, 0.0))
    assert frames.age("map", "laser", 3.0) == pytest.approx(1.0)
    assert frames.age("base_link", "laser", 3.0) == 0.0


def test_frame_history_drops_what_is_old_and_what_comes_late() -> None:
    frames = FrameHistory(keep=1.0)
    for number in range(1000):
        frames.add("odom", "base_link", 0.01 * number, Pose2(float(number), 0.0, 0.0))
    frames.add("odom", "base_link", 9.5, Pose2(-1.0, 0.0, 0.0))
    assert frames.pose("odom", "base_link").x == 999.0
    assert frames.pose("odom", "base_link", 0.0).x > 700.0


def test_frame_history_begins_anew_when_time_does() -> None:
    frames = filled()
    frames.add("odom", "base_link", 100.0, Pose2(9.0, 0.0, 0.0))
    frames.add("odom", "base_link", 0.5, Pose2(0.2, 0.0, 0.0))
    assert frames.pose("odom", "base_link").x == 0.2
    frames.forget()
    assert frames.newest("base_link") is None
    assert frames.pose("base_link", "laser").x == 0.1
