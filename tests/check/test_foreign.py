"""Launch files of other people's robots: what is true only where a file is included, or not on this computer."""

from ur.check.queries.executables import is_misspelt
from ur.check.render.pages import FOLDER, check_example
from ur.check.render.text import render_text
from ur.check.rule import Example
from ur.check.session import CheckReport, check_paths
from ur.launchfile.world import MemoryWorld

NODE = '<node name="talker" pkg="demo_nodes" type="talker"{}/>'
INCLUDE = '<include file="$(find my_robot)/launch/part.launch">{}</include>'


def check(**files: str) -> CheckReport:
    return check_example(Example({f"launch/{name}.launch": f"<launch>{text}</launch>" for name, text in files.items()}))


def rules_of(report: CheckReport) -> list[str]:
    return [found.rule for found in report.findings]


def test_machine_of_a_fragment_is_judged_where_the_fragment_is_included() -> None:
    machine = '<machine name="base" address="base.local"/>'
    part = NODE.format(' machine="base"')
    assert rules_of(check(part=part, robot=machine + INCLUDE.format(""))) == []
    assert rules_of(check(part=part, robot=INCLUDE.format(""))) == ["unknown-machine"]
    assert rules_of(check(part=part)) == ["unknown-machine"]


def test_fragment_is_judged_by_files_of_its_package_that_are_not_checked() -> None:
    files = {
        f"{FOLDER}/package.xml": "<package><name>my_robot</name></package>",
        f"{FOLDER}/launch/part.launch": "<launch>" + NODE.format(' machine="base"') + "</launch>",
        f"{FOLDER}/robots/robot.xml": f"<launch>{INCLUDE.format('')}</launch>",
        "/opt/demo_nodes/package.xml": "<package><name>demo_nodes</name></package>",
        "/opt/demo_nodes/talker": "",
    }
    world = MemoryWorld(
        files, {"my_robot": FOLDER, "demo_nodes": "/opt/demo_nodes"}, executables=("/opt/demo_nodes/talker",)
    )
    assert rules_of(check_paths([f"{FOLDER}/launch/part.launch"], world)) == []


def test_machine_may_be_defined_in_a_file_that_is_not_known() -> None:
    unknown = '<include file="$(find far_away)/$(env ROBOT).machine"/>'
    assert "unknown-machine" not in rules_of(check(robot=unknown + NODE.format(' machine="base"')))


def test_path_that_is_empty_by_default_is_given_by_whoever_uses_the_file() -> None:
    assert rules_of(check(part='<arg name="file" default=""/><rosparam file="$(arg file)"/>')) == []
    assert rules_of(check(part='<rosparam file=""/>')) == ["missing-file"]


def test_namespace_that_is_empty_by_default_is_given_by_whoever_uses_the_file() -> None:
    group = '<arg name="robot" default=""/><group ns="{}"><param name="a" value="$(arg robot)"/></group>'
    assert rules_of(check(part=group.format("$(arg robot)"))) == []
    assert rules_of(check(part=group.format(""))) == ["empty-namespace"]


def test_default_that_every_includer_replaces_is_not_judged() -> None:
    part = '<arg name="robot" default="none"/><rosparam file="$(find my_robot)/params/$(arg robot).yaml"/>'
    assert rules_of(check(part=part)) == ["missing-file"]
    passing = '<arg name="name"/>' + INCLUDE.format('<arg name="robot" value="$(arg name)"/>')
    assert rules_of(check(part=part, robot=passing)) == []


def test_value_that_an_includer_passes_is_judged_in_the_included_file() -> None:
    part = '<arg name="robot" default="none"/><rosparam file="$(find my_robot)/params/$(arg robot).yaml"/>'
    report = check(part=part, robot=INCLUDE.format('<arg name="robot" value="magni"/>'))
    assert rules_of(report) == ["missing-file"]
    assert report.findings[0].subject.endswith("/params/magni.yaml")


def test_default_of_a_variable_that_is_not_set_is_not_judged() -> None:
    text = '<rosparam file="$(find my_robot)/params/$(optenv ROBOT no_robot).yaml"/>'
    assert rules_of(check(robot=text)) == []


def test_path_of_another_computer_is_not_judged() -> None:
    assert rules_of(check(robot='<rosparam file="/etc/ros/robot.yaml"/>')) == []


def test_argument_that_an_includer_passes_is_needed_though_nothing_uses_it() -> None:
    part = '<arg name="speed" default="1"/>'
    assert rules_of(check(part=part)) == ["unused-argument"]
    assert rules_of(check(part=part, robot=INCLUDE.format('<arg name="speed" value="2"/>'))) == []


def test_options_that_are_not_meant_to_be_on_together_declare_an_argument_twice() -> None:
    text = (
        '<arg name="laser" default="false"/><arg name="camera" default="true"/>'
        '<arg name="sensor" value="laser" if="$(arg laser)"/><arg name="sensor" value="camera" if="$(arg camera)"/>'
        '<param name="sensor" value="$(arg sensor)"/>'
    )
    assert rules_of(check(robot=text)) == []
    assert rules_of(check(robot=text.replace("false", "true"))) == ["duplicate-arg"]


def test_anonymous_node_of_a_file_that_is_included_twice_has_two_names() -> None:
    part = NODE.replace('"talker"', '"$(anon talker)"', 1).format("")
    assert rules_of(check(part=part, robot=INCLUDE.format("") * 2)) == []


def test_argument_that_begins_with_a_digit_is_declared() -> None:
    text = '<arg name="3d_sensor"/>' + INCLUDE.format('<arg name="sensor" value="$(arg 3d_sensor)"/>')
    assert rules_of(check(part='<arg name="sensor"/><param name="s" value="$(arg sensor)"/>', robot=text)) == []


def test_program_that_is_built_together_with_its_test_exists() -> None:
    files = {
        "CMakeLists.txt": "project(my_robot)\ncatkin_add_executable_with_gtest(${PROJECT_NAME}_node test/node.cpp)\n",
        "launch/robot.launch": '<launch><node name="n" pkg="my_robot" type="my_robot_node"/></launch>',
    }
    assert rules_of(check_example(Example(files))) == []


def test_packages_that_are_not_installed_are_one_paragraph() -> None:
    far = '<node name="{0}" pkg="{0}" type="x"/><param name="{0}/y" value="$(find {0})/y"/>'
    report = check(a=far.format("far_away") + far.format("elsewhere"), b=far.format("far_away"))
    assert render_text(report).splitlines() == [
        "2 packages are not installed or not built here; what 2 files take from there is not checked:",
        "  elsewhere, far_away",
        "  help: 'ur get --missing FOLDER' gets them; of packages built here: source their setup.bash",
        "nothing else found in 2 files",
    ]
    assert report.errors == 0
    assert {found.subject for found in report.findings} == {"elsewhere", "far_away"}


def test_names_that_differ_in_a_number_or_a_word_are_not_misspelt() -> None:
    assert is_misspelt("tutlebot_bringup", "turtlebot_bringup")
    assert is_misspelt("myrobot_bringup", "my_robot_bringup")
    assert not is_misspelt("openni_launch", "openni2_launch")
    assert not is_misspelt("tiago_controller_configuration", "tiago_controller_configuration_gazebo")
    assert not is_misspelt("joy", "jog")
