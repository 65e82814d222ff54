"""The drivers of a real base give what the simulated one gives: compared in the plans of m_robot_base."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import pytest
from tests.base_contract import EVERY, PACKAGE, list_frames, list_topics, load

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.world.system import SystemWorld
from ur.robot.base import Base

# What upstream's programs publish, by the names in their sources (package, executable).
PUBLISHED: dict[tuple[str, str], dict[str, str]] = {
    ("ubiquity_motor", "motor_node"): {
        "ubiquity_velocity_controller/odom": "nav_msgs/Odometry",
        "joint_states": "sensor_msgs/JointState",
        "battery_state": "sensor_msgs/BatteryState",
    },
    ("loki_base_node", "bus_server.py"): {"odom": "nav_msgs/Odometry", "/sonars": "sensor_msgs/Range"},
    ("neato_node", "neato.py"): {"odom": "nav_msgs/Odometry", "base_scan": "sensor_msgs/LaserScan"},
    ("stage_ros", "stageros"): {"odom": "nav_msgs/Odometry", "base_scan": "sensor_msgs/LaserScan"},
    ("pi_sonar", "pi_sonar"): {"/sonars": "sensor_msgs/Range"},
    ("rplidar_ros", "rplidarNode"): {"scan": "sensor_msgs/LaserScan"},
    ("ubiquity_launches", "lidar_driver"): {"scan": "sensor_msgs/LaserScan"},
    ("ubiquity_launches", "sonar_driver"): {"sonars": "sensor_msgs/Range"},
    ("ubiquity_launches", "base_driver"): {
        "odom": "nav_msgs/Odometry",
        "joint_states": "sensor_msgs/JointState",
        "battery_state": "sensor_msgs/BatteryState",
        **{f"bumper/{name}": "std_msgs/Bool" for name in ("left", "right")},
        **{f"bumper/{side}_{end}": "std_msgs/Bool" for side in ("left", "right") for end in ("front", "side")},
        **{f"cliff/{name}": "std_msgs/Bool" for name in ("left", "front_left", "front_right", "right")},
    },
    ("ubiquity_launches", "raspicam_node"): {
        "~image": "sensor_msgs/Image",
        "~image/compressed": "sensor_msgs/CompressedImage",
        "~camera_info": "sensor_msgs/CameraInfo",
    },
}
# What drivers do not give: each is told in the Overview of m_<base>_drivers.
LEFT_OUT = {
    "magni": set[str](),
    "loki": {"battery_state"},
    "botvac": set[str](),
    "create2": set[str](),
    "stage": {"battery_state", "bumpers", "camera", "imu/data"},
}
LEFT_OUT_UPSTREAM = LEFT_OUT | {"botvac": {"battery_state", "cliffs"}}
UPSTREAM = [each for each in EVERY if each[0] in ("magni", "botvac", "loki")]


def make_plan(base: Base, **values: str) -> Plan:
    words = [f"robot_base:={base.name}", *([f"robot_variant:={base.variant}"] if base.variant else [])]
    words += [f"{name}:={value}" for name, value in values.items()]
    world = SystemWorld({"ROS_PACKAGE_PATH": str(PACKAGE)})
    plan = load_plan([str(PACKAGE / "m_robot_base" / "launch" / "m_robot_base.launch.xml")], words, world)
    assert plan.diagnostics == ()
    return plan


def params_of(plan: Plan, prefix: str) -> dict[str, Any]:
    return {param.name.removeprefix(prefix): param.value for param in plan.params if param.name.startswith(prefix)}


def resolve(name: str, node: NodeSpec) -> str:
    """The full name of a topic, after the node's remappings."""

    def absolute(each: str) -> str:
        if each.startswith("~"):
            return f"{node.full_name}/{each[1:]}"
        return each if each.startswith("/") else node.namespace + each

    remaps = {absolute(source): absolute(target) for source, target in node.remaps}
    return remaps.get(absolute(name), absolute(name))


def topics_of(plan: Plan, base: Base) -> dict[str, str]:
    topics: dict[str, str] = {}
    for node in plan.nodes:
        for name, kind in PUBLISHED.get((node.package, node.type), {}).items():
            topics[resolve(name, node)] = kind
        if node.type == "driver_adapter":
            own = params_of(plan, f"{node.full_name}/")
            topics["/joint_states"] = "sensor_msgs/JointState"
            if own["rename_scan"] and base.lidar:
                topics[f"/{base.lidar.topic}"] = "sensor_msgs/LaserScan"
            if own["bumper_messages"] and base.bumpers:
                topics |= {f"/{base.bumpers.topic}/{each.name}": "std_msgs/Bool" for each in base.bumpers.at}
        if node.type == "base_driver" and base.lidar and not any(each.part == "lidar" for each in base.drivers):
            topics[f"/{base.lidar.topic}"] = "sensor_msgs/LaserScan"
        if node.type == "base_driver" and base.sonars and not any(each.part == "sonars" for each in base.drivers):
            topics[f"/{base.sonars.topic}"] = "sensor_msgs/Range"
    return topics


def left_out(base: Base, words: set[str]) -> set[str]:
    """The topics of the contract that the base's drivers do not give."""
    topics = {f"/{word}" for word in words}
    if base.bumpers and "bumpers" in words:
        topics |= {f"/{base.bumpers.topic}/{bumper.name}" for bumper in base.bumpers.at}
    if base.cliffs and "cliffs" in words:
        topics |= {f"/{base.cliffs.topic}/{cliff.name}" for cliff in base.cliffs.at}
    if base.raspicam and "camera" in words:
        topics |= {topic for topic in list_topics(base) if topic.startswith(f"/{base.raspicam.name}/")}
    return topics


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_drivers_publish_what_the_simulated_base_publishes(name: str, variant: str) -> None:
    base = load(name, variant)
    given = topics_of(make_plan(base, simulate="false"), base)
    missing = left_out(base, LEFT_OUT[name])
    expected = {topic: kind for topic, kind in list_topics(base).items() if topic not in missing}
    assert {topic: given.get(topic) for topic in expected} == expected


@pytest.mark.parametrize(("name", "variant"), UPSTREAM)
def test_upstreams_drivers_publish_it_too_where_they_are_asked_for(name: str, variant: str) -> None:
    base = load(name, variant)
    plan = make_plan(base, simulate="false", upstream_drivers="true")
    assert not any(node.type in ("base_driver", "lidar_driver", "sonar_driver") for node in plan.nodes)
    missing = left_out(base, LEFT_OUT_UPSTREAM[name])
    given = topics_of(plan, base)
    expected = {topic: kind for topic, kind in list_topics(base).items() if topic not in missing}
    assert {topic: given.get(topic) for topic in expected} == expected
    command = "ubiquity_velocity_controller/cmd_vel" if name == "magni" else "cmd_vel"
    node = next(node for node in plan.nodes if node.type in ("motor_node", "neato.py", "bus_server.py"))
    assert resolve(command, node) == "/cmd_vel"


@pytest.mark.parametrize("name", sorted(LEFT_OUT))
def test_what_a_driver_leaves_out_is_documented(name: str) -> None:
    text = (PACKAGE / f"m_{name}_drivers" / "launch" / f"m_{name}_drivers.launch.xml").read_text(encoding="utf-8")
    overview = re.sub(r"\s+", " ", text.split("<!--Overview:")[1].split("-->")[0])
    for word in LEFT_OUT_UPSTREAM[name]:
        assert word in overview


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_real_and_simulated_base_listen_and_describe_themselves_alike(name: str, variant: str) -> None:
    base = load(name, variant)
    real, simulated = make_plan(base, simulate="false"), make_plan(base)
    shared = {"cmd_vel_mux", "robot_state_publisher", "black_box"}
    for plan in (real, simulated):
        assert shared <= {node.name for node in plan.nodes}
    described = [
        next(each.value for each in plan.params if each.name == "/robot_description") for plan in (real, simulated)
    ]
    assert described[0] == described[1]
    driver = base.driver
    assert driver is not None
    node = next(node for node in real.nodes if (node.package, node.type) == (driver.package, driver.executable))
    assert resolve("cmd_vel", node) == "/cmd_vel"


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_drivers_speak_in_frames_of_the_base(name: str, variant: str) -> None:
    base = load(name, variant)
    plan = make_plan(base, simulate="false", upstream_drivers=str((name, variant) in UPSTREAM).lower())
    frames = [
        each.value
        for each in plan.params
        if re.search(r"(/frame_id|/base_frame|/base_frame_id|/odom_frame_id|/camera_frame_id)$", each.name)
    ]
    assert frames or name in ("stage", "create2")  # drivers of ours read the frames from the base file
    assert set(frames) <= list_frames(base)
    for node in plan.nodes:
        if node.type == "rplidarNode" or node.type == "neato.py":
            assert base.lidar
            assert params_of(plan, f"{node.full_name}/")["frame_id"] == base.lidar.frame
        if node.type == "raspicam_node":
            assert base.raspicam
            assert params_of(plan, f"{node.full_name}/")["camera_frame_id"] == base.raspicam.frame


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_devices_of_drivers_are_those_of_the_base(name: str, variant: str) -> None:
    base = load(name, variant)
    values = [each.value for each in make_plan(base, simulate="false").params]
    for driver in (base.driver, *base.drivers):
        assert driver
        assert (PACKAGE / driver.node / "launch" / f"{driver.node}.launch.xml").is_file()
        if driver.device and not driver.protocol:
            assert driver.device in values
        if driver.baud and not driver.protocol:
            assert driver.baud in values


def test_motor_board_of_magni_is_told_the_figures_of_its_base() -> None:
    base = load("magni", "")
    plan = make_plan(base, simulate="false", upstream_drivers="true")
    own = params_of(plan, "/ubiquity_velocity_controller/")
    limits = base.limits
    assert own["wheel_separation"] == base.wheels.separation
    assert own["wheel_radius"] == base.wheels.radius
    assert own["cmd_vel_timeout"] == limits.command_age
    assert own["linear/x/max_velocity"] == limits.velocity
    assert own["angular/z/max_velocity"] == limits.angular_velocity
    # One figure for both directions: it must not keep the base from braking.
    assert own["linear/x/max_acceleration"] == limits.deceleration
    assert own["angular/z/max_acceleration"] == limits.angular_deceleration


def test_board_of_loki_is_told_the_figures_of_its_base() -> None:
    base = load("loki", "")
    assert base.sonars
    own = params_of(make_plan(base, simulate="false", upstream_drivers="true"), "/bus_server/")
    assert own["wheel_diameter"] == 2 * base.wheels.radius
    assert own["wheel_spread"] == base.wheels.separation
    assert own["encoder_resolution"] == base.odometry.ticks_per_turn
    for number, sonar in enumerate(base.sonars.at):
        assert own[f"sensors/{sonar.frame}/frame_id"] == sonar.frame
        assert own[f"sensors/{sonar.frame}/id"] == number + 2
        assert own[f"sensors/{sonar.frame}/field_of_view"] == base.sonars.field_of_view
        assert own[f"sensors/{sonar.frame}/max_range"] == base.sonars.range_max
    ids = {own[f"sensors/{sonar.frame}/id"] for sonar in base.sonars.at}
    for sonar in base.sonars.at:  # neighbours know each other
        mine, left = own[f"sensors/{sonar.frame}/id"], own[f"sensors/{sonar.frame}/left_id"]
        assert left in ids
        other = next(each.frame for each in base.sonars.at if own[f"sensors/{each.frame}/id"] == left)
        assert own[f"sensors/{other}/right_id"] == mine


def test_sonars_of_magni_have_the_frames_that_pi_sonar_gives_them() -> None:
    base = load("magni", "")
    assert base.sonars
    assert [sonar.frame for sonar in base.sonars.at] == [f"sonar_{number}" for number in range(5)]
    own = params_of(make_plan(base, simulate="false", upstream_drivers="true"), "/pi_sonar/")
    assert own == {
        "field_of_view": base.sonars.field_of_view,
        "min_range": base.sonars.range_min,
        "max_range": base.sonars.range_max,
    }


def test_simulator_stands_for_the_sonars_of_magni_and_for_the_board_of_loki() -> None:
    for name, types in (("magni", {"base_driver"}), ("loki", {"base_driver"})):
        plan = make_plan(load(name, ""), simulate="devices")
        assert {node.type for node in plan.nodes if node.type.endswith("_driver")} == types


def test_bumpers_of_botvac_have_all_of_upstreams_names() -> None:
    base = load("botvac", "")
    assert base.bumpers
    plan = make_plan(base, simulate="false", upstream_drivers="true")
    own = params_of(plan, "/driver_adapter/bumper_names/")
    assert set(own) == {"Left_Side_Bumper", "Right_Side_Bumper", "Left_Bumper", "Right_Bumper"}
    assert sorted(own.values()) == sorted(bumper.name for bumper in base.bumpers.at)


@pytest.mark.parametrize("world", ["maze", "office"])
def test_worlds_of_stage_lie_where_their_maps_lie_and_hold_the_base(world: str) -> None:
    from PIL import Image

    from ur.worlds.map_file import read_map

    base = load("stage", "")
    path = PACKAGE / "n_stage_ros" / "worlds" / f"stage.{world}.world"
    text = path.read_text(encoding="utf-8")
    plan = read_map(PACKAGE / "n_map_server" / "maps" / f"{world}.yaml")
    picture = Path(path.parent, re.findall(r'bitmap "(.*)"', text)[0])
    with Image.open(picture) as image:
        assert image.size == plan.shape[::-1]
    rows, columns = plan.shape
    sizes = [numbers(each) for each in re.findall(r"size \[(.*?)\]", text)]
    poses = [numbers(each) for each in re.findall(r"pose \[(.*?)\]", text)]
    width, height = columns * plan.resolution, rows * plan.resolution
    assert sizes[1][:2] == pytest.approx([width, height])
    assert poses[0][:2] == pytest.approx([plan.origin[0] + width / 2, plan.origin[1] + height / 2])
    xs, ys = zip(*base.footprint, strict=True)
    assert sizes[2] == pytest.approx([max(xs) - min(xs), max(ys) - min(ys), base.height])
    limits = base.limits
    assert numbers(re.findall(r"velocity_bounds \[(.*?)\]", text)[0])[1] == limits.velocity


def numbers(text: str) -> list[float]:
    return [float(ast.literal_eval(each)) for each in text.split()]
