"""What a whole check does, on packages in memory: unknown values, bases, options, comments."""

import pytest

from ur.check.render.pages import FOLDER, check_example
from ur.check.rule import Example, launch_example
from ur.check.session import CheckReport, check_paths
from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import UserError


def rules_of(report: CheckReport) -> list[str]:
    return [found.rule for found in report.findings]


def check(text: str, files: dict[str, str] | None = None) -> CheckReport:
    return check_example(launch_example(text, files))


def test_required_arguments_need_not_be_given() -> None:
    report = check("""
<launch>
  <arg name="robot"/>
  <arg name="again"/>
  <arg name="delay"/>
  <arg name="where"/>
  <rosparam file="$(find my_robot)/params/$(arg robot).yaml"/>
  <node name="$(arg robot)_talker" pkg="demo_nodes" type="talker" respawn="$(arg again)" respawn_delay="$(arg delay)"
    output="$(arg where)"/>
</launch>
""")
    assert rules_of(report) == []


def test_both_branches_of_an_unknown_option_are_checked() -> None:
    report = check("""
<launch>
  <arg name="simulate"/>
  <include file="$(find my_robot)/launch/one.launch" if="$(arg simulate)"/>
  <include file="$(find my_robot)/launch/two.launch" unless="$(arg simulate)"/>
</launch>
""")
    assert rules_of(report) == ["missing-file", "missing-file"]


def test_options_that_exclude_one_another_are_no_duplicates() -> None:
    report = check("""
<launch>
  <arg name="left"/>
  <arg name="right"/>
  <node name="talker" pkg="demo_nodes" type="talker" if="$(arg left)"/>
  <node name="talker" pkg="demo_nodes" type="listener" if="$(arg right)"/>
</launch>
""")
    assert rules_of(report) == []


def test_duplicate_that_no_option_changes_is_found_beside_unknown_ones() -> None:
    report = check("""
<launch>
  <arg name="left"/>
  <group if="$(arg left)"/>
  <node name="talker" pkg="demo_nodes" type="talker"/>
  <node name="talker" pkg="demo_nodes" type="listener"/>
</launch>
""")
    assert rules_of(report) == ["duplicate-node"]


def test_option_that_is_off_is_checked_as_if_it_were_on() -> None:
    report = check("""
<launch>
  <arg name="simulate" default="false"/>
  <include file="$(find my_robot)/launch/simulator.launch" if="$(arg simulate)"/>
</launch>
""")
    assert rules_of(report) == ["missing-file"]
    assert [note.message for note in report.findings[0].notes] == ["with simulate:=true"]


def test_value_that_is_a_number_here_and_a_flag_there_is_left_alone() -> None:
    report = check("""
<launch>
  <arg name="again"/>
  <param name="again" type="int" value="$(arg again)" if="$(arg again)"/>
</launch>
""")
    assert rules_of(report) == []


def test_variable_that_is_not_set_here_may_be_set_elsewhere() -> None:
    report = check("""
<launch>
  <arg name="base" default="$(env ROBOT_BASE)"/>
  <include file="$(find my_robot)/launch/$(arg base).launch"/>
  <param name="loud" type="bool" value="$(env LOUD)"/>
</launch>
""")
    assert rules_of(report) == []


def test_expression_over_unknown_values_is_left_alone_but_its_syntax_is_not() -> None:
    report = check("""
<launch>
  <arg name="count"/>
  <param name="next" value="$(eval count + 1)"/>
  <param name="half" value="$(eval count // )"/>
</launch>
""")
    assert rules_of(report) == ["bad-eval"]


def test_what_is_switched_off_for_good_is_left_alone() -> None:
    report = check("""
<launch>
  <group if="false">
    <node name="talker" pkg="nowhere" type="talker" respaen="$(arg nothing)"/>
    <gruop/>
  </group>
</launch>
""")
    assert rules_of(report) == []


def test_every_base_and_variant_is_checked_and_named() -> None:
    report = check(
        """
<launch>
  <arg name="robot_base"/>
  <arg name="robot_variant" default=""/>
  <rosparam file="$(find my_robot)/params/$(arg robot_base)$(arg robot_variant).yaml"/>
</launch>
""",
        {
            "bases/magni/base.yaml": "summary: m\nvariants:\n  lidar: {height: 1}\n  sonar: {height: 2}\n",
            "bases/stage/base.yaml": "summary: s\n",
            "params/magni.yaml": "a: 1\n",
            "params/magnilidar.yaml": "a: 1\n",
        },
    )
    assert rules_of(report) == ["missing-file"]
    notes = [note.message for note in report.findings[0].notes]
    assert len(notes) == 2
    assert notes[0].startswith("with robot_base:=magni robot_variant:=sonar")
    assert notes[1].startswith("with robot_base:=stage: /ws/my_robot/params/stage.yaml")


def test_given_argument_replaces_the_bases() -> None:
    files = {
        f"{FOLDER}/package.xml": "<package><name>my_robot</name></package>",
        f"{FOLDER}/bases/magni/base.yaml": "summary: m\n",
        f"{FOLDER}/bases/stage/base.yaml": "summary: s\n",
        f"{FOLDER}/a.launch": '<launch><arg name="robot_base"/>'
        '<rosparam file="$(find my_robot)/$(arg robot_base).yaml"/></launch>',
        f"{FOLDER}/magni.yaml": "a: 1\n",
    }
    world = MemoryWorld(files, {"my_robot": FOLDER})
    assert rules_of(check_paths([FOLDER], world)) == ["missing-file"]
    assert rules_of(check_paths([FOLDER], world, None, {"robot_base": "magni"})) == []
    assert rules_of(check_paths([FOLDER], world, None, {"robot_bas": "magni"})) == ["missing-file", "unknown-argument"]


def test_package_that_is_not_there_is_said_once_per_file() -> None:
    report = check("""
<launch>
  <param name="a" value="$(find far_away)/a"/>
  <param name="b" value="$(find far_away)/b"/>
</launch>
""")
    assert rules_of(report) == ["package-not-installed"]
    assert report.findings[0].notes[-1].message == "also in line 3"


def test_node_of_a_package_that_is_elsewhere_is_a_warning() -> None:
    report = check("""
<launch>
  <node name="a" pkg="far_away" type="a"/>
  <node name="b" pkg="far_away" type="b"/>
  <node name="c" pkg="demo_ndoes" type="talker"/>
</launch>
""")
    assert rules_of(report) == ["package-not-installed", "unknown-package"]
    assert report.errors == 1


def test_program_of_a_package_without_any_is_a_warning() -> None:
    report = check("""
<launch>
  <node name="a" pkg="my_robot" type="a"/>
</launch>
""")
    assert rules_of(report) == ["package-not-installed"]


def test_rules_about_conventions_are_silent_in_packages_without_them() -> None:
    report = check("""
<launch>
  <arg name="rate" default="1"/>
  <arg name="word"/>
  <node name="talker" pkg="demo_nodes" type="talker" args="$(arg word) $(arg rate)"/>
</launch>
""")
    assert rules_of(report) == []


def test_comment_hides_a_finding_in_the_element_that_follows_only() -> None:
    report = check("""
<launch>
  <!--ur: ignore missing-executable: it is built on the robot-->
  <node name="one" pkg="demo_nodes" type="nothing"/>
  <node name="two" pkg="demo_nodes" type="nothing"/>
</launch>
""")
    assert [found.span.position.line for found in report.findings if found.span] == [4]
    assert report.suppressed == 1


def test_comment_hides_findings_in_the_whole_file() -> None:
    report = check("""
<launch>
  <!--ur: ignore-file missing-executable, duplicate-node: an example of mistakes-->
  <node name="one" pkg="demo_nodes" type="nothing"/>
  <node name="one" pkg="demo_nodes" type="nothing"/>
</launch>
""")
    assert rules_of(report) == []
    assert report.suppressed == 2  # one node takes part; the second is refused for its name


@pytest.mark.parametrize(
    "text",
    [
        "a: 1\na: 2  # ur: ignore duplicate-key: the second one counts\n",
        "a: 1\n# ur: ignore duplicate-key: the second one counts\na: 2\n",
        "# ur: ignore-file duplicate-key: generated\na: 1\na: 2\n",
    ],
)
def test_comment_in_yaml_hides_a_finding(text: str) -> None:
    report = check_example(Example({"params/a.yaml": text}))
    assert rules_of(report) == []
    assert report.suppressed == 1


def test_include_of_one_package_is_none_of_a_file_of_the_same_name_in_another() -> None:
    part = '<launch>\n  <arg name="speed" default="1"/>\n</launch>\n'
    whole = """<launch>
  <include file="$(find one)/launch/part.launch"><arg name="speed" value="2"/></include>
</launch>
"""
    packages = {"one": "/lab/one", "two": "/lab/two"}
    files = {f"{folder}/package.xml": f"<package><name>{name}</name></package>" for name, folder in packages.items()}
    files |= {f"{folder}/launch/part.launch": part for folder in packages.values()}
    world = MemoryWorld(files=files | {"/lab/two/launch/whole.launch": whole}, packages=packages)
    found = check_paths(["/lab"], world, frozenset({"unused-argument"})).findings
    assert [str(each.span) for each in found] == ["/lab/two/launch/part.launch:2:14"]


def test_single_file_is_checked_with_what_it_includes() -> None:
    files = {
        "/w/main.launch": '<launch>\n<include file="/w/part.launch"/>\n</launch>\n',
        "/w/part.launch": '<launch>\n<param name="a" value="$(arg b)"/>\n</launch>\n',
    }
    report = check_paths(["/w/main.launch"], MemoryWorld(files))
    assert rules_of(report) == ["undeclared-argument"]
    assert report.files == 1
    assert [str(note.span) for note in report.findings[0].notes] == ["/w/main.launch:2:1"]


def test_relative_include_is_found_beside_the_file() -> None:
    files = {
        "/w/main.launch": '<launch>\n<include file="part.launch"/>\n</launch>\n',
        "/w/part.launch": '<launch>\n<param name="a" value="1"/>\n</launch>\n',
    }
    assert rules_of(check_paths(["/w"], MemoryWorld(files))) == []


def test_other_files_of_these_names_are_left_alone() -> None:
    files: dict[str, str | bytes] = {
        "/w/Debug.launch": '<?xml version="1.0"?>\n<launchConfiguration type="c">\n</launchConfiguration>\n',
        "/w/camera.yaml": "%YAML:1.0\nmatrix: !!opencv-matrix\n   rows: 3\n",
        "/w/template.yaml": "name: {{ name }}\n",
        "/w/latin.yaml": b"name: \xe9\n",
        "/w/.hidden/broken.yaml": "[\n",
    }
    assert rules_of(check_paths(["/w"], MemoryWorld(files))) == []


def test_chosen_rules_are_the_only_ones() -> None:
    files = {"/w/a.launch": '<launch>\n<param name="a" value="$(arg b)" c="d"/>\n</launch>\n'}
    world = MemoryWorld(files)
    assert rules_of(check_paths(["/w"], world)) == ["undeclared-argument", "unknown-attribute"]
    assert rules_of(check_paths(["/w"], world, frozenset({"unknown-attribute"}))) == ["unknown-attribute"]


def test_path_that_is_not_there_is_refused_with_a_suggestion() -> None:
    with pytest.raises(UserError) as caught:
        check_paths(["/w/a.lauch"], MemoryWorld({"/w/a.launch": "<launch/>"}))
    assert caught.value.diagnostics[0].help is not None
    assert "a.launch" in caught.value.diagnostics[0].help


def test_file_that_is_too_large_is_reported() -> None:
    report = check_paths(["/w"], MemoryWorld({"/w/a.launch": b" " * 9_000_000}))
    assert rules_of(report) == ["file-too-large"]
