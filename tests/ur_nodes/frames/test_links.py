import math

import pytest

from ur.robot.description.parse import parse_urdf
from ur_nodes.frames.robot_state_publisher_node import fixed_frames, moving_frames

URDF = """<robot name="r"><link name="base"/><link name="laser"/><link name="wheel"/><link name="lift"/>
<joint name="mount" type="fixed">
  <parent link="base"/><child link="laser"/><origin xyz="0.1 0 0.2" rpy="0 0 1.570796"/>
</joint>
<joint name="axle" type="continuous">
  <parent link="base"/><child link="wheel"/><origin xyz="0 0.2 0"/><axis xyz="0 2 0"/>
</joint>
<joint name="rail" type="prismatic">
  <parent link="base"/><child link="lift"/><axis xyz="0 0 1"/>
  <limit effort="1" velocity="1" lower="0" upper="1"/>
</joint>
</robot>"""


def test_fixed_links_are_where_the_description_has_them() -> None:
    [laser] = fixed_frames(parse_urdf(URDF, "r.urdf"), 5)
    assert (laser.stamp, laser.parent, laser.child, laser.fixed) == (5, "base", "laser", True)
    assert (laser.pose.x, laser.pose.y, laser.pose.z) == (0.1, 0.0, 0.2)
    assert laser.pose.planar().yaw == pytest.approx(math.pi / 2, abs=1e-6)


def test_links_move_about_and_along_their_axes() -> None:
    wheel, lift = moving_frames(parse_urdf(URDF, "r.urdf"), {"axle": math.pi / 2, "rail": 0.3, "other": 1.0}, 6)
    assert wheel.pose == pytest.approx((0.0, 0.2, 0.0, 0.0, math.sqrt(0.5), 0.0, math.sqrt(0.5)))
    assert (lift.pose.x, lift.pose.y, lift.pose.z) == pytest.approx((0.0, 0.0, 0.3))


def test_joint_without_a_position_sends_no_frame() -> None:
    assert moving_frames(parse_urdf(URDF, "r.urdf"), {}, 6) == ()
