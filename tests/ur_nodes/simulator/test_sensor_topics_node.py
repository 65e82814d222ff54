from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ur_nodes.simulator.conftest import PACKAGE
from tests.ur_nodes.simulator.test_simulator_node import Ros

from ur.robot.base import Base

pytestmark = pytest.mark.ros


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[Ros]:
    started = Ros(tmp_path)
    yield started
    started.close()


def test_sonars_share_a_topic_and_have_a_frame_each(ros: Ros, magni: Base) -> None:
    sonars = magni.sonars
    assert sonars is not None
    ros.simulate("_base:=magni", "_speed:=4.0")
    ros.ask("listen", topics=["tf", sonars.topic])
    ros.ask("collect", topic="tf", count=1, seconds=60)
    ranges = ros.ask("collect", topic=sonars.topic, count=6 * len(sonars.at), seconds=60)
    assert {each["frame"] for each in ranges} == {sonar.frame for sonar in sonars.at}
    one = [each for each in ranges if each["frame"] == sonars.at[0].frame]
    assert one[2]["stamp"] - one[1]["stamp"] == pytest.approx(1.0 / sonars.rate, abs=0.005)
    assert one[0]["limits"] == pytest.approx([sonars.field_of_view, sonars.range_min, sonars.range_max])
    assert one[0]["kind"] == 0  # ultrasound
    assert 0.2 < float(one[0]["range"]) < 3.0  # a wall of the maze
    ros.ask("collect", topic="tf", count=1, seconds=60)
    known = {round(each["stamp"], 6) for each in ros.ask("past", topic="tf")}
    assert {round(each["stamp"], 6) for each in ranges} <= known  # nobody has to wait for the transform of a range


def test_inertial_unit_battery_and_wheels_speak_as_the_base_says(ros: Ros, stage: Base) -> None:
    imu, battery = stage.imu, stage.battery
    assert imu is not None
    assert battery is not None
    ros.simulate("_battery_charge:=0.5", "_speed:=4.0")
    ros.ask("listen", topics=[imu.topic, battery.topic, "joint_states"])
    readings = ros.ask("collect", topic=imu.topic, count=20, seconds=60)
    assert readings[1]["stamp"] - readings[0]["stamp"] == pytest.approx(1.0 / imu.rate, abs=0.005)
    assert readings[0]["frame"] == imu.frame
    assert sum(each["force"][2] for each in readings) / 20 == pytest.approx(9.81, abs=0.1)
    assert readings[0]["variance"] == pytest.approx([imu.gyro_noise**2, imu.accel_noise**2])
    assert math.hypot(*readings[0]["orientation"]) == pytest.approx(1.0)
    states = ros.ask("collect", topic=battery.topic, count=2, seconds=60)
    assert states[1]["stamp"] - states[0]["stamp"] == pytest.approx(1.0, abs=0.001)
    assert states[0]["percentage"] == pytest.approx(0.5, abs=0.01)
    assert states[0]["voltage"] == pytest.approx((battery.voltage_full + battery.voltage_empty) / 2, abs=0.05)
    assert states[0]["current"] == pytest.approx(-battery.current_idle, abs=0.05)
    assert states[0]["present"] is True
    assert len(ros.ask("past", topic="joint_states", count=1)[0]["velocities"]) == 2


def test_bumpers_tell_newcomers_and_change_when_the_robot_runs_into_something(ros: Ros) -> None:
    ros.simulate("_speed:=2.0")
    topics = ["bumper/front", "bumper/back"]
    ros.ask("listen", topics=topics)
    assert [ros.ask("past", topic=topic, count=1)[0]["pressed"] for topic in topics] == [False, False]
    ros.ask("call", service="place", name="obstacle_1", x=0.5, y=0.0)
    ros.ask("drive_until", topic="bumper/front", count=2, linear=0.4, seconds=60)
    assert ros.ask("past", topic="bumper/front", count=2)[1] == {"pressed": True}
    ros.ask("drive_until", topic="bumper/front", count=3, linear=-0.2, seconds=60)
    assert ros.ask("past", topic="bumper/front", count=3)[2] == {"pressed": False}
    assert ros.ask("past", topic="bumper/back")[0] == {"pressed": False}


def test_cliff_sensors_report_a_drop_while_the_robot_is_before_it(ros: Ros, tmp_path: Path) -> None:
    maze = PACKAGE / "n_map_server" / "maps" / "maze.yaml"
    world = tmp_path / "stair.yaml"
    world.write_text(f"floor_plan: {maze}\ndrops:\n  - {{pose: [0.7, 0.5, 0.0], size: [0.4, 1.0]}}\n", "utf-8")
    ros.simulate("_base:=botvac", f"_world_file:={world}", "_speed:=2.0")
    topics = ["cliff/left", "cliff/right"]
    ros.ask("listen", topics=topics)
    assert [ros.ask("past", topic=topic, count=1)[0]["pressed"] for topic in topics] == [False, False]
    ros.ask("drive_until", topic="cliff/left", count=2, linear=0.2, seconds=60)
    assert ros.ask("past", topic="cliff/left", count=2)[1] == {"pressed": True}
    ros.ask("drive_until", topic="cliff/left", count=3, linear=-0.2, seconds=60)
    assert ros.ask("past", topic="cliff/left", count=3)[2] == {"pressed": False}
    assert ros.ask("past", topic="cliff/right") == [{"pressed": False}]
