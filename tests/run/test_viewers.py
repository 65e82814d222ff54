"""Windows where there is no display, and viewers that are not installed: left out, with a line that says why."""

from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import NodeSpec
from ur.launchfile.world import World
from ur.launchfile.world.memory import MemoryWorld
from ur.run.process.command import describe_install, is_packaged
from ur.run.startup.node_selection import check_display, leave_out_viewers
from ur.source.diagnostic import UserError

LAUNCH = """<launch>
  <node name="map" pkg="rviz" type="rviz"/>
  <node name="camera" pkg="image_view" type="image_view"/>
  <node name="talker" pkg="talk" type="talker"/>
</launch>
"""
DISPLAY = {"DISPLAY": ":0"}


def make_world(*packages: str) -> tuple[tuple[NodeSpec, ...], World]:
    programs = {"rviz": "rviz", "image_view": "image_view", "talk": "talker"}
    paths = {f"/{name}/{programs[name]}": "" for name in packages}
    world = MemoryWorld({"/x.launch": LAUNCH, **paths}, {name: f"/{name}" for name in packages}, executables=paths)
    return load_plan(["/x.launch"], [], world).nodes, world


def names(nodes: tuple[NodeSpec, ...]) -> list[str]:
    return [node.full_name for node in nodes]


def test_without_a_display_all_windows_are_left_out_in_one_line() -> None:
    kept, notes = leave_out_viewers(*make_world("rviz", "image_view", "talk"), {})
    assert names(kept) == ["/talker"]
    assert notes == ("no display: /map, /camera left out",)


@pytest.mark.parametrize("display", [DISPLAY, {"WAYLAND_DISPLAY": "wayland-0"}])
def test_with_a_display_everything_is_started(display: dict[str, str]) -> None:
    nodes, world = make_world("rviz", "image_view", "talk")
    assert leave_out_viewers(nodes, world, display) == (nodes, ())


def test_viewer_that_is_not_installed_is_left_out_alone() -> None:
    kept, notes = leave_out_viewers(*make_world("rviz", "talk"), DISPLAY)
    assert names(kept) == ["/map", "/talker"]
    assert notes == (
        "package image_view is not installed: /camera left out (sudo apt-get install ros-image-view libimage-view-dev)",
    )


def test_other_package_that_is_missing_is_no_viewer() -> None:
    nodes, world = make_world("rviz", "image_view")
    assert names(leave_out_viewers(nodes, world, DISPLAY)[0]) == ["/map", "/camera", "/talker"]


def test_packages_that_debian_splits_are_named_as_debian_does() -> None:
    assert describe_install("topic_tools") == "sudo apt-get install topic-tools libtopic-tools-dev"
    assert describe_install("my_nodes").startswith("ur get my_nodes, or")


@pytest.mark.parametrize("name", ["rviz_robot", "rviz_sonar", "rviz_local_costmap"])
def test_view_without_a_display_is_refused_with_a_help_line(name: str) -> None:
    path = f"/anywhere/{name}/launch/{name}.launch.xml"
    nodes, _ = make_world("rviz", "talk")
    with pytest.raises(UserError, match=f"'{name}' opens a window of RViz and there is no display") as caught:
        check_display([path], nodes, {})
    assert "ssh -X" in str(caught.value.diagnostics[0].help)
    check_display([path], nodes, DISPLAY)


def test_other_files_and_views_without_rviz_start_without_a_display() -> None:
    nodes, _ = make_world("rviz", "talk")
    check_display(["/anywhere/m_map/launch/m_map.launch.xml", "/rviz_mine.launch"], nodes, {})
    check_display(["/anywhere/rviz_robot/launch/rviz_robot.launch.xml"], nodes[2:], {})


def test_rviz_that_the_release_does_not_package_is_left_out_without_a_command(tmp_path: Path) -> None:
    file = tmp_path / "os-release"
    file.write_text("ID=debian\nVERSION_CODENAME=forky\n")
    assert not is_packaged("rviz", file)
    assert describe_install("rviz", file) == "this release does not package it; the terminal shows the map"
    file.write_text("ID=debian\nVERSION_ID=13\n")
    assert describe_install("rviz", file) == "sudo apt-get install rviz"
    assert is_packaged("rviz", tmp_path / "none")
