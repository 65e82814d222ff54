"""The doctor's rules about ROS 2: silent on a healthy pair, one finding for each seeded fault, with its fix."""

from dataclasses import replace

import pytest
from tests.robot.doctor.rules.ros2.cases import (
    CASES,
    DOMAIN,
    GRAPH,
    HERE,
    JAZZY,
    LOOSE,
    ROS2_PAIR,
    RUNNING,
    SCAN,
    THERE,
    TOOLS,
    TWIST,
    both,
    graph,
    local,
    process,
    remote,
    scans,
    topics,
)

from ur.robot.doctor.findings import ComputerPair, Finding
from ur.robot.doctor.rules import diagnose, diagnose_alone
from ur.robot.ros2.seen_graph import End, Qos, Received, Ros2, SeenTopic


def the_finding(pair: ComputerPair) -> Finding:
    (finding,) = diagnose(pair)
    return finding


@pytest.mark.parametrize(("rule", "pair"), CASES)
def test_seeded_fault_is_named_with_its_fix(rule: str, pair: ComputerPair) -> None:
    finding = the_finding(pair)
    assert finding.rule == rule
    assert finding.help or finding.commands


def test_at_least_twenty_kinds_of_faults_are_seeded() -> None:
    assert len({rule for rule, _ in CASES}) >= 20


@pytest.mark.parametrize(
    "pair",
    [
        ROS2_PAIR,
        replace(ROS2_PAIR, local=replace(HERE, ros2=Ros2())),  # a laptop without any ROS
        replace(ROS2_PAIR, selected=False, local=replace(HERE, ros2=replace(TOOLS, called={}, shell={}))),
        remote(graph=None),  # nothing runs yet
        topics(
            SeenTopic("/scan", (), (End("/web_vm_20812", SCAN), End("/rviz2", SCAN)))
        ),  # likewise, and it is watched
        local({"ROS_STATIC_PEERS": "bob.local"}, receives=False),
        both({"ROS_DISCOVERY_SERVER": "127.0.0.1:11811"}, (11811,), mine={"ROS_DISCOVERY_SERVER": "bob.local:11811"}),
        scans(LOOSE, LOOSE),
        scans(Qos(latched=True), LOOSE),
        scans(Qos(deadline=0.1, lease=1.0, manual=True), Qos(deadline=0.5, lease=2.0)),
        graph(charge={"/battery_state": 80.0}),  # in percent
        graph(simulated={}, scans={"/scan": Received(5)}),
        topics(
            SeenTopic("/cmd_vel", (End("/cmd_vel_mux", TWIST),), (End("/base", TWIST),)), SeenTopic("/teleop/cmd_vel")
        ),
        remote(processes=(process("jazzy"), process("kilted"), process("iron"))),  # as the firmware of a Create 3
        remote(forgotten=("eve",)),  # whose units are none of ROS 2
        both({"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"}, forgotten=("ros",)),  # which uses no shared memory
    ],
)
def test_healthy_ros2_pair_has_no_findings(pair: ComputerPair) -> None:
    assert diagnose(pair) == []


def test_ros2_computer_alone_is_judged_without_rules_of_ros1() -> None:
    alone = replace(THERE, resolves=frozenset(), loss=None, full_frames=None)
    assert diagnose_alone(alone) == []
    twice = replace(GRAPH, nodes=("/base", "/base"))
    (finding,) = diagnose_alone(replace(alone, ros2=replace(RUNNING, graph=twice)))
    assert finding.rule == "ros2-same-name"


def test_computer_of_a_person_may_have_nodes_in_two_domains() -> None:
    nodes = (process(unit=""), process(unit=""), process(unit="", ROS_DOMAIN_ID="61"))
    assert diagnose_alone(replace(THERE, ros2=replace(RUNNING, processes=nodes))) == []


def test_both_nodes_of_a_pair_that_never_matches_are_named() -> None:
    message = the_finding(scans(LOOSE, Qos())).message
    assert "/slam never receives from /lidar" in message
    assert "asks for reliable, and best effort is offered" in message


def test_fix_of_a_stray_domain_changes_the_unit_of_that_process() -> None:
    pair = remote(processes=(process(), process(), process(unit="lidar.service", ROS_DOMAIN_ID="0")))
    (command,) = the_finding(pair).commands
    assert (command.where, command.root, command.safe) == ("remote", True, False)
    assert "/etc/systemd/system/lidar.service.d/ros2.conf" in command.line
    assert "ROS_DOMAIN_ID=7" in command.line


def test_parameter_is_set_in_the_domain_of_the_robot() -> None:
    command = the_finding(graph(simulated={"/slam": True})).commands[0]
    assert "/opt/ros/jazzy/setup.bash" in command.line
    assert "ROS_DOMAIN_ID=7 ros2 param set /slam use_sim_time false" in command.line


def test_settings_of_this_shell_follow_the_robot() -> None:
    for pair, line in (
        (local({"ROS_DOMAIN_ID": "0"}), "export ROS_DOMAIN_ID=7"),
        (local({"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"}), "export RMW_IMPLEMENTATION=rmw_fastrtps_cpp"),
        (local(receives=False), "export ROS_STATIC_PEERS=bob.local"),
        (both({"ROS_DISCOVERY_SERVER": "127.0.0.1:11811"}, (11811,), mine={}), "ROS_DISCOVERY_SERVER=bob.local:11811"),
    ):
        assert line in the_finding(pair).commands[0].line


def test_file_that_sets_a_variable_is_named() -> None:
    settings = (("~/.bashrc", "ROS_DOMAIN_ID"),)
    assert "~/.bashrc" in the_finding(local({"ROS_DOMAIN_ID": "0"}, settings=settings)).help


def test_names_from_the_graph_are_quoted_in_commands() -> None:
    evil = "/x; reboot"
    command = the_finding(graph(simulated={evil: True})).commands[0]
    assert "; reboot" not in command.line.replace("/x; reboot'", "")
    assert JAZZY.folder in command.line
    assert DOMAIN["ROS_DOMAIN_ID"] in command.line
