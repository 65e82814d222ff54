"""The node `simulator` on a bus: what it publishes, how it keeps time, and what it does when asked."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from tests.base_contract import EVERY, list_topics, load
from tests.ur_nodes.first_drive.stage import WORLDS, DrivenStage
from tests.ur_nodes.simulator.renderer import needs_renderer

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.ports import values
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Silent, Switch, Trigger
from ur_nodes.ports.values import ClockTime, Joints, Odometry, PackedPicture, Picture, Scan, Transform

TYPES: dict[object, str] = {
    Odometry: "nav_msgs/Odometry",
    Joints: "sensor_msgs/JointState",
    Scan: "sensor_msgs/LaserScan",
    values.Range: "sensor_msgs/Range",
    values.Imu: "sensor_msgs/Imu",
    values.Battery: "sensor_msgs/BatteryState",
    bool: "std_msgs/Bool",
    Picture: "sensor_msgs/Image",
    PackedPicture: "sensor_msgs/CompressedImage",
    values.Calibration: "sensor_msgs/CameraInfo",
}
SENSORS = {"sensor_msgs/Range", "sensor_msgs/LaserScan", "sensor_msgs/Imu", "sensor_msgs/BatteryState"}


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_simulated_base_publishes_what_its_file_says(name: str, variant: str) -> None:
    expected = list_topics(load(name, variant))
    topics = DrivenStage(base=name, variant=variant).bus.topics
    known = {topic: TYPES.get(offer.kind, "") for topic, ends in topics.items() for offer in ends.publishers}
    assert {topic: known.get(topic) for topic in expected} == expected
    assert {topic for topic, kind in known.items() if kind in SENSORS} <= set(expected)


def test_node_publishes_what_stage_ros_does_at_the_rates_of_the_base() -> None:
    stage = DrivenStage()
    scans, odometry = stage.record("scan", Scan), stage.record("odom", Odometry)
    transforms, joints = stage.record("/tf", tuple), stage.record("joint_states", Joints)
    stage.bus.run(1.5)
    assert {b.stamp - a.stamp for a, b in pairwise(scans)} == {100_000_000}
    assert scans[0].frame == "laser"
    assert len(scans[0].ranges) == 360
    gaps = [b.stamp - a.stamp for a, b in pairwise(odometry)]
    assert sorted(gaps)[len(gaps) // 2] == pytest.approx(1e9 / 30, abs=6e6)
    assert (odometry[0].frame, odometry[0].child) == ("odom", "base_footprint")
    assert odometry[0].pose_covariance.shape == (3, 3)
    assert joints[0].names == ("left_wheel_joint", "right_wheel_joint")
    assert stage.truth.frame == "map"
    edge: Transform = transforms[0][0]
    assert (edge.parent, edge.child) == ("odom", "base_footprint")
    # Nobody has to wait for the transform of a scan.
    assert {scan.stamp for scan in scans} <= {each[0].stamp for each in transforms}


def test_node_drives_and_stops_when_commands_cease() -> None:
    stage = DrivenStage()
    odometry = stage.record("odom", Odometry)
    stage.drive(0.4, 0.0, 1.0)
    assert stage.truth.twist.forward > 0.1
    stage.bus.run(3.0)
    assert abs(stage.truth.twist.forward) < 0.001
    assert 0.2 < stage.truth.pose.x < 0.9
    assert odometry[-1].pose.x == pytest.approx(stage.truth.pose.x, abs=0.05)


def test_node_goes_step_by_step_and_repeats_itself_after_a_reset() -> None:
    stage = DrivenStage(seed=4, publish_clock=True)
    scans = stage.record("scan", Scan)
    refused = stage.ask("simulator/step", Trigger())
    assert (refused.success, refused.text) == (False, "not paused, expected ~pause with true before ~step")
    assert stage.ask("simulator/pause", Switch(on=True)).text == "paused"
    runs = []
    for _ in range(2):
        stage.ask("simulator/reset", Silent())
        before, count = simulated_time(stage), len(scans)
        for _ in range(5):
            after = simulated_time(stage)
        assert after - before == pytest.approx(0.5)
        runs.append([scan.ranges.tolist() for scan in scans[count:]])
    assert len(runs[0]) == 5
    assert runs[0] == runs[1]
    assert runs[0][0] != runs[0][1]
    count = len(scans)
    stage.bus.run(5.0)
    assert len(scans) == count
    assert stage.ask("simulator/pause", Switch(on=False)).text == "running"
    stage.bus.run(1.0)
    assert len(scans) == pytest.approx(count + 10, abs=1)


def simulated_time(stage: DrivenStage) -> float:
    """The simulated time (s) after a step."""
    text = stage.ask("simulator/step", Trigger()).text
    stage.bus.run(0.001)  # what was sent arrives
    assert text.startswith("simulated time ")
    return float(text.split()[2])


def test_node_places_robot_and_obstacles_and_counts_collisions() -> None:
    stage = DrivenStage()
    scans, collisions = stage.record("scan", Scan), stage.record("simulator/collisions", int, Quality.LATCHED_EVERY)
    assert stage.place(2.0, 0.0).success
    stage.bus.run(0.1)
    assert stage.truth.pose.x == pytest.approx(2.0)
    assert stage.place(3.0, 0.0, name="obstacle_1").success
    stage.bus.run(0.2)
    assert scans[-1].ranges[180] == pytest.approx(3.0 - 0.15 - 2.1, abs=0.06)
    mistakes = [
        (stage.place(-0.6, 0.0), "robot_0 cannot be at x -0.6, y 0: a wall, expected free floor"),
        (stage.place(3.0, 0.0), "robot_0 cannot be at x 3, y 0: obstacle_1"),
        (stage.place(1.0, 0.0, name="obstakle_1"), "expected one of robot_0, obstacle_1"),
        (stage.place(1.0, 0.0, frame="odom"), "a pose in frame 'odom', expected 'map'"),
    ]
    for result, text in mistakes:
        assert not result.success
        assert text in result.text
    assert collisions == [0]
    assert stage.drive_until(lambda: len(collisions) == 2, 0.5, 0.0, 10.0)
    assert collisions == [0, 1]


def test_node_at_another_speed_is_the_clock() -> None:
    stage = DrivenStage(speed=5.0)
    clock, scans = stage.record("/clock", ClockTime), stage.record("scan", Scan)
    stage.bus.run(1.0)
    assert clock[-1].stamp - clock[0].stamp == pytest.approx(5e9, abs=3e7)
    assert scans[-1].stamp - scans[0].stamp == pytest.approx(1e8 * (len(scans) - 1), abs=1e6)
    assert {scan.stamp for scan in scans} <= {each.stamp for each in clock}


def test_node_gives_several_robots_names_of_their_own() -> None:
    stage = DrivenStage("office", robots=2)
    odometry, scans = stage.record("robot_1/odom", Odometry), stage.record("robot_1/scan", Scan)
    truth = stage.record("robot_1/base_pose_ground_truth", Odometry)
    stage.drive(0.5, 0.0, 1.0, topic="robot_1/cmd_vel")
    assert (odometry[0].frame, odometry[0].child) == ("robot_1/odom", "robot_1/base_footprint")
    assert scans[0].frame == "robot_1/laser"
    assert truth[-1].twist.forward > 0.1
    assert abs(stage.truth.twist.forward) < 0.01


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("base", "stagge", "unknown base 'stagge'"),
        ("world_file", "/nowhere/maze.yaml", "/nowhere/maze.yaml: no such file or directory"),
        ("world_file", "BROKEN", "broken.yaml:3:1: error: not valid YAML"),
        ("speed", "fast", "parameter /simulator/speed: 'fast', expected a number"),
        ("x", -0.6, "robot_0 cannot be at x -0.6, y 0: a wall"),
        ("camera_rate", "fast", "parameter /simulator/camera_rate: 'fast', expected a number from 0 to 200"),
    ],
)
def test_node_refuses_what_it_cannot_use(tmp_path: Path, name: str, value: object, message: str) -> None:
    (tmp_path / "broken.yaml").write_text("floor_plan: x.yaml\nboxes: [\n")
    value = str(tmp_path / "broken.yaml") if value == "BROKEN" else value
    parameters: dict[str, Any] = {"base": "magni", "world_file": str(WORLDS / "maze.yaml"), name: value}
    with pytest.raises(UserError) as caught:
        DrivenStage(**parameters)
    assert message in render_human(caught.value.diagnostics)


def test_camera_draws_while_its_topics_have_listeners() -> None:
    needs_renderer()
    stage = DrivenStage(base="magni", camera_width=160, camera_height=120, camera_rate=5.0)
    stage.bus.run(1.0)
    images = stage.record("raspicam_node/image_raw", Picture)
    stage.bus.run(0.7)
    assert [(each.width, each.height, each.step, len(each.data)) for each in images] == [(160, 120, 480, 57600)] * 3
    assert images[0].frame == "raspicam"
    assert images[1].stamp - images[0].stamp == pytest.approx(2e8, abs=5e6)
    packed = stage.record("raspicam_node/image/compressed", PackedPicture)
    infos = stage.record("raspicam_node/camera_info", values.Calibration)
    stage.bus.run(0.3)
    assert {(each.format, each.data[:2].hex()) for each in packed} == {("jpeg", "ffd8")}
    assert infos[0].matrix[2] == 79.5
    assert [each.stamp for each in infos] == [each.stamp for each in packed]
    stage.simulator.end("the test is over")


def test_camera_that_cannot_draw_reports_it_and_tries_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MUJOCO_GL", "none")
    stage = DrivenStage(base="magni")
    stage.record("raspicam_node/image_raw", Picture)
    stage.bus.run(9.0)
    errors = [text for level, text in stage.simulator.lines if level == "error"]
    assert len(errors) == 1
    assert "the simulated camera cannot draw" in errors[0]
    stage.bus.run(3.0)
    assert len([level for level, _ in stage.simulator.lines if level == "error"]) == 2
