"""Rules for what pages publish, call and set."""

import pytest

from ur_nodes.web.data.guard import refuse_parameter, refuse_service, refuse_topic


@pytest.mark.parametrize(
    ("topic", "kind"),
    [
        ("/cmd_vel", "geometry_msgs/Twist"),
        ("/harmless", "geometry_msgs/Twist"),
        ("/harmless", "geometry_msgs/msg/Twist"),
        ("/web_vel_stamped", "geometry_msgs/TwistStamped"),
        ("/bob/left_wheel", "std_msgs/Float64"),
        ("/motor_power", "std_msgs/Bool"),
        ("/joy", "sensor_msgs/Joy"),
        ("/arm/follow_joint_trajectory/goal", "control_msgs/FollowJointTrajectoryActionGoal"),
        ("/move_base/cancel", "actionlib_msgs/GoalID"),
        ("/move_base/continue", "std_msgs/Empty"),
        ("/move_base_simple/goal", "geometry_msgs/PoseStamped"),
        ("/initialpose", "geometry_msgs/PoseWithCovarianceStamped"),
        ("/bob/cmd_vel_mux/lease_request", "std_msgs/String"),
        ("/pause_driving", "std_msgs/Bool"),
        ("/scan", "sensor_msgs/LaserScan"),
        ("/map", "nav_msgs/OccupancyGrid"),
        ("/bumper/front", "std_msgs/Bool"),
        ("/cliff/left", "std_msgs/Bool"),
        ("/tf", "tf2_msgs/TFMessage"),
        ("/clock", "rosgraph_msgs/Clock"),
    ],
)
def test_what_moves_a_base_or_deceives_it_is_refused_with_the_reason(topic: str, kind: str) -> None:
    refusal = refuse_topic(topic, kind)
    assert refusal is not None
    assert refusal.startswith(topic)
    assert "\n" not in refusal


def test_topic_that_the_mux_reads_under_another_name_is_refused() -> None:
    assert refuse_topic("/strange", "std_msgs/String", ["/bob/cmd_vel_mux"])
    assert refuse_topic("/strange", "std_msgs/String", ["/led_node"]) is None


@pytest.mark.parametrize(
    ("topic", "kind"),
    [("/led1", "kobuki_msgs/Led"), ("/chatter", "std_msgs/String"), ("/sound", "kobuki_msgs/Sound")],
)
def test_other_topics_may_be_published(topic: str, kind: str) -> None:
    assert refuse_topic(topic, kind) is None


def test_services_and_parameters_of_the_mux_are_refused() -> None:
    assert refuse_service("/cmd_vel_mux/release")
    assert refuse_service("/cmd_vel_mux/stop") is None
    assert refuse_service("/move_base/make_plan") is None
    assert refuse_parameter("/cmd_vel_mux/freshness")
    assert refuse_parameter("/ur/lease")
    assert refuse_parameter("/run_id")
    assert refuse_parameter("/urgent") is None
    assert refuse_parameter("/move_base/tolerance") is None
