"""The choice of ROS, on computers made of empty files."""

from pathlib import Path

import pytest

from ur.source.diagnostic import UserError
from ur.system.ros import (
    WHEELS_DISTRO,
    choose_domain,
    facts_file,
    find_ros,
    graph_address,
    node_command,
    note_support,
    read_domain,
    users_of_domains,
)


def make_computer(root: Path, *files: str) -> str:
    for name in files:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).touch()
    return str(root / "state")


ROS1 = "usr/bin/rosmaster"
WHEELS = "state/.ros2/ready"
NAMES = ("jazzy", "kilted", "humble", "foxy")
JAZZY, KILTED, HUMBLE, FOXY = (f"opt/ros/{name}/share/rclpy/package.xml" for name in NAMES)


@pytest.mark.parametrize(
    ("files", "wanted", "found"),
    [
        ((ROS1,), "", "ROS 1"),
        ((ROS1, WHEELS, JAZZY), "", "ROS 1"),
        ((ROS1, WHEELS), "2", "ROS 2 Kilted, as wheels in {root}/state/.ros2"),
        ((WHEELS,), "", "ROS 2 Kilted, as wheels in {root}/state/.ros2"),
        ((WHEELS, JAZZY), "", "ROS 2 Jazzy, in {root}/opt/ros/jazzy"),
        ((ROS1, JAZZY, KILTED), "2", "ROS 2 Kilted, in {root}/opt/ros/kilted"),
        ((KILTED, HUMBLE), "", "ROS 2 Kilted, in {root}/opt/ros/kilted"),
        ((WHEELS, HUMBLE), "", "ROS 2 Humble, in {root}/opt/ros/humble"),
        ((ROS1, WHEELS), "none", "no ROS: all nodes of a run are in one process"),
    ],
)
def test_ros_is_the_packaged_one_else_the_users_else_the_wheels(
    tmp_path: Path, files: tuple[str, ...], wanted: str, found: str
) -> None:
    state = make_computer(tmp_path, *files)
    assert str(find_ros(wanted, {}, state, root=str(tmp_path))) == found.format(root=tmp_path)


def test_processor_without_wheels_has_no_ros_unless_it_is_installed_or_asked_for(tmp_path: Path) -> None:
    state = make_computer(tmp_path)
    assert find_ros("", {}, state, root=str(tmp_path), machine="aarch64").version == 0
    with pytest.raises(UserError, match="ROS 2 is not installed"):
        find_ros("2", {}, state, root=str(tmp_path), machine="aarch64")
    make_computer(tmp_path, JAZZY)
    assert find_ros("", {}, state, root=str(tmp_path), machine="aarch64").version == 2


@pytest.mark.parametrize(
    ("files", "wanted", "message"),
    [
        ((), "2", "ROS 2 is not installed"),
        ((WHEELS,), "1", "ROS 1 is not installed"),
        ((FOXY, WHEELS), "2", "ROS 2 Foxy is not supported, expected Humble, Jazzy"),
    ],
)
def test_ros_that_is_missing_or_too_old_is_named(
    tmp_path: Path, files: tuple[str, ...], wanted: str, message: str
) -> None:
    state = make_computer(tmp_path, *files)
    with pytest.raises(UserError, match=message):
        find_ros(wanted, {}, state, root=str(tmp_path))


def test_sourced_ros2_goes_before_others_of_its_version(tmp_path: Path) -> None:
    state = make_computer(tmp_path, JAZZY, WHEELS)
    shell = {"ROS_VERSION": "2", "ROS_DISTRO": "lyrical", "AMENT_PREFIX_PATH": "/home/me/ws:/opt/ros/lyrical"}
    found = find_ros("", shell, state, root=str(tmp_path))
    assert (found.distro, found.prefix, found.sourced) == ("lyrical", "/opt/ros/lyrical", True)
    ours = {"ROS_VERSION": "2", "ROS_DISTRO": "kilted", "AMENT_PREFIX_PATH": f"{state}/.ros2"}
    assert find_ros("", ours, state, root=str(tmp_path)).distro == "jazzy"


def test_set_up_names_the_release_of_the_wheels_and_the_end_of_its_support() -> None:
    text = (Path(__file__).parents[2] / "tools/set_up.bash").read_text()
    assert f'"ROS 2 {WHEELS_DISTRO.capitalize()} as Python packages{note_support(WHEELS_DISTRO)}"' in text
    assert note_support("iron") == ""


def test_simulated_robots_of_users_are_in_domains_of_their_own() -> None:
    domains = {choose_domain({}, uid, ()) for uid in range(1000, 1020)}
    assert len(domains) == 20
    assert all(0 < int(each) <= 101 for each in domains)
    assert choose_domain({"ROS_DOMAIN_ID": "5"}, 1000, ()) == "5"


def test_users_whose_ids_lead_to_one_domain_do_not_share_it(tmp_path: Path) -> None:
    table = tmp_path / "udp"
    domain = int(choose_domain({}, 1000, ()))
    assert choose_domain({}, 1040, ()) == str(domain)
    line = "  7: 00000000:{:04X} 00000000:0000 07 00000000:00000000 00:00000000 00000000  {}        0 1 2 0 0\n"
    ports = (7400 + 250 * domain, 7410 + 250 * domain, 68)
    table.write_text("  sl  local_address ...\n" + "".join(line.format(port, 1000) for port in ports) + "broken\n")
    assert users_of_domains((str(table), "/nowhere")) == {domain: {1000}}
    assert choose_domain({}, 1000, (str(table),)) == str(domain)
    assert choose_domain({}, 1040, (str(table),)) == str(domain + 1)


def test_address_of_a_graph_tells_its_domain() -> None:
    assert read_domain(graph_address({"ROS_VERSION": "2", "ROS_DOMAIN_ID": "7"})) == "7"
    assert read_domain(graph_address({"ROS_VERSION": "2"})) == "0"
    assert read_domain(graph_address({"ROS_MASTER_URI": "http://robbie.local:11311"})) is None
    assert facts_file({"XDG_RUNTIME_DIR": "/run/user/1"}, "7") == "/run/user/1/ubiquity_launches/facts-7.json"


def test_nodes_of_ros2_start_by_the_launch_library_which_finds_their_python() -> None:
    assert node_command({"ROS_VERSION": "0"})[-1] == "ur_nodes.one_process.viewer_program"
    assert node_command({"ROS_VERSION": "2"})[0].endswith("ubiquity_launches/lib/node")
    assert node_command({})[1:] == ("-I", "-m", "ur_nodes")
