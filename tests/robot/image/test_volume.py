from pathlib import Path

import pytest
from tests.robot.image.images import (
    BOOT,
    CLOUD_ROOT,
    MIB,
    check_fat,
    check_filesystems,
    make_cloud,
    make_ubuntu,
    needs_tools,
    read_fat,
    run,
)

from ur.robot.image.volume import ExtVolume, FatVolume, run_tool
from ur.source.diagnostic import UserError

pytestmark = needs_tools


def test_fat_files_are_written_replaced_and_removed(tmp_path: Path) -> None:
    image = make_ubuntu(tmp_path / "x.img").rename(tmp_path / "a strange? @@name.img")
    volume = FatVolume(image, BOOT * MIB)
    assert volume.read("user-data") == b"#cloud-config\npassword: ubuntu\n"
    assert volume.read("nothing") is None
    volume.write("user-data", b"two\r\nlines \xff\n")
    assert volume.read("user-data") == b"two\r\nlines \xff\n"
    volume.write("ssh", b"x")
    assert volume.read("ssh") == b"x"
    volume.write("cmdline.txt", None)
    assert volume.names() == {"user-data", "meta-data", "network-config", "config.txt", "ssh"}
    other = image.rename(tmp_path / "x.img")
    check_fat(other)
    assert read_fat(other, "ssh") == "x"


def test_ext4_files_are_written_replaced_and_removed(tmp_path: Path) -> None:
    image = make_cloud(tmp_path / "x.img").rename(tmp_path / "a strange? @@name.img")
    volume = ExtVolume(image, CLOUD_ROOT * MIB)
    assert volume.read("etc/hostname") == b"old\n"
    assert volume.read("etc/nothing") is None
    volume.write("var/lib/new folder/x", b"1\r\n\xff", 0o600)
    volume.write("var/lib/new folder/x", b"2\n" * 5000, 0o600)
    volume.write("var/lib/empty", b"")
    volume.write("etc/hostname", None)
    other = image.rename(tmp_path / "x.img")
    volume = ExtVolume(other, CLOUD_ROOT * MIB)
    assert volume.read("var/lib/empty") == b""
    assert volume.read("etc/hostname") is None
    said = run("debugfs", "-R", 'stat "/var/lib/new folder/x"', f"{other}?offset={CLOUD_ROOT * MIB}")
    assert "Mode:  0600" in said
    assert "User:     0   Group:     0" in said
    assert "Size: 10000" in said
    check_filesystems(other, CLOUD_ROOT, 16)


def test_full_file_system_is_an_error_of_one_line(tmp_path: Path) -> None:
    volume = FatVolume(make_ubuntu(tmp_path / "x.img"), BOOT * MIB)
    with pytest.raises(UserError):
        volume.write("big", b"x" * 9 * MIB)
    assert volume.read("user-data") == b"#cloud-config\npassword: ubuntu\n"


def test_tool_that_is_not_there_is_named_with_its_package() -> None:
    with pytest.raises(UserError) as caught:
        run_tool(["mtools-that-nobody-has"])
    assert caught.value.diagnostics[0].help == "run: sudo apt-get install mtools"
