from pathlib import Path

import pytest
from tests.robot.image.images import (
    CLOUD_ROOT,
    KEY,
    PI_ROOT,
    check_fat,
    check_filesystems,
    list_fat,
    make_cloud,
    make_old_raspberry,
    make_raspberry,
    make_ubuntu,
    needs_tools,
    read_ext,
    read_fat,
)

from ur.robot.image.layout import find_layout
from ur.robot.image.seed import SeedNetwork, SeedOptions, Write, make_seed, plan_undo, plan_writes, read_seed, write_all
from ur.robot.setup.robot_states import WantedRobot

pytestmark = needs_tools
OPTIONS = SeedOptions(WantedRobot("bob", "magni"), "ros", (KEY,), wifi=SeedNetwork("home", "ab" * 32, "DE"))
MAKERS = (make_ubuntu, make_raspberry, make_old_raspberry, make_cloud)


def plan(path: Path, options: SeedOptions = OPTIONS) -> list[Write]:
    layout = find_layout(path)
    return plan_writes(layout, read_seed(layout), make_seed(options, layout))


def undo(path: Path) -> list[Write]:
    layout = find_layout(path)
    return plan_undo(layout, read_seed(layout))


@pytest.mark.parametrize("make", MAKERS)
def test_second_time_there_is_nothing_to_do(tmp_path: Path, make: object) -> None:
    path = make(tmp_path / "x.img")  # type: ignore[operator] # one of MAKERS
    assert plan(path)
    write_all(path, plan(path))
    assert plan(path) == []


@pytest.mark.parametrize("make", MAKERS)
def test_undo_brings_back_what_was_there(tmp_path: Path, make: object) -> None:
    path = make(tmp_path / "x.img")  # type: ignore[operator] # one of MAKERS
    layout = find_layout(path)
    before = read_seed(layout)
    assert undo(path) == []
    for name in ("bob", "eve"):  # what is kept is what the image brought, not the seed before
        write_all(path, plan(path, SeedOptions(WantedRobot(name, "magni"), "ros", (KEY,), wifi=OPTIONS.wifi)))
    write_all(path, undo(path))
    assert read_seed(layout) == before
    assert undo(path) == []


def test_ubuntu_is_read_back_by_other_tools(tmp_path: Path) -> None:
    path = make_ubuntu(tmp_path / "x.img")
    write_all(path, plan(path))
    assert "hostname: bob\n" in read_fat(path, "user-data")
    assert "regulatory-domain: DE\n" in read_fat(path, "network-config")
    assert "instance-id: ur-" in read_fat(path, "meta-data")
    assert read_fat(path, "user-data.orig") == "#cloud-config\npassword: ubuntu\n"
    check_fat(path)


def test_cloud_image_is_read_back_by_other_tools(tmp_path: Path) -> None:
    path = make_cloud(tmp_path / "x.img")
    write_all(path, plan(path))
    assert "hostname: bob\n" in read_ext(path, "var/lib/cloud/seed/nocloud/user-data", CLOUD_ROOT)
    check_filesystems(path, CLOUD_ROOT, 16)


def test_old_raspberry_is_read_back_by_other_tools(tmp_path: Path) -> None:
    path = make_old_raspberry(tmp_path / "x.img")
    write_all(path, plan(path))
    assert 'hostname = "bob"\n' in read_fat(path, "custom.toml")
    assert 'name: "bob"\n' in read_ext(path, "etc/ubiquity/robot.yaml", PI_ROOT)
    check_fat(path)
    check_filesystems(path, PI_ROOT, 8)


def test_robot_that_loses_its_wifi_gets_the_network_of_the_image_back(tmp_path: Path) -> None:
    path = make_ubuntu(tmp_path / "x.img")
    write_all(path, plan(path))
    write_all(path, plan(path, SeedOptions(OPTIONS.robot, OPTIONS.user, OPTIONS.keys)))
    assert read_fat(path, "network-config") == "version: 2\n"
    assert "network-config.orig" not in list_fat(path)


def test_file_that_a_person_changed_since_is_kept(tmp_path: Path) -> None:
    path = make_ubuntu(tmp_path / "x.img")
    write_all(path, plan(path))
    layout = find_layout(path)
    assert layout.boot
    layout.boot.write("user-data", b"#cloud-config\nhostname: mine\n")
    write_all(path, plan(path))
    assert read_fat(path, "user-data.orig") == "#cloud-config\nhostname: mine\n"
    assert "hostname: bob\n" in read_fat(path, "user-data")


def test_seed_is_complete_only_with_the_last_file(tmp_path: Path) -> None:
    """On a device, files are written one after the other: cloud-init looks at none of them without user-data."""
    assert [write.path for write in plan(make_cloud(tmp_path / "x.img"))][-1].endswith("user-data")
