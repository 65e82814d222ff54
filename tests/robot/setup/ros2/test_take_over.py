"""The remap of a base's driver: the unit's command with other topics, or the reason why there is none."""

import pytest

from ur.robot.robot_file import Ros2Robot
from ur.robot.ros2.seen_graph import End, Process, Ros2, SeenGraph, SeenTopic
from ur.robot.setup.ros2.take_over import (
    LAUNCH_FILE,
    Driver,
    TakeOver,
    find_driver,
    list_topics,
    mux_unit,
    plan_take_over,
    read_starts,
)

TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
NODE = "python3 /opt/base.py --ros-args -r __ns:=/robot1"
UNIT = "/etc/systemd/system/base.service"
DROP_IN = f"{UNIT}.d/50-ubiquity.conf"


def taken(name: str, kind: str, *nodes: str) -> SeenTopic:
    return SeenTopic(name, (), tuple(End(node, kind) for node in nodes))


def process(unit: str, argv: str = NODE) -> Process:
    return Process(7, "ros", argv, "jazzy", unit)


def driver(argv: str = NODE, *topics: str) -> Driver:
    return Driver("base.service", (argv,), dict.fromkeys(topics or ("/cmd_vel",), TWIST))


def start_of(plan: TakeOver | str) -> str:
    assert isinstance(plan, TakeOver), plan
    return read_starts(plan.files[DROP_IN])[-1]


@pytest.mark.parametrize(
    ("argv", "before", "after"),
    [
        (
            NODE,
            f"/bin/bash -c '. /opt/ros/jazzy/setup.bash && exec {NODE}'",
            f"/bin/bash -c '. /opt/ros/jazzy/setup.bash && exec {NODE} --ros-args -r /cmd_vel:=/cmd_vel_base'",
        ),
        ("/opt/base", "/opt/base", "/opt/base --ros-args -r /cmd_vel:=/cmd_vel_base"),
        (
            "/opt/base --ros-args -r /cmd_vel:=/cmd_vel_base",
            "/opt/base",
            "/opt/base --ros-args -r /cmd_vel:=/cmd_vel_base",
        ),
        (
            "/opt/ros/jazzy/lib/base/base",
            'bash -c "ros2 run base base --port 1"',
            'bash -c "ros2 run base base --port 1 --ros-args -r /cmd_vel:=/cmd_vel_base"',
        ),
        ("x", "bash -c 'ros2 launch base up.launch.py a:=b'", f"bash -c 'ros2 launch {LAUNCH_FILE} a:=b'"),
        ("x", "bash -c 'ros2 launch /opt/up.launch.xml'", f"bash -c 'ros2 launch {LAUNCH_FILE}'"),
    ],
)
def test_command_of_the_unit_gives_the_base_another_topic(argv: str, before: str, after: str) -> None:
    assert start_of(plan_take_over(driver(argv), {UNIT: f"[Service]\nExecStart={before}\n"})) == after


def test_second_plan_is_the_same_as_the_first_one() -> None:
    texts = {UNIT: f"[Service]\nExecStart={NODE}\n"}
    plan = plan_take_over(driver(), texts)
    assert isinstance(plan, TakeOver)
    assert plan_take_over(driver(), {**texts, DROP_IN: plan.files[DROP_IN]}) == plan


def test_launch_file_is_included_by_one_that_remaps() -> None:
    plan = plan_take_over(driver("x", "/a", "/b"), {UNIT: "ExecStart=bash -c 'ros2 launch base up.launch.py'\n"})
    assert isinstance(plan, TakeOver)
    text = plan.files[LAUNCH_FILE]
    compile(text, LAUNCH_FILE, "exec")
    assert "REMAPS = {'/a': '/a_base', '/b': '/b_base'}" in text
    assert "get_share_file_path_from_package(package_name='base', file_name='up.launch.py')" in text


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("ExecStart=/usr/local/bin/start-robot\n", "shows neither its node nor a launch file"),
        ("ExecStart=a\nExecStart=b\n", "has 2 lines ExecStart="),
        ("", "has 0 lines ExecStart="),
    ],
)
def test_unit_that_cannot_be_remapped_is_named_with_the_reason(text: str, reason: str) -> None:
    plan = plan_take_over(driver(), {UNIT: text})
    assert isinstance(plan, str)
    assert reason in plan
    assert "base.service" in plan


def test_command_over_several_lines_is_one() -> None:
    assert read_starts("[Service]\nExecStart=\nExecStart=a \\\n  b\nExecStartPre=c\n") == ["a    b"]


GRAPH = SeenGraph(
    topics=(
        taken("/cmd_vel", TWIST, "/base", "/cmd_vel_mux"),
        taken("/cmd_vel_stamped", STAMPED, "/base"),
        taken("/cmd_vel_nav", TWIST, "/smoother"),
    )
)


def test_all_velocity_topics_of_the_base_are_found() -> None:
    assert list_topics(GRAPH, "/cmd_vel") == {"/cmd_vel": TWIST, "/cmd_vel_stamped": STAMPED}


def test_topics_that_were_taken_over_keep_the_names_of_programs() -> None:
    graph = SeenGraph(topics=(taken("/cmd_vel", TWIST, "/cmd_vel_mux"), taken("/cmd_vel_base", TWIST, "/base")))
    found = find_driver(Ros2(processes=(process("base.service"),), graph=graph), "/cmd_vel_base")
    assert (found.unit, found.topics) == ("base.service", {"/cmd_vel": TWIST})


@pytest.mark.parametrize(
    ("processes", "unit", "reason"),
    [
        ((process("base.service"), process(""), process("ubiquity-web.service")), "base.service", ""),
        ((process("lidar.service", "lidar"), process("b.service", "b -r __node:=base")), "b.service", ""),
        ((process("lidar.service"), process("b.service")), "", "its driver is one of b.service, lidar.service"),
        ((process(""),), "", "no unit of the system runs its driver"),
    ],
)
def test_unit_of_the_driver_is_found_or_the_reason_is_given(
    processes: tuple[Process, ...], unit: str, reason: str
) -> None:
    found = find_driver(Ros2(processes=processes, graph=GRAPH), "/cmd_vel")
    assert (found.unit, found.reason) == (unit, reason)
    if not unit:
        assert plan_take_over(found, {}) == reason


def test_mux_takes_over_the_topic_that_programs_know() -> None:
    text = mux_unit("bob", "stage", "", Ros2Robot("jazzy", commands="/cmd_vel_base"), "ros", "/home/ros").text
    assert "takes_over:=/cmd_vel;" in text
    assert "cmd_vel:=/cmd_vel_base" in text
    assert "ubiquity-master" not in text
