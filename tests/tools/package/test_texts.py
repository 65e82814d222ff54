"""package.xml and CMakeLists.txt as texts."""

from ur.tools.package.cmake import choose_folders, describe_changes, put_block, write_block
from ur.tools.package.uses import add_run_dependencies, read_optional, read_run_dependencies

MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>p</name>
  <!-- <exec_depend>old</exec_depend> -->
  <buildtool_depend>catkin</buildtool_depend>
    <exec_depend>rviz</exec_depend>  <!-- to see -->
  <depend>rospy</depend>
  <export/>
  <!--ur: optional driver_a driver_b: hardware-->
</package>
"""


def test_run_dependencies_are_read_without_comments() -> None:
    assert read_run_dependencies(MANIFEST) == {"rviz", "rospy"}
    assert read_optional(MANIFEST) == {"driver_a", "driver_b"}


def test_missing_dependencies_follow_the_last_and_nothing_else_changes() -> None:
    added = add_run_dependencies(MANIFEST, ["amcl", "rviz", "driver_a", "map_server"])
    assert added == MANIFEST.replace(
        "  <depend>rospy</depend>\n",
        "  <depend>rospy</depend>\n  <exec_depend>amcl</exec_depend>\n  <exec_depend>map_server</exec_depend>\n",
    )
    assert add_run_dependencies(added, ["amcl"]) == added


def test_package_without_dependencies_gets_them_before_its_end() -> None:
    text = '<package format="2">\n  <name>p</name>\n</package>\n'
    assert add_run_dependencies(text, ["amcl"]) == text.replace("</pack", "  <exec_depend>amcl</exec_depend>\n</pack")


def test_package_of_format_1_has_another_tag() -> None:
    assert "<run_depend>amcl</run_depend>" in add_run_dependencies(
        "<package>\n  <name>p</name>\n</package>\n", ["amcl"]
    )


def test_block_is_put_at_the_end_and_then_replaced() -> None:
    start = "project(p NONE)\ncatkin_package()\n"
    first = put_block(start, write_block(["bin", "n_a"], ["x.launch"]))
    assert first.startswith(start)
    assert "install(DIRECTORY\n  bin\n  n_a\n" in first
    assert "install(FILES\n  x.launch\n" in first
    assert put_block(first, write_block(["bin", "n_a"], ["x.launch"])) == first
    former = first.replace("ur check --package --fix", "ur package --write")  # until version 0.1
    assert put_block(former, write_block(["bin", "n_a"], ["x.launch"])) == first
    assert put_block(first + "# mine\n", write_block(["n_b"])) == start + "\n" + write_block(["n_b"]) + "# mine\n"


def test_folders_of_sources_and_tests_are_not_installed() -> None:
    assert choose_folders(["n_a", "src", "tests", ".git", "bin", "include"]) == ("bin", "n_a")


def test_changes_of_install_rules_name_each_folder_and_file() -> None:
    before = put_block("project(p)\n", write_block(["bin", "old"]))
    after = put_block(before, write_block(["bin", "n_wander"], ["drive.launch"]))
    assert describe_changes(before, after) == (
        "drive.launch is not installed",
        "n_wander is not installed",
        "old is installed and does not exist",
    )
    assert describe_changes(after, after) == ()
