import numpy as np

from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.pose_graph.loop_closer import Confirmation, PoseLink, find_groups

POSES = [Pose2(float(number), 0.0, 0.0) for number in range(50)]


def link(after: int, *, weak: bool = False, shift: float = 1.0) -> PoseLink:
    return PoseLink(0, after, Pose2(0.0, 0.0, 0.0), np.eye(3), False, Pose2(shift, 0.0, 0.0), weak)


def test_two_clear_links_confirm_each_other() -> None:
    waiting = Confirmation(24)
    first, other, second = link(40), link(41, shift=2.0), link(42)
    assert waiting.confirm(first, POSES) == []
    assert waiting.confirm(other, POSES) == []
    assert waiting.confirm(second, POSES) == [first, second]


def test_weak_link_waits_for_two_others() -> None:
    waiting = Confirmation(24)
    first, clear, last = link(40, weak=True), link(41), link(42, weak=True)
    assert waiting.confirm(first, POSES) == []
    assert waiting.confirm(clear, POSES) == []
    assert waiting.confirm(last, POSES) == [first, clear, last]


def test_two_links_of_one_keyframe_count_as_one() -> None:
    waiting = Confirmation(24)
    assert waiting.confirm(link(40, weak=True), POSES) == []
    assert waiting.confirm(link(40, weak=True), POSES) == []
    assert waiting.confirm(link(41, weak=True), POSES) == []


def test_uncertain_places_are_looked_at_from_as_far_as_the_scan_sees() -> None:
    here = [*POSES[:30], Pose2(15.0, 6.0, 0.0)]
    near, far, uncertain = np.full(31, 0.05), np.full(31, 0.05), np.full(31, 0.3)
    assert not find_groups(here, 30, near, 30)
    assert not find_groups(here, 30, far, 30, 6.0)
    assert not find_groups(here, 30, uncertain, 30)
    assert [group.anchor for group in find_groups(here, 30, uncertain, 30, 6.0)] == [15]
